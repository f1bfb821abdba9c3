// A scene as plain data, after loading: validated, transformed to world space, tessellated.
// Everything the renderer, the reference and the commands know of the world is here; nothing here knows OpenCL.
// Geometry is kept in the structs that the kernels read (layout.h), so that a million triangles are not copied;
// the rest is kept as the user said it, and each consumer derives what it needs.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "layout.h"
#include "scene/error.hpp"

namespace raymill {

enum class Integrator { whitted, path };
enum class ShadowMode { filtered, opaque, none };
enum class ShadowOffset { robust, none };
enum class Projection { perspective, orthographic };
enum class Shading { flat, gouraud, phong };
enum class Highlight { phong, blinn };

/// Fractions of the image, in pbrt's order; pixels are those whose index lies in [ceil(x0 w), ceil(x1 w)).
struct Crop {
    double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
};

inline constexpr int largest_side = 32768;  // of an image, in pixels

struct RenderSettings {
    int width = 640;
    int height = 480;
    int spp = 1;
    int depth = 5;
    Integrator integrator = Integrator::whitted;
    glm::dvec3 background{0};
    ShadowMode shadows = ShadowMode::filtered;
    ShadowOffset shadow_offset = ShadowOffset::robust;
    std::uint32_t seed = 0;
    double exposure = 0;  // stops, PNG only
    double min_weight = 0;
    Crop crop;
};

struct Camera {
    Projection projection = Projection::perspective;
    glm::dvec3 eye{0, 1, 5};
    glm::dvec3 look_at{0, 1, 0};
    glm::dvec3 up{0, 1, 0};
    double fov = 40;      // vertical, degrees; perspective
    double height = 2;    // full height of the view; orthographic
    double aperture = 0;  // lens diameter; 0 is a pinhole
    double focus = 0;     // distance along the viewing axis to the plane in focus; 0 means |look_at - eye|
};

/// Cells of a cubic checker in world space: with c = floor(p / scale + 1/4096), odd(c.x + c.y + c.z) picks b, else a.
/// The shift keeps a surface that lies on the border of two layers, such as a floor at y = 0, in one of them.
struct Checker {
    glm::vec3 a{1};
    glm::vec3 b{0};
    float scale = 1;
};

/// Colours are linear RGB; the names are those of the scene file.
struct SceneMaterial {
    std::string name;
    glm::vec3 ambient{0};
    glm::vec3 diffuse{0.8f};
    std::optional<Checker> diffuse_checker;
    std::optional<std::uint32_t> diffuse_map;  // index into Scene::images; it multiplies `diffuse`
    glm::vec3 specular{0};
    float shininess = 32;
    Highlight highlight = Highlight::phong;
    Shading shading = Shading::phong;
    glm::vec3 emission{0};
    bool one_sided_emission = false;  // the back of a rectangle or disk light does not shine; no key of the scene file
    float reflection = 0;
    float transmission = 0;
    glm::vec3 base_color{1};
    float ior = 1.5f;
    float exterior_ior = 1;
    bool fresnel = false;
    glm::vec3 absorption{0};  // per unit length
};

/// Linear RGB, row by row from the top; uv (0, 0) is the bottom left corner of the image, (1, 1) the top right.
struct TextureImage {
    std::string file;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<glm::vec3> texels;
};

struct AmbientLight {
    glm::vec3 color{1};
};

struct PointLight {
    glm::vec3 position{0};
    glm::vec3 intensity{1};
    glm::vec3 attenuation{1, 0, 0};
    float radius = 0;
};

struct DirectionalLight {
    glm::vec3 direction{0, -1, 0};  // the way the light travels; any length but zero
    glm::vec3 intensity{1};
};

struct SpotLight {
    glm::vec3 position{0};
    glm::vec3 direction{0, -1, 0};
    glm::vec3 intensity{1};
    glm::vec3 attenuation{1, 0, 0};
    float inner_angle = 0;  // degrees, half angles; equal to outer_angle for a hard edge
    float outer_angle = 45;
};

struct RectangleLight {
    glm::vec3 center{0};
    glm::vec3 edge_u{1, 0, 0};  // full edges; shines towards edge_u x edge_v
    glm::vec3 edge_v{0, 0, -1};
    glm::vec3 radiance{1};
};

struct DiskLight {
    glm::vec3 center{0};
    glm::vec3 normal{0, -1, 0};
    float radius = 1;
    glm::vec3 radiance{1};
};

struct SphereLight {
    glm::vec3 center{0};
    float radius = 1;
    glm::vec3 radiance{1};
};

struct EnvironmentLight {
    glm::vec3 radiance{1};
    std::optional<std::uint32_t> map;  // index into Scene::images, lat-long, +y up
};

struct SceneLight {
    std::variant<AmbientLight, PointLight, DirectionalLight, SpotLight, RectangleLight, DiskLight, SphereLight,
                 EnvironmentLight>
        light;
    std::uint32_t samples = 1;
    bool visible = true;              // area lights: seen by camera and secondary rays
    std::uint32_t object = NO_INDEX;  // the visible area light's geometry: an index into Scene::objects
};

/// A named piece of the scene: what `check` lists and what ids refer to.
struct SceneObject {
    std::string name;        // of the mesh group, else the shape's
    std::string shape;       // the scene file's word
    double chord_error = 0;  // largest distance between the exact surface and its triangles, scene units
};

/// Primitive ids: triangles, then spheres, then planes, each in order.
struct Scene {
    std::string file;  // as the user named it
    RenderSettings settings;
    Camera camera;
    std::vector<SceneMaterial> materials;  // [0] is the default of objects without one
    std::vector<SceneLight> lights;
    std::vector<SceneObject> objects;
    std::vector<TextureImage> images;
    std::vector<Vertex> vertices;
    std::vector<Triangle> triangles;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Diagnostic> warnings;
    std::uint64_t hash = 0;  // of the bytes of every file it was loaded from

    std::uint32_t primitive_count() const {
        return static_cast<std::uint32_t>(triangles.size() + spheres.size() + planes.size());
    }
};

/// The rendered window in pixels of a width x height image: [x0, x0 + width) x [y0, y0 + height).
struct PixelWindow {
    int x0 = 0, y0 = 0, width = 0, height = 0;
};
/// May be empty (width or height 0) where the crop falls between pixel borders.
PixelWindow crop_window(const RenderSettings& settings);

/// Loads a scene file (.toml) or a bare model (.obj, .ply, .gltf, .glb), whatever its extension says.
/// Throws SceneError with all faults found (bad input), never leaves a partial scene.
Scene load_scene(const std::string& file);

/// The scene file that rendering this bare model uses, as TOML text: camera, lights, and one mesh object.
std::string model_scene_toml(const std::string& model_file);

}  // namespace raymill
