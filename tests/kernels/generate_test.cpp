// Camera rays against the reference's, in tile order, over any split into batches.
#include <gtest/gtest.h>

#include <vector>

#include "kernel_rig.hpp"
#include "lib/random.h"
#include "reference/reference.hpp"

namespace raymill::test {
namespace {

constexpr double ROUNDING = 0x1p-24;

struct View {
    const char* name;
    Projection projection;
    double aperture;
    int width, height, spp;
    Crop crop;
};

std::ostream& operator<<(std::ostream& out, const View& view) {
    return out << view.name;
}

const View views[] = {
    {"pinhole", Projection::perspective, 0, 64, 48, 1, {}},
    {"pinhole_of_odd_size", Projection::perspective, 0, 37, 21, 4, {}},
    {"one_pixel", Projection::perspective, 0, 1, 1, 7, {}},
    {"one_row", Projection::perspective, 0, 19, 1, 4, {}},
    {"whole_rows_of_tiles", Projection::perspective, 0, 37, 24, 1, {}},
    {"whole_columns_of_tiles", Projection::perspective, 0, 40, 9, 1, {}},
    {"one_column", Projection::perspective, 0, 1, 19, 4, {}},
    {"thin_lens", Projection::perspective, 0.3, 37, 21, 7, {}},
    {"thin_lens_of_one_sample", Projection::perspective, 0.3, 33, 9, 1, {}},
    {"sixteen_samples", Projection::perspective, 0.1, 37, 21, 16, {}},
    {"more_than_sixteen_samples", Projection::perspective, 0.1, 21, 19, 25, {}},
    {"orthographic", Projection::orthographic, 0, 40, 31, 4, {}},
    {"orthographic_with_lens", Projection::orthographic, 0.2, 31, 40, 15, {}},
    {"crop", Projection::perspective, 0, 100, 80, 4, {0.13, 0.62, 0.31, 0.9}},
    {"crop_of_one_pixel", Projection::perspective, 0.1, 64, 64, 7, {0.5, 0.515, 0.25, 0.265}},
};

Scene scene_of(const View& view) {
    Scene scene;
    scene.materials.emplace_back();
    scene.settings.width = view.width;
    scene.settings.height = view.height;
    scene.settings.spp = view.spp;
    scene.settings.seed = 42;
    scene.settings.crop = view.crop;
    scene.camera.projection = view.projection;
    scene.camera.aperture = view.aperture;
    scene.camera.eye = {1.5, 2.25, 6.125};
    scene.camera.look_at = {-0.5, 0.75, 0.25};
    scene.camera.fov = 50;
    scene.camera.height = 3;
    return scene;
}

struct Sample {
    int x, y;  // in the window
    uint sample;
};

void add_pixel(int x, int y, int spp, std::vector<Sample>& order) {
    for (int sample = 0; sample < spp; ++sample) order.push_back({x, y, static_cast<uint>(sample)});
}

/// The pixels of a whole tile: quarter by quarter (top left, top right, bottom left, bottom right), and these so again.
void add_quarters(int left, int top, int edge, int spp, std::vector<Sample>& order) {
    if (edge == 1) return add_pixel(left, top, spp, order);
    const int half = edge / 2;
    for (const int y : {top, top + half})
        for (const int x : {left, left + half}) add_quarters(x, y, half, spp, order);
}

/// The pixels of one tile, each with all its samples.
void add_tile(int left, int top, int width, int height, int spp, std::vector<Sample>& order) {
    if (width == TILE && height == TILE) return add_quarters(left, top, TILE, spp, order);
    for (int y = top; y < top + height; ++y)
        for (int x = left; x < left + width; ++x) add_pixel(x, y, spp, order);
}

/// The order that the kernel documents, spelt out: whole tiles row by row, what is left at the right, then at the
/// bottom.
std::vector<Sample> tile_order(const PixelWindow& window, int spp) {
    std::vector<Sample> order;
    const int right = window.width / TILE * TILE, bottom = window.height / TILE * TILE;
    for (int y = 0; y < bottom; y += TILE)
        for (int x = 0; x < right; x += TILE) add_tile(x, y, TILE, TILE, spp, order);
    for (int y = 0; y < bottom; y += TILE) add_tile(right, y, window.width - right, TILE, spp, order);
    for (int x = 0; x < window.width; x += TILE)
        add_tile(x, bottom, std::min<int>(TILE, window.width - x), window.height - bottom, spp, order);
    return order;
}

class Generate : public testing::TestWithParam<View> {};

TEST_P(Generate, every_sample_of_every_pixel_comes_once_in_tile_order) {
    const Scene scene = scene_of(GetParam());
    const PixelWindow window = crop_window(scene.settings);
    const std::vector<Sample> order = tile_order(window, scene.settings.spp);
    const auto rays = KernelRig(scene).generate(0, static_cast<uint>(order.size()));
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Sample& s = order[i];
        const int whole_pixel = (window.y0 + s.y) * scene.settings.width + window.x0 + s.x;
        ASSERT_EQ(rays[i].pixel, static_cast<uint>(s.y * window.width + s.x)) << i;
        ASSERT_EQ(rays[i].sample, s.sample) << i;
        ASSERT_EQ(rays[i].path, path_camera(42, static_cast<uint>(whole_pixel))) << i;
        ASSERT_EQ(rays[i].route, ROUTE_CAMERA) << i;
        for (const float weight : rays[i].throughput) ASSERT_EQ(weight, 1) << i;
    }
    EXPECT_EQ(touched_from(rays, order.size()), 0u);
}

TEST_P(Generate, rays_start_and_point_like_the_reference_s) {
    const Scene scene = scene_of(GetParam());
    const PixelWindow window = crop_window(scene.settings);
    const reference::Tracer tracer(scene);
    const std::vector<Sample> order = tile_order(window, scene.settings.spp);
    const auto rays = KernelRig(scene).generate(0, static_cast<uint>(order.size()));
    // Of the origin: the eye, the film plane's two vectors and the lens are rounded once, and each of the two sums
    // once; coordinates are below 9, the lens point errs by 7e-7 of a radius of 0.15.
    const double origin_bound = 9 * 6 * ROUNDING + 7e-7 * 0.15;
    // Of the direction, before normalisation at least 1 long: the film's position has 4 roundings of at most 1, its
    // vectors 1 (of at most 2.5), the sums 3; normalisation 5. With a lens it is the focus distance (6.4) long, and its
    // end errs by that times the same, and by the lens point.
    const double direction_bound = (4 * 1 + 2 * 2.5 + 3 * 2.5 + 5) * ROUNDING * 2 + 7e-7 * 0.15 / 6;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Sample& s = order[i];
        const reference::Ray expected = tracer.camera_ray(window.x0 + s.x, window.y0 + s.y, s.sample);
        for (int k = 0; k < 3; ++k) {
            ASSERT_NEAR(rays[i].origin[k], expected.origin[k], origin_bound) << i;
            ASSERT_NEAR(rays[i].direction[k], expected.direction[k], direction_bound) << i;
        }
    }
}

