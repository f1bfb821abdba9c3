#include "wavefront/device_scene.hpp"

#include "device/huge_pages.hpp"
#include "wavefront/records.hpp"

namespace raymill {

namespace {

std::vector<Texture> texture_records(const Scene& scene) {
    std::vector<Texture> records;
    std::size_t first = 0;
    for (const TextureImage& image : scene.images) {
        records.push_back({static_cast<uint>(first), image.width, image.height});
        first += image.texels.size();
    }
    return records;
}

Buffer<float> upload_texels(const Device& device, const Scene& scene) {
    std::size_t count = 0;
    for (const TextureImage& image : scene.images) count += image.texels.size();
    Buffer<float> texels(device, 3 * count);
    std::size_t first = 0;
    for (const TextureImage& image : scene.images) {
        texels.write(device, {&image.texels.data()->x, 3 * image.texels.size()}, first);
        first += 3 * image.texels.size();
    }
    return texels;
}

/// Of any contiguous array. Rays read scenes at random; queues, which they read in order, gain nothing by huge pages.
template <class Array>
auto upload(const Device& device, const Array& values) {
    using T = typename Array::value_type;
    Buffer<T> buffer(device, values.size());
    ask_for_huge_pages(device, buffer.memory(), values.size() * sizeof(T));
    buffer.write(device, values);
    return buffer;
}

}  // namespace

DeviceScene::DeviceScene(const Device& device, const Scene& scene, const Bvh& bvh, const FilmPlanes& planes)
    : nodes(upload(device, bvh.nodes)),
      triangle_blocks(upload(device, bvh.triangle_blocks)),
      sphere_blocks(upload(device, bvh.sphere_blocks)),
      vertices(upload(device, scene.vertices)),
      triangles(upload(device, scene.triangles)),
      spheres(upload(device, scene.spheres)),
      planes(upload(device, scene.planes)),
      materials(upload(device, material_records(scene))),
      textures(upload(device, texture_records(scene))),
      texels(upload_texels(device, scene)),
      lights(upload(device, light_records(scene))),
      light_slots(upload(device, raymill::light_slots(scene))),
      camera(upload(device, std::vector{camera_record(scene)})),
      constants(upload(device, std::vector{scene_constants(scene, bvh.nodes.size(), planes)})) {}

}  // namespace raymill
