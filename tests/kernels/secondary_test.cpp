// Children of hits against the reference's split: which there are, where they go and what they weigh.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "kernel_rig.hpp"
#include "lib/random.h"
#include "reference/formulas.hpp"
#include "surface_cases.hpp"

namespace raymill::test {
namespace {

using glm::dvec3;

SceneMaterial passing(float reflection, float transmission, float ior, float exterior, bool fresnel) {
    SceneMaterial m;
    m.reflection = reflection;
    m.transmission = transmission;
    m.base_color = {1, 0.5f, 0.25f};
    m.ior = ior;
    m.exterior_ior = exterior;
    m.fresnel = fresnel;
    return m;
}

Scene passing_scene() {
    Scene scene;
    scene.materials = {passing(0, 0, 1.5f, 1, false),        passing(0.5f, 0, 1.5f, 1, false),
                       passing(0, 0.75f, 1.5f, 1, false),    passing(0.25f, 0.5f, 1.5f, 1, false),
                       passing(0.25f, 0.75f, 1.5f, 1, true), passing(0.5f, 0.5f, 1.5f, 1.33f, true),
                       passing(0.25f, 0.5f, 1, 1, false),    passing(0.5f, 0.5f, 1, 1, true),
                       passing(0, 1, 2.4f, 1, true),         passing(0.5f, 0.5f, 1, 1.5f, false),
                       passing(1, 0, 1.5f, 1, true)};
    scene.materials[3].absorption = {0.5f, 0.25f, 0};
    scene.materials[4].absorption = {0, 0.125f, 1};
    scene.materials[3].shading = Shading::flat;
    add_surfaces(scene, 21);
    return scene;
}

/// One child as the reference has it, and how far single precision may be from it.
struct Child {
    dvec3 direction, throughput;
    double direction_error, weight_error;  // of the weight's share, absolute
    double side;                           // of the geometric surface, as the ray came from it: 1 or -1
};

struct Children {
    std::map<uint, Child> by_branch;
    bool ambiguous = false;  // a decision between the normals, or about total reflection, may fall either way
};

/// Every share of the energy follows the reflectance; how far that may be off is what an error of the cosine makes of
/// it.
double reflectance_error(double cos_i, double eta) {
    const double error = NORMAL_ERROR + 4 * ROUNDING;
    const auto at = [&](double c) { return reference::fresnel(std::clamp(c, 0.0, 1.0), eta); };
    const double here = at(cos_i);
    return 2 * std::max(std::abs(at(cos_i + error) - here), std::abs(at(cos_i - error) - here)) + 32 * ROUNDING;
}

Children expected_children(const Scene& scene, const reference::Tracer& tracer, const Ray& ray, const Hit& hit) {
    const reference::Ray r = exact(ray);
    const reference::Surface s = tracer.surface(r, exact(hit));
    const reference::Split split = tracer.split(r, s);
    const SceneMaterial& m = scene.materials[s.material];
    const dvec3 absorbed = s.inside ? glm::exp(-double{hit.t} * dvec3(m.absorption)) : dvec3(1);
    const dvec3 weight = reference::to_dvec3(ray.throughput) * absorbed * dvec3(m.base_color);
    const double side = s.inside ? -1 : 1;
    const dvec3 n = side * s.shading_normal, ng = side * s.geometric_normal, d = glm::normalize(r.direction);
    const double inward = double{m.ior} / m.exterior_ior, eta = s.inside ? 1 / inward : inward;
    const double cos_i = -glm::dot(d, n);

    Children children;
    // Reflection turns by twice the normal's error, with 9 roundings.
    const double reflect_error = 2 * NORMAL_ERROR + 9 * ROUNDING;
    // Refraction: the tangential part errs by twice the normal's over eta, and so does its square; the normal part is
    // the root of one minus that.
    const double tangent_error = (2 * NORMAL_ERROR + 8 * ROUNDING) / eta;
    const double cos2_t = 1 - (1 - cos_i * cos_i) / (eta * eta);
    const double cos_error = 2 * tangent_error / std::max(std::sqrt(std::abs(cos2_t)), std::sqrt(tangent_error));
    const double refract_error = eta == 1 ? 2 * ROUNDING : tangent_error + 2 * cos_error + NORMAL_ERROR;
    const double share_error =
        m.fresnel ? std::max(reflectance_error(cos_i, eta), reflectance_error(-glm::dot(d, ng), eta)) : 2 * ROUNDING;
    const auto refracted = reference::refract(d, n, eta);
    children.ambiguous = std::abs(glm::dot(d, ng)) < 2 * NORMAL_ERROR ||
                         std::abs(glm::dot(reference::reflect(d, n), ng)) < 4 * NORMAL_ERROR ||
                         (eta != 1 && std::abs(cos2_t) < 8 * tangent_error) ||
                         (refracted && std::abs(glm::dot(*refracted, ng)) < refract_error + NORMAL_ERROR);
    if (split.reflection > 0)
        children.by_branch[0] = {split.reflected, weight * split.reflection, reflect_error, share_error, 1};
    if (split.transmission > 0)
        children.by_branch[1] = {split.refracted, weight * split.transmission, refract_error, share_error, -1};
    return children;
}

class Secondary : public testing::Test {
  protected:
    void expect_child(const Ray& child, const Ray& parent, const Hit& hit, uint branch, const Child& e) const {
        ASSERT_EQ(child.sample, parent.sample);
        ASSERT_EQ(child.route, parent.route != ROUTE_CAMERA ? parent.route
                               : branch == 0                ? ROUTE_REFLECTED
                                                            : ROUTE_REFRACTED);
        const reference::Surface s = tracer_.surface(exact(parent), exact(hit));
        const SceneMaterial& m = scene_.materials[s.material];
        ASSERT_LE(glm::length(reference::to_dvec3(child.direction) - e.direction), e.direction_error);
        ASSERT_NEAR(glm::length(reference::to_dvec3(child.direction)), 1, 5 * ROUNDING);
        for (int k = 0; k < 3; ++k) {
            // Absorption: 10 roundings, its exponent is below 4; 3 products and a difference of shares.
            const double full = double{parent.throughput[k]} * m.base_color[k];
            ASSERT_NEAR(child.throughput[k], e.throughput[k], full * e.weight_error + 24 * ROUNDING * e.throughput[k]);
        }
        const dvec3 origin = reference::to_dvec3(child.origin);
        ASSERT_LE(glm::length(origin - s.position), POSITION_ERROR + 128 * ROUNDING);  // a plane's offset of 4 + 4
        const double height = (s.inside ? -1 : 1) * height_over(scene_, hit.primitive, origin);
        ASSERT_GT(height * e.side, 0) << "starts on the wrong side";
    }

