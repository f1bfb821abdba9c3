// A scene in device memory: everything that the kernels read and none of them writes.
#pragma once

#include "bvh/bvh.hpp"
#include "scene/scene.hpp"
#include "wavefront/buffer.hpp"
#include "wavefront/film_planes.hpp"

namespace raymill {

struct DeviceScene {
    DeviceScene(const Device& device, const Scene& scene, const Bvh& bvh, const FilmPlanes& planes = {});

    Buffer<BvhNode> nodes;
    Buffer<TriangleBlock> triangle_blocks;
    Buffer<SphereBlock> sphere_blocks;
    Buffer<Vertex> vertices;
    Buffer<Triangle> triangles;
    Buffer<Sphere> spheres;
    Buffer<Plane> planes;
    Buffer<Material> materials;
    Buffer<Texture> textures;
    Buffer<float> texels;
    Buffer<LightRecord> lights;
    Buffer<LightSlot> light_slots;
    Buffer<CameraRecord> camera;
    Buffer<SceneConstants> constants;
};

}  // namespace raymill
