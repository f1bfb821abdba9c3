#include "rendering.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "image/image.hpp"
#include "image/temporary_folder.hpp"

namespace raymill {

namespace {

void write_checker_texture(const std::string& file) {
    constexpr int size = 8;
    Image image{size, size, {}};
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float bright = (x + y) % 2 == 0 ? 1.0f : 0.25f;
            for (const float channel : {bright, 0.125f * static_cast<float>(x), 0.125f * static_cast<float>(y), 1.0f})
                image.rgba.push_back(channel);
        }
    ImageMetadata metadata;
    metadata.full_width = metadata.full_height = size;
    write_exr(file, image, {}, metadata, ExrPixels::float32);
}

}  // namespace

Scene scene_of(const std::string& toml) {
    const TemporaryFolder folder;
    write_checker_texture(folder.file("checker.exr"));
    write_text(folder.file("scene.toml"), toml);
    return load_scene(folder.file("scene.toml"));
}

const Device& test_device() {
    static const Device device = open_device("", 0);
    return device;
}

Frame render(const Scene& scene, const RenderOptions& options, const Device& device) {
    const Bvh bvh = bvh_of(scene);
    Frame frame = Renderer(device, scene, bvh, options).render();
    EXPECT_EQ(frame.not_a_number, 0u);
    EXPECT_EQ(frame.saturated, 0u);
    EXPECT_EQ(frame.finished, 1);
    return frame;
}

std::uint64_t pixel_count(const Scene& scene) {
    const PixelWindow window = crop_window(scene.settings);
    return static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
}

std::size_t differing_pixels(const Frame& a, const Frame& b) {
    EXPECT_EQ(a.sums.size(), b.sums.size());
    std::size_t count = 0;
    for (std::size_t first = 0; first < std::min(a.sums.size(), b.sums.size()); first += FILM_CHANNELS)
        count += !std::equal(a.sums.begin() + static_cast<std::ptrdiff_t>(first),
                             a.sums.begin() + static_cast<std::ptrdiff_t>(first + FILM_CHANNELS),
                             b.sums.begin() + static_cast<std::ptrdiff_t>(first));
    return count;
}

std::string sphere_mesh_keys(double x, double y, double z, double radius, int bands) {
    const int around = 2 * bands;
    std::string vertices, normals, faces;
    const auto add_vertex = [&](double polar, double azimuth) {
        const double nx = std::sin(polar) * std::cos(azimuth), ny = std::cos(polar),
                     nz = -std::sin(polar) * std::sin(azimuth);
        vertices += fmt::format("[{}, {}, {}],", x + radius * nx, y + radius * ny, z + radius * nz);
        normals += fmt::format("[{}, {}, {}],", nx, ny, nz);
    };
    add_vertex(0, 0);
    for (int i = 1; i < bands; ++i)
        for (int j = 0; j < around; ++j) add_vertex(std::numbers::pi * i / bands, 2 * std::numbers::pi * j / around);
    add_vertex(std::numbers::pi, 0);

    const int last = 1 + (bands - 1) * around;
    const auto at = [&](int band, int j) { return 1 + (band - 1) * around + j % around; };
    for (int j = 0; j < around; ++j) {
        faces += fmt::format("[0, {}, {}],", at(1, j), at(1, j + 1));
        for (int i = 1; i + 1 < bands; ++i)
            faces += fmt::format("[{}, {}, {}, {}],", at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        faces += fmt::format("[{}, {}, {}],", last, at(bands - 1, j + 1), at(bands - 1, j));
    }
    return fmt::format("shape = \"mesh\"\nvertices = [{}]\nnormals = [{}]\nfaces = [{}]\n", vertices, normals, faces);
}

std::string grid_mesh_keys(double half, int cells) {
    std::string vertices, faces;
    for (int i = 0; i <= cells; ++i)
        for (int j = 0; j <= cells; ++j)
            vertices += fmt::format("[{}, 0.0, {}],", half * (2.0 * j / cells - 1), half * (2.0 * i / cells - 1));
    for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
            const int corner = i * (cells + 1) + j;
            faces += fmt::format("[{}, {}, {}, {}],", corner, corner + cells + 1, corner + cells + 2, corner + 1);
        }
    return fmt::format("shape = \"mesh\"\nvertices = [{}]\nfaces = [{}]\n", vertices, faces);
}

}  // namespace raymill
