// The intersect stage: the closest hit, and the background where there is none.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "verify/compare.hpp"
#include "verify/crossing.hpp"
#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

// Hits that are each undecided, one behind the other, before a ray is given up as a failure.
constexpr int most_undecided = 64;

/// The first hit that no rounding can undo, and how clear those before it are at most.
struct FirstCertain {
    double t = INFINITY;
    double t_error = 0;
    double clarity = 0;
};

FirstCertain first_certain(const Truth& truth, const reference::Ray& ray) {
    FirstCertain first;
    double t = 0;
    for (int i = 0; i < most_undecided; ++i) {
        const reference::Hit hit = truth.tracer.intersect(ray, t);
        if (hit.primitive == NO_INDEX) return first;
        const auto all = crossings(truth.scene, ray, hit.primitive);
        const Crossing* crossing = nearest(all, hit.t);
        if (!crossing || crossing->certain()) return {hit.t, crossing ? crossing->t_error : 0, first.clarity};
        first.clarity = std::max(first.clarity, crossing->clarity());
        t = hit.t;
    }
    return {t, 0, INFINITY};
}

/// How far the kernel's answer is from being a right one: below 1 it is, given what single precision cannot tell.
double margin_of(const Truth& truth, const reference::Ray& ray, const Hit& hit) {
    const FirstCertain first = first_certain(truth, ray);
    if (hit.primitive == NO_INDEX) return first.t < INFINITY ? INFINITY : first.clarity;
    const auto all = crossings(truth.scene, ray, hit.primitive);
    const Crossing* crossing = nearest(all, hit.t);
    if (!crossing || !crossing->possible()) return INFINITY;
    double margin = first.clarity;
    if (crossing->margin < 0 || crossing->t < 0) margin = std::max(margin, crossing->clarity());
    const auto over = [](double excess, double error) { return error > 0 ? excess / error : INFINITY; };
    margin = std::max(margin, over(std::abs(hit.t - crossing->t), crossing->t_error));
    if (is_triangle(truth.scene, hit.primitive)) {
        margin = std::max(margin, over(std::abs(hit.u - crossing->u), crossing->weight_error));
        margin = std::max(margin, over(std::abs(hit.v - crossing->v), crossing->weight_error));
    }
    // Farther than a certain hit by no more than the errors of both: a tie.
    if (crossing->t > first.t)
        margin = std::max(margin, over(crossing->t - first.t, crossing->t_error + first.t_error));
    return margin;
}

/// What a ray that misses adds.
void compare_background(Comparison& c, const Truth& truth, const Ray& ray, const Contribution& added) {
    const dvec3 direction = reference::to_dvec3(ray.direction), weight = reference::to_dvec3(ray.throughput);
    const dvec3 sky = truth.tracer.background(glm::normalize(direction));
    // lib/math.h: an angle errs by 5e-7, which moves the lookup; the reference is asked again that far around.
    dvec3 spread(0);
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 shift(0);
        shift[axis] = 1.5e-6;
        for (const dvec3& d : {direction - shift, direction + shift})
            spread = glm::max(spread, glm::abs(truth.tracer.background(glm::normalize(d)) - sky));
    }
    const dvec3 expected = weight * sky;
    const dvec3 bound = weight * (3.0 * spread + 10 * rounding * glm::abs(sky)) + film_rounding;
    for (int k = 0; k < 3; ++k)
        c.number(fmt::format("background[{}]", k), from_units(added.emission[k]),
                 std::clamp(expected[k], -double{FILM_LIMIT}, double{FILM_LIMIT}), bound[k]);
    c.number("coverage", from_units(added.coverage), 0, 0);
}

}  // namespace

Comparison compare_hit(const Truth& truth, const Ray& ray, const Hit& hit, const Contribution& added) {
    const reference::Ray r = reference_ray(ray);
    const reference::Hit expected = truth.tracer.intersect(r);
    Comparison c;
    c.number("primitive", static_cast<double>(hit.primitive), static_cast<double>(expected.primitive), 0);
    if (hit.primitive != expected.primitive) {
        c.number("t", hit.t, expected.t, 0);
        c.disagree(
            fmt::format("the kernel hits {}, the reference {}",
                        hit.primitive == NO_INDEX ? "nothing" : fmt::format("primitive {}", hit.primitive),
                        expected.primitive == NO_INDEX ? "nothing" : fmt::format("primitive {}", expected.primitive)),
            margin_of(truth, r, hit));
        return c;
    }
    if (hit.primitive == NO_INDEX) {
        compare_background(c, truth, ray, added);
        return c;
    }
    c.same("adds nothing", added.total() == Units{} && added.coverage == 0, true);
    const auto all = crossings(truth.scene, r, hit.primitive);
    const Crossing* crossing = nearest(all, expected.t);
    c.number("t", hit.t, expected.t, crossing->t_error);
    if (is_triangle(truth.scene, hit.primitive)) {
        c.number("u", hit.u, expected.u, crossing->weight_error);
        c.number("v", hit.v, expected.v, crossing->weight_error);
    }
    // The other end of a sphere's chord, where the first is too close to the start to be told from one behind it.
    if (!(c.ratio() <= 1) && all.size() > 1) {
        const double margin = margin_of(truth, r, hit);
        if (margin < 1) c.disagree("the kernel hits the other end of the chord", margin);
    }
    return c;
}

}  // namespace raymill::verify
