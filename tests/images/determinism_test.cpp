// One scene, one film: its integers do not depend on how the work is cut up.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <tuple>
#include <variant>

#include "rendering.hpp"

namespace raymill {
namespace {

/// Everything that could tell one schedule from another: branching to depth 8, several samples and lights, rays in and
/// out of glass, textures, a filtered shadow.
std::string branching_toml() {
    return R"(
[render]
size = [40, 30]
spp = 4
depth = 8
background = [0.1, 0.2, 0.4]
[camera]
eye = [0, 1.6, 6]
look_at = [0, 0.8, 0]
fov = 45
[[material]]
name = "floor"
ambient = 0.2
diffuse_checker = { a = [0.9, 0.9, 0.8], b = [0.1, 0.2, 0.3], scale = 0.7 }
reflection = 0.2
[[material]]
name = "glass"
diffuse = 0.05
specular = 0.6
shininess = 80
reflection = 0.15
transmission = 0.75
base_color = [0.9, 1.0, 0.95]
fresnel = true
absorption = [0.3, 0.05, 0.2]
[[material]]
name = "mirror"
diffuse = 0.1
reflection = 0.85
base_color = [1.0, 0.9, 0.7]
[[material]]
name = "painted"
diffuse_map = "checker.exr"
specular = 0.3
highlight = "blinn"
[[light]]
type = "ambient"
color = 0.3
[[light]]
type = "point"
position = [3, 5, 4]
intensity = 0.5
radius = 0.4
samples = 2
[[light]]
type = "directional"
direction = [1, -2, -1]
intensity = [0.3, 0.3, 0.4]
[[light]]
type = "rectangle"
center = [-2, 4, 1]
edge_u = [1.5, 0, 0]
edge_v = [0, 0, 1.5]
radiance = 2.0
samples = 3
[[object]]
shape = "plane"
material = "floor"
point = [0, 0, 0]
normal = [0, 1, 0]
[[object]]
shape = "sphere"
material = "mirror"
center = [-1.5, 1, -0.5]
radius = 1
[[object]]
shape = "sphere"
material = "glass"
center = [0.4, 0.7, 1.5]
radius = 0.7
[[object]]
shape = "rectangle"
material = "painted"
center = [0, 2, -3]
edge_u = [6, 0, 0]
edge_v = [0, 4, 0]
[[object]]
material = "glass"
)" + sphere_mesh_keys(1.9, 0.9, -0.2, 0.85, 8);
}

class OneFilm : public testing::Test {
  protected:
    static const Scene& scene() {
        static const Scene scene = scene_of(branching_toml());
        return scene;
    }
    /// The film of capacity 4096, PoCL's usual groups and all threads.
    static const Frame& expected() {
        static const Frame frame = render(scene());
        return frame;
    }
    static void expect_same(const RenderOptions& options, const Device& device = test_device()) {
        const Frame frame = render(scene(), options, device);
        EXPECT_EQ(frame.hash(), expected().hash()) << differing_pixels(frame, expected()) << " pixels differ";
        EXPECT_EQ(frame.rays.camera, expected().rays.camera);
        EXPECT_EQ(frame.rays.secondary, expected().rays.secondary);
        EXPECT_EQ(frame.rays.shadow, expected().rays.shadow);
        EXPECT_EQ(frame.shadow_blocked, expected().shadow_blocked);
    }
};

TEST_F(OneFilm, comes_of_a_scene_that_branches_and_is_shadowed) {
    EXPECT_GT(expected().rays.secondary, 2 * expected().rays.camera);
    EXPECT_GT(expected().shadow_blocked, expected().rays.camera / 10);
}

TEST_F(OneFilm, changes_with_the_seed) {
    Scene other = scene();
    other.settings.seed = 1;
    EXPECT_NE(render(other).hash(), expected().hash());
}

TEST_F(OneFilm, comes_of_a_queue_of_one_work_group) {
    expect_same(options_with(256, 256));
}
TEST_F(OneFilm, comes_of_a_queue_of_one_chunk_in_groups_of_one) {
    expect_same(options_with(64, 1));
}
TEST_F(OneFilm, comes_of_a_capacity_that_divides_nothing) {
    expect_same(options_with(997, 8));
}
TEST_F(OneFilm, comes_of_a_queue_larger_than_the_image) {
    expect_same(options_with(65536, 64));
}
// On processors all items of a work-group lie on one stack.
TEST_F(OneFilm, comes_of_the_largest_work_groups) {
    for (const Traversal traversal : {Traversal::packet, Traversal::single}) {
        RenderOptions options = options_with(997, test_device().info.largest_work_group);
        options.traversal = traversal;
        expect_same(options);
    }
}
TEST_F(OneFilm, comes_of_a_capacity_that_is_chosen_by_itself) {
    expect_same(options_with(0, 256));
}

// With one sample a pixel the first adds are plain, and those of several light samples atomic.
TEST_F(OneFilm, of_one_sample_a_pixel_comes_of_any_queue) {
    Scene single = scene();
    single.settings.spp = 1;
    const Frame whole = render(single);
    for (const RenderOptions& options : {options_with(64, 1), options_with(997, 8), options_with(65536)}) {
        const Frame frame = render(single, options);
        EXPECT_EQ(frame.hash(), whole.hash()) << differing_pixels(frame, whole) << " pixels differ";
    }
}

TEST_F(OneFilm, comes_of_rays_together_and_of_rays_alone) {
    for (const Traversal traversal : {Traversal::packet, Traversal::single}) {
        RenderOptions options = options_with(997);
        options.traversal = traversal;
        expect_same(options);
    }
}

TEST_F(OneFilm, keeps_its_beauty_whatever_else_it_keeps) {
    RenderOptions options = options_with(997, 8);
    for (int plane = 0; plane < FILM_PLANES; ++plane) options.planes.keep(plane);
    const Frame all = render(scene(), options);
    const std::span<const cl_long> beauty = all.plane(FILM_BEAUTY);
    ASSERT_EQ(beauty.size(), expected().sums.size());
    EXPECT_TRUE(std::ranges::equal(beauty, expected().sums));
    // The lecture's picture: six parts, whose sum is the whole to the last integer.
    for (std::size_t i = 0; i < beauty.size(); ++i) {
        if (i % FILM_CHANNELS == 3) continue;
        cl_long sum = 0;
        for (int plane = FILM_AMBIENT; plane <= FILM_REFRACTION; ++plane) sum += all.plane(plane)[i];
        ASSERT_EQ(sum, beauty[i]) << "channel " << i;
    }
    options.memory.queue_capacity = 64;
    for (const std::size_t work_group : {std::size_t{1}, test_device().info.largest_work_group}) {
        options.work_group = work_group;
        EXPECT_EQ(render(scene(), options).hash(), all.hash()) << work_group;
    }
}

TEST_F(OneFilm, comes_of_one_thread_and_of_two) {
    const unsigned threads = test_device().info.compute_units;
    if (threads < 2) GTEST_SKIP() << "the device has a single compute unit";
    expect_same(options_with(997), open_device("", 1));
    if (threads > 2) expect_same(options_with(997), open_device("", 2));
}

TEST_F(OneFilm, comes_of_one_pipeline_and_of_two) {
    RenderOptions options = options_with(256);
    expect_same(options);
    options.memory.pipelines = 1;
    expect_same(options);
}

// With one sample a pixel, adds of camera rays are plain while another pipeline's wave runs: all adds without recursion
// and with one light sample; else beside atomic adds of deeper rays of the same pixels, which stay in their pipeline.
TEST_F(OneFilm, of_one_sample_a_pixel_comes_of_one_pipeline_and_of_several) {
    Scene single = scene();
    single.settings.spp = 1;
    Scene local = single;
    local.settings.depth = 0;
    std::erase_if(local.lights, [](const SceneLight& l) { return !std::holds_alternative<DirectionalLight>(l.light); });
    ASSERT_EQ(local.lights.size(), 1u);
    for (const Scene& scene : {single, local}) {
        RenderOptions options = options_with(64);
        options.memory.pipelines = 1;
        const Frame one = render(scene, options);
        EXPECT_GT(one.rays.shadow, 200u);
        const Bvh bvh = bvh_of(scene);
        options.memory.pipelines = 4;
        Renderer renderer(test_device(), scene, bvh, options);
        for (int frame = 0; frame < 10; ++frame) ASSERT_EQ(renderer.render().hash(), one.hash());
    }
}

TEST_F(OneFilm, that_is_shown_or_timed_goes_through_one_pipeline) {
    const Bvh bvh = bvh_of(scene());
    Renderer renderer(test_device(), scene(), bvh, options_with(256));
    ASSERT_EQ(renderer.memory().pipelines, 2);
    const Frame timed = renderer.render({}, profile::Detail::totals);
    std::uint64_t waves = 0;
    const Buffer<Hit>* hits = nullptr;
    Batch batch;
    renderer.observe([&](const std::string& stage, const WaveView& view) {
        if (!hits) hits = &view.hits;
        EXPECT_EQ(&view.hits, hits);
        if (stage == "intersect") {
            batch = view.batch;
            ++waves;
        } else if (stage != "generate") {  // of the same wave
            EXPECT_EQ(std::tie(view.batch.depth, view.batch.first, view.batch.count),
                      std::tie(batch.depth, batch.first, batch.count));
        }
    });
    const Frame shown = renderer.render();
    EXPECT_EQ(shown.waves, waves);
    EXPECT_EQ(timed.waves, waves);
    EXPECT_EQ(shown.hash(), expected().hash());
    EXPECT_EQ(timed.hash(), expected().hash());
    renderer.observe({});
    EXPECT_EQ(renderer.render().hash(), expected().hash());
}

TEST_F(OneFilm, comes_of_a_renderer_that_was_broken_off) {
    Scene many = scene();
    many.settings.spp = 32;
    const Frame whole = render(many);
    const Bvh bvh = bvh_of(many);
    Renderer renderer(test_device(), many, bvh, options_with(40 * 30 * 32 / 2));
    ASSERT_EQ(renderer.memory().pipelines, 2);
    for (const int last : {1, 2, 3}) {
        int waves = 0;
        const auto break_off = [&](double) -> bool {
            return ++waves < last ? true : throw std::runtime_error("no more");
        };
        EXPECT_THROW(renderer.render(break_off), std::runtime_error);
        EXPECT_EQ(waves, last);
        EXPECT_EQ(renderer.render().hash(), whole.hash());
    }
}

TEST_F(OneFilm, comes_again_of_the_same_renderer) {
    const Bvh bvh = bvh_of(scene());
    Renderer renderer(test_device(), scene(), bvh, options_with(997));
    const Frame first = renderer.render(), second = renderer.render();
    EXPECT_EQ(first.hash(), expected().hash());
    EXPECT_EQ(second.hash(), expected().hash());
}

TEST_F(OneFilm, comes_of_a_queue_of_one_ray) {
    Scene small = scene();
    small.settings.width = 6;
    small.settings.height = 5;
    small.settings.spp = 1;
    const Frame alone = render(small, options_with(1)), together = render(small);
    EXPECT_EQ(alone.hash(), together.hash());
    EXPECT_EQ(alone.rays.total(), together.rays.total());
    EXPECT_GE(alone.waves, alone.rays.camera + alone.rays.secondary);  // one ray a wave
}

TEST_F(OneFilm, is_that_of_its_crops) {
    Scene cropped = scene();
    cropped.settings.crop = {0.3, 0.75, 0.2, 0.9};
    const PixelWindow window = crop_window(cropped.settings);
    const Frame part = render(cropped);
    for (int y = 0; y < window.height; ++y)
        for (int x = 0; x < window.width; ++x)
            for (int channel = 0; channel < FILM_CHANNELS; ++channel) {
                const auto in_part = static_cast<std::size_t>((y * window.width + x) * FILM_CHANNELS + channel);
                const auto in_whole = static_cast<std::size_t>(
                    ((y + window.y0) * scene().settings.width + x + window.x0) * FILM_CHANNELS + channel);
                ASSERT_EQ(part.sums[in_part], expected().sums[in_whole]) << "pixel " << x << ", " << y;
            }
}

}  // namespace
}  // namespace raymill
