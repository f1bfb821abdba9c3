// The shadow stage: what is left of a light sample behind everything in its way.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "verify/compare.hpp"
#include "verify/crossing.hpp"
#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

// Undecided crossings of one ray that are tried in all combinations.
constexpr std::size_t most_combined = 12;

void compare_light(Comparison& c, const ShadowItem& item, const dvec3& left) {
    const auto compare = [&](const char* name, const Units& units, const float(&term)[3]) {
        const dvec3 expected = glm::min(left * reference::to_dvec3(term), dvec3(FILM_LIMIT));
        for (int k = 0; k < 3; ++k)
            // Each filter rounds three times; a ray that meets more than eight of them has little light left to err.
            c.number(fmt::format("{}[{}]", name, k), from_units(units[k]), expected[k],
                     26 * rounding * std::abs(expected[k]) + film_rounding);
    };
    compare("diffuse", item.arrived.diffuse, item.ray.diffuse);
    compare("specular", item.arrived.specular, item.ray.specular);
}

/// Crossings along the ray by what single precision may make of them.
struct OnTheWay {
    dvec3 certain{1};              // product of the filters that are crossed in any case
    std::vector<dvec3> undecided;  // filters that may be crossed or not
    double clarity = 0;            // of the clearest of those
};

OnTheWay on_the_way(const Truth& truth, const reference::Ray& ray, double t_max) {
    OnTheWay way;
    for (std::uint32_t id = 0; id < truth.scene.primitive_count(); ++id) {
        for (const Crossing& crossing : crossings(truth.scene, ray, id)) {
            if (!crossing.possible() || crossing.t - crossing.t_error > t_max) continue;
            const double from_end = std::abs(crossing.t - t_max);
            const bool before_end = crossing.t + crossing.t_error < t_max;
            const dvec3 filter = shadow_filter(truth.scene, id);
            if (crossing.certain() && before_end) {
                way.certain *= filter;
                continue;
            }
            way.undecided.push_back(filter);
            const double by_end = crossing.t_error > 0 ? from_end / crossing.t_error : INFINITY;
            way.clarity = std::max(way.clarity, std::min(crossing.clarity(), before_end ? INFINITY : by_end));
        }
    }
    return way;
}

/// Whether some choice of the undecided crossings gives what the kernel has.
bool is_possible(const ShadowItem& item, const OnTheWay& way) {
    const std::size_t count = std::min(way.undecided.size(), most_combined);
    for (std::size_t choice = 0; choice < std::size_t{1} << count; ++choice) {
        dvec3 left = way.certain;
        for (std::size_t i = 0; i < count; ++i)
            if (choice >> i & 1) left *= way.undecided[i];
        Comparison c;
        compare_light(c, item, left);
        if (c.ratio() <= 1) return true;
    }
    return false;
}

}  // namespace

Comparison compare_arrival(const Truth& truth, const ShadowItem& item) {
    const reference::Ray ray = reference_ray(item.ray);
    Comparison c;
    compare_light(c, item, truth.tracer.visibility(ray, item.ray.t_max));
    if (c.ratio() <= 1 || truth.scene.settings.shadows == ShadowMode::none) return c;
    const OnTheWay way = on_the_way(truth, ray, item.ray.t_max);
    if (!way.undecided.empty() && is_possible(item, way))
        c.disagree("another of the undecided crossings blocks or filters", way.clarity);
    return c;
}

}  // namespace raymill::verify
