#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/random.h"
#include "verify/compare.hpp"

namespace raymill::verify {

namespace {

std::string vector_text(const float (&v)[3]) {
    return fmt::format("({:.9g}, {:.9g}, {:.9g})", v[0], v[1], v[2]);
}

/// Bounds on a camera ray, counted in roundings over lib/camera.h.
struct CameraBounds {
    double origin, direction;
};

CameraBounds camera_bounds(const Scene& scene) {
    const Camera& camera = scene.camera;
    const RenderSettings& settings = scene.settings;
    const bool orthographic = camera.projection == Projection::orthographic;
    const double up = orthographic ? camera.height / 2 : std::tan(glm::radians(camera.fov) / 2);
    const double film = up * (1 + static_cast<double>(settings.width) / settings.height);  // both half edges
    const double eye = std::max({std::abs(camera.eye.x), std::abs(camera.eye.y), std::abs(camera.eye.z)});
    // The place on the film has five roundings, its two vectors one each, the sums three more.
    const double on_film = 10 * rounding * (1 + film);
    // lib/math.h: a point of the unit disk errs by less than 1e-6; its axes and scale by six roundings.
    const double lens = camera.aperture / 2 * (1e-6 + 8 * rounding);
    CameraBounds b{2 * rounding * (eye + film) + lens, on_film + 5 * rounding};
    if (orthographic) b.origin += on_film;
    if (camera.aperture > 0) {
        const double focus = camera.focus > 0 ? camera.focus : glm::length(camera.look_at - camera.eye);
        b.direction += lens / focus + 2 * rounding * (camera.aperture / focus + film);
    }
    return b;
}

}  // namespace

std::string describe(const Ray& ray) {
    return fmt::format(
        "  ray: pixel {}, sample {}, path {:08x}, route {}\n       origin {}\n       direction {}\n       throughput "
        "{}\n",
        ray.pixel, ray.sample, ray.path, ray.route, vector_text(ray.origin), vector_text(ray.direction),
        vector_text(ray.throughput));
}

std::string describe(const Hit& hit) {
    if (hit.primitive == NO_INDEX) return "  hit: none\n";
    return fmt::format("  hit: primitive {}, t {:.9g}, u {:.9g}, v {:.9g}\n", hit.primitive, hit.t, hit.u, hit.v);
}

std::string describe(const ShadowRay& ray) {
    return fmt::format(
        "  shadow ray: pixel {}, route {}, light {}, t_max {:.9g}\n       origin {}\n       direction {}\n"
        "       diffuse {}\n       specular {}\n",
        ray.pixel, ray.route, ray.light, ray.t_max, vector_text(ray.origin), vector_text(ray.direction),
        vector_text(ray.diffuse), vector_text(ray.specular));
}

Comparison compare_camera_ray(const Truth& truth, const Ray& ray) {
    const RenderSettings& settings = truth.scene.settings;
    const PixelWindow window = crop_window(settings);
    const int x = window.x0 + static_cast<int>(ray.pixel) % window.width;
    const int y = window.y0 + static_cast<int>(ray.pixel) / window.width;
    const reference::Ray expected = truth.tracer.camera_ray(x, y, ray.sample);
    const CameraBounds bounds = camera_bounds(truth.scene);
    Comparison c;
    c.vector("origin", ray.origin, expected.origin, dvec3(bounds.origin));
    c.vector("direction", ray.direction, expected.direction, dvec3(bounds.direction));
    c.vector("throughput", ray.throughput, dvec3(1), dvec3(0));
    c.same("path", ray.path, path_camera(settings.seed, static_cast<uint>(y * settings.width + x)));
    c.same("route", ray.route, ROUTE_CAMERA);
    return c;
}

}  // namespace raymill::verify
