#include "wavefront/device_scene.hpp"

#include "common/huge_pages.hpp"
#include "wavefront/records.hpp"

namespace raymill {

namespace {

/// Room in huge pages where the device is this processor, since rays read scenes at random; queues are read in order.
template <class T>
Buffer<T> scene_buffer(const Device& device, std::size_t size) {
    Buffer<T> buffer(device, size);
    const std::size_t bytes = size * sizeof(T);
    if (bytes < 2 * HUGE_PAGE || device.info.type != "CPU") return buffer;
    // Such a device maps a buffer where it is.
    void* mapped = device.queue.enqueueMapBuffer(buffer.memory(), CL_TRUE, CL_MAP_WRITE_INVALIDATE_REGION, 0, bytes);
    ask_for_huge_pages(mapped, bytes);
    device.queue.enqueueUnmapMemObject(buffer.memory(), mapped);
    return buffer;
}

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
    Buffer<float> texels = scene_buffer<float>(device, 3 * count);
    std::size_t first = 0;
    for (const TextureImage& image : scene.images) {
        texels.write(device, {&image.texels.data()->x, 3 * image.texels.size()}, first);
        first += 3 * image.texels.size();
    }
    return texels;
}

/// Of any contiguous array.
template <class Array>
auto upload(const Device& device, const Array& values) {
    using T = typename Array::value_type;
    Buffer<T> buffer = scene_buffer<T>(device, values.size());
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