TEST_P(Generate, a_split_into_batches_changes_no_bit) {
    const Scene scene = scene_of(GetParam());
    const PixelWindow window = crop_window(scene.settings);
    const auto total = static_cast<uint>(window.width * window.height * scene.settings.spp);
    const KernelRig rig(scene);
    const auto whole = rig.generate(0, total);
    uint next = 0;
    for (const uint wanted : {0u, 1u, 63u, 64u, 65u, total}) {
        const uint count = std::min(wanted, total - next);
        const auto batch = rig.generate(next, count);
        for (uint i = 0; i < count; ++i) ASSERT_TRUE(same_bits(batch[i], whole[next + i])) << next + i;
        EXPECT_EQ(touched_from(batch, count), 0u) << count;
        next += count;
    }
    EXPECT_EQ(next, total);
}

INSTANTIATE_TEST_SUITE_P(Views, Generate, testing::ValuesIn(views), testing::PrintToStringParamName());

TEST(GenerateOfManySamples, the_last_of_more_than_2_to_the_32_samples_is_the_last_pixel_s) {
    struct Size {
        int width, height, spp;
    };
    for (const Size& size :
         {Size{4099, 4097, 300}, Size{640, 9, 1 << 20}}) {  // of the second, a row of tiles holds more
        Scene scene = scene_of(views[0]);
        scene.settings.width = size.width;
        scene.settings.height = size.height;
        scene.settings.spp = size.spp;
        const auto pixels = static_cast<uint>(size.width * size.height);
        const KernelRig rig(scene);
        const Ray last = rig.generate(std::uint64_t{pixels} * static_cast<uint>(size.spp) - 1, 1)[0];
        EXPECT_EQ(last.pixel, pixels - 1);
        EXPECT_EQ(last.sample, static_cast<uint>(size.spp - 1));
        const auto width = static_cast<uint>(size.width);
        const uint whole_width = width / TILE * TILE;
        const Ray corner = rig.generate(std::uint64_t{TILE} * whole_width * static_cast<uint>(size.spp) - 1, 1)[0];
        EXPECT_EQ(corner.pixel, (TILE - 1) * width + whole_width - 1);
        const uint whole_height = static_cast<uint>(size.height) / TILE * TILE;
        const Ray at_edge = rig.generate(std::uint64_t{whole_width} * whole_height * static_cast<uint>(size.spp), 1)[0];
        EXPECT_EQ(at_edge.pixel, whole_width < width ? whole_width : whole_height * width);
    }
}

}  // namespace
}  // namespace raymill::test