    const Scene scene_ = passing_scene();
    const reference::Tracer tracer_{scene_};
    const KernelRig rig_{scene_};
};

/// Children by parent and branch. The order in the queue is open, but no key may come twice.
std::map<std::pair<uint, uint>, Ray> by_parent(const SecondaryResult& result, const std::vector<Ray>& parents) {
    std::map<std::pair<uint, uint>, Ray> found;
    for (std::size_t i = 0; i < result.film.counters.children; ++i) {
        const Ray& child = result.children.at(i);
        const uint parent_path = parents.at(child.pixel).path;
        const uint branch = child.path == path_child(parent_path, 0) ? 0 : 1;
        EXPECT_EQ(child.path, path_child(parent_path, branch));
        EXPECT_TRUE(found.emplace(std::pair(child.pixel, branch), child).second) << "twice";
    }
    return found;
}

TEST_F(Secondary, every_child_is_the_reference_s) {
    const HitQueue queue = random_hits(scene_, 20000, 22, 19);
    const SecondaryResult result = rig_.secondary(queue.rays, queue.hits, 40000);
    const auto found = by_parent(result, queue.rays);
    std::size_t ambiguous = 0, compared = 0;
    for (uint i = 0; i < queue.rays.size(); ++i) {
        Children expected;
        if (queue.hits[i].primitive != NO_INDEX)
            expected = expected_children(scene_, tracer_, queue.rays[i], queue.hits[i]);
        if (expected.ambiguous) {
            ++ambiguous;
            continue;
        }
        SCOPED_TRACE(testing::Message() << "hit " << i << " on primitive " << queue.hits[i].primitive);
        for (uint branch = 0; branch < 2; ++branch) {
            const auto child = found.find({i, branch});
            const auto wanted = expected.by_branch.find(branch);
            ASSERT_EQ(child != found.end(), wanted != expected.by_branch.end()) << "branch " << branch;
            if (child == found.end()) continue;
            ++compared;
            expect_child(child->second, queue.rays[i], queue.hits[i], branch, wanted->second);
            if (HasFatalFailure()) return;
        }
    }
    EXPECT_LT(ambiguous, queue.rays.size() / 200);
    EXPECT_GT(compared, queue.rays.size() / 2);
    EXPECT_EQ(touched_from(result.children, result.film.counters.children), 0u);
}

TEST_F(Secondary, queues_of_any_size_spawn_the_same_children) {
    const HitQueue queue = random_hits(scene_, 300, 23);
    const auto whole = by_parent(rig_.secondary(queue.rays, queue.hits, 600), queue.rays);
    for (const uint size : {0u, 1u, 63u, 64u, 65u, FAMILY - 1u, FAMILY + 0u, FAMILY + 1u, 300u}) {
        const std::span<const Hit> hits(queue.hits.data(), size);
        const SecondaryResult part = rig_.secondary(std::span(queue.rays).first(size), hits, 2 * size);
        const auto found = by_parent(part, queue.rays);
        for (const auto& [key, child] : found) ASSERT_TRUE(same_bits(child, whole.at(key))) << size;
        const auto wanted = std::ranges::count_if(whole, [&](const auto& entry) { return entry.first.first < size; });
        EXPECT_EQ(found.size(), static_cast<std::size_t>(wanted)) << size;
        EXPECT_EQ(touched_from(part.children, part.film.counters.children), 0u);
    }
}

TEST_F(Secondary, a_batch_in_the_middle_of_a_queue_spawns_like_one_at_its_start) {
    const HitQueue queue = random_hits(scene_, 600, 24);
    const std::span<const Hit> hits(queue.hits.data() + 70, 530);
    const auto middle = by_parent(rig_.secondary(queue.rays, hits, 1200, 70), queue.rays);
    const auto start = by_parent(rig_.secondary(std::span(queue.rays).subspan(70), hits, 1200), queue.rays);
    ASSERT_EQ(middle.size(), start.size());
    for (const auto& [key, child] : middle) ASSERT_TRUE(same_bits(child, start.at(key)));
}

TEST_F(Secondary, children_fill_the_capacity_to_the_last_and_never_beyond) {
    const HitQueue queue = random_hits(scene_, 1000, 25);
    const auto count = static_cast<uint>(rig_.secondary(queue.rays, queue.hits, 2000).film.counters.children);
    ASSERT_GT(count, 1000u);
    const SecondaryResult exactly = rig_.secondary(queue.rays, queue.hits, count);
    EXPECT_EQ(exactly.film.counters.children, count);
    EXPECT_EQ(by_parent(exactly, queue.rays).size(), count);
    EXPECT_EQ(touched_from(exactly.children, 0), count);
    for (const uint capacity : {count - 1, count - 64, count / 2, 64u, 1u, 0u}) {
        const SecondaryResult less = rig_.secondary(queue.rays, queue.hits, capacity);
        if (capacity == count / 2) {
            EXPECT_GT(touched_from(less.children, 0), 0u) << "some work-items fit";
        }
        EXPECT_EQ(less.film.counters.children, count) << "what was asked for is counted all the same";
        EXPECT_EQ(touched_from(less.children, capacity), 0u) << capacity;
    }
}

TEST(SecondaryWeights, children_below_the_least_weight_are_cut) {
    Scene scene = passing_scene();
    scene.settings.min_weight = 0.125;
    const HitQueue queue = random_hits(scene, 3000, 26);
    const auto kept = by_parent(KernelRig(scene).secondary(queue.rays, queue.hits, 6000), queue.rays);
    scene.settings.min_weight = 0;
    const auto all = by_parent(KernelRig(scene).secondary(queue.rays, queue.hits, 6000), queue.rays);
    std::size_t cut = 0;
    for (const auto& [key, child] : all) {
        const bool heavy = *std::ranges::max_element(child.throughput) >= 0.125f;
        ASSERT_EQ(kept.contains(key), heavy);
        if (heavy) {
            ASSERT_TRUE(same_bits(child, kept.at(key)));
        }
        cut += !heavy;
    }
    EXPECT_GT(cut, 100u);
    EXPECT_GT(kept.size(), 100u);
}

TEST(SecondaryAngles, equal_indices_pass_every_direction_unchanged_and_reflect_nothing_of_fresnel) {
    Scene scene;
    scene.materials = {passing(0.5f, 0.5f, 1.25f, 1.25f, true)};
    add_plane(scene, {0, 0, 0}, {0, 0, 1});
    HitQueue queue;
    for (uint i = 0; i < 64; ++i) {
        // From steep to so grazing that the cosine's square is lost.
        const double cosine = std::exp2(-0.5 * i);
        const glm::vec3 direction(std::sqrt(1 - cosine * cosine), 0, -cosine);
        queue.rays.push_back(make_ray({0, 0, static_cast<float>(cosine)}, direction, i));
        queue.hits.push_back({1, 0, 0, 0});
    }
    const auto found = by_parent(KernelRig(scene).secondary(queue.rays, queue.hits, 128), queue.rays);
    ASSERT_EQ(found.size(), 64u);
    for (const auto& [key, child] : found) {
        EXPECT_EQ(key.second, 1u);
        EXPECT_EQ(vec3_of(child.direction), vec3_of(queue.rays[key.first].direction)) << key.first;
    }
}

TEST(SecondaryAngles, past_the_critical_angle_the_reflected_ray_carries_both_weights) {
    Scene scene;
    scene.materials = {passing(0.25f, 0.5f, 1.5f, 1, false)};
    add_plane(scene, {0, 0, 0}, {0, 0, 1});
    HitQueue queue;
    for (uint i = 0; i < 64; ++i) {
        // From inside (below), at sines from 0.68 to 0.99: all past 1 / 1.5.
        const float sine = 0.68f + 0.31f * static_cast<float>(i) / 63;
        queue.rays.push_back(make_ray({0, 0, -1}, {sine, 0, std::sqrt(1 - sine * sine)}, i));
        queue.hits.push_back({1 / std::sqrt(1 - sine * sine), 0, 0, 0});
    }
    const auto found = by_parent(KernelRig(scene).secondary(queue.rays, queue.hits, 128), queue.rays);
    ASSERT_EQ(found.size(), 64u);
    for (const auto& [key, child] : found) {
        EXPECT_EQ(key.second, 0u);
        EXPECT_EQ(vec3_of(child.throughput), 0.75f * glm::vec3(1, 0.5f, 0.25f));
    }
}

}  // namespace
}  // namespace raymill::test
