// Shadow rays, and the light that needs none, against the reference's local terms, hit by hit and field by field.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "kernel_rig.hpp"
#include "surface_cases.hpp"

namespace raymill::test {
namespace {

using glm::dvec3;

// Further bounds in units of ROUNDING, for lights at distances above 2 and below 12, with coordinates below 8:
//   direction: position of the hit (32) and of the sample (8 roundings of 8 at most, 64) over the distance (2), and 5.
//   cosine: directions of light (53) and normal (32), 3 roundings.
//   mirror: 2 (n.l) n - l turns by twice the normal's error and the cosine's, and has 4 roundings.
constexpr double DIRECTION_ERROR = 53 * ROUNDING;
constexpr double COSINE_ERROR = 88 * ROUNDING;
constexpr double HIGHLIGHT_ERROR = (2 * 32 + 2 * 88 + 53 + 8) * ROUNDING;

SceneLight light_of(auto light, uint samples = 1) {
    SceneLight scene_light;
    scene_light.light = light;
    scene_light.samples = samples;
    return scene_light;
}

/// Each kind of light that casts shadow rays, around the surfaces.
std::vector<SceneLight> all_lights() {
    std::vector<SceneLight> lights;
    lights.push_back(light_of(AmbientLight{{0.5f, 0.25f, 0.125f}}));
    lights.push_back(light_of(PointLight{{6, 5, 4}, {3, 2, 1}, {1, 0, 0}, 0}));
    lights.push_back(light_of(PointLight{{-6, 4, 5}, {30, 20, 10}, {0.5f, 0.25f, 0.125f}, 0.5f}, 2));
    lights.push_back(light_of(DirectionalLight{{1, -2, 0.5f}, {1, 2, 3}}));
    lights.push_back(light_of(SpotLight{{0, 7, 0}, {0.1f, -1, 0.2f}, {5, 6, 7}, {0, 0, 0.0625f}, 15, 50}));
    lights.push_back(light_of(RectangleLight{{0, 6, 6}, {2, 0, 0}, {0, -1, 1}, {8, 4, 2}}, 3));
    lights.push_back(light_of(DiskLight{{-6, 0, -5}, {1, 0.1f, 1}, 0.75f, {9, 9, 3}}, 2));
    lights.push_back(light_of(SphereLight{{6, -5, 0.5f}, 1.25f, {2, 3, 4}}, 2));
    return lights;
}

SceneMaterial material_of(Shading shading, Highlight highlight, float shininess) {
    SceneMaterial m;
    m.ambient = {0.25f, 0.5f, 0.75f};
    m.diffuse = {0.75f, 0.5f, 0.25f};
    m.specular = {0.5f, 0.25f, 1};
    m.shading = shading;
    m.highlight = highlight;
    m.shininess = shininess;
    return m;
}

std::vector<SceneMaterial> all_materials() {
    std::vector<SceneMaterial> materials;
    for (const Shading shading : {Shading::flat, Shading::gouraud, Shading::phong})
        for (const Highlight highlight : {Highlight::phong, Highlight::blinn})
            materials.push_back(material_of(shading, highlight, shading == Shading::flat ? 0.0f : 24.0f));
    SceneMaterial special = material_of(Shading::phong, Highlight::phong, 1);
    special.diffuse_map = 0;
    materials.push_back(special);
    special = material_of(Shading::phong, Highlight::phong, 2);
    special.diffuse_checker = Checker{{1, 0.5f, 0}, {0, 0.25f, 1}, 0.75f};
    materials.push_back(special);
    special = material_of(Shading::phong, Highlight::phong, 8);
    special.reflection = 0.25f;
    special.transmission = 0.5f;
    special.absorption = {0.5f, 0.125f, 0};
    special.emission = {0.5f, 2, 0};
    materials.push_back(special);
    special = material_of(Shading::flat, Highlight::phong, 8);
    special.emission = {3, 0, 1};
    special.one_sided_emission = true;
    materials.push_back(special);
    return materials;
}

Scene shading_scene() {
    Scene scene;
    scene.materials = all_materials();
    scene.lights = all_lights();
    scene.settings.spp = 4;
    Random random(1);
    TextureImage image{"", 8, 4, {}};
    for (int i = 0; i < 32; ++i) image.texels.push_back(random.in_cube(0, 1));
    scene.images.push_back(image);
    add_surfaces(scene, 2);
    return scene;
}

/// One light sample of the scene's list.
struct Slot {
    uint light, sample;
};

std::vector<Slot> slots_of(const Scene& scene) {
    std::vector<Slot> slots;
    for (uint light = 0; light < scene.lights.size(); ++light)
        if (!std::holds_alternative<AmbientLight>(scene.lights[light].light))
            for (uint sample = 0; sample < scene.lights[light].samples; ++sample) slots.push_back({light, sample});
    return slots;
}

/// Everything that the reference says of a hit and a light sample, and how far single precision may be from it.
struct Expected {
    reference::Surface surface;
    reference::LightSample light;
    dvec3 diffuse, specular;  // weighted
    dvec3 diffuse_error, specular_error;
    double distance_error;
    bool ambiguous;  // a guard, a checker's border or a basis may fall either way
};

/// I_in without what shapes its cone or its cosine, and how steep that is.
struct Unshaped {
    dvec3 incoming;
    double steepness;
};

Unshaped unshaped(const SceneLight& source, const reference::LightSample& sample) {
    const double d = sample.distance, n = source.samples;
    if (const auto* spot = std::get_if<SpotLight>(&source.light)) {
        const dvec3 c = spot->attenuation;
        const double inner = std::cos(glm::radians(double{spot->inner_angle}));
        const double outer = std::cos(glm::radians(double{spot->outer_angle}));
        return {dvec3(spot->intensity) / (c.x + c.y * d + c.z * d * d) / n, 2 / (inner - outer)};
    }
    if (const auto* area = std::get_if<RectangleLight>(&source.light)) {
        const double size = glm::length(glm::cross(dvec3(area->edge_u), dvec3(area->edge_v)));
        return {dvec3(area->radiance) * size / (glm::pi<double>() * d * d) / n, 1};
    }
    if (const auto* disk = std::get_if<DiskLight>(&source.light))
        return {dvec3(disk->radiance) * double{disk->radius} * double{disk->radius} / (d * d) / n, 1};
    return {sample.incoming, 0};
}

/// A sphere light's sample lies at (centre's distance along the ray) - root: the root loses digits near the limb.
double distance_error(const SceneLight& source, const reference::Surface& surface, const reference::LightSample& s) {
    const double direct = (32 + 64 + 8 * 12) * ROUNDING;  // position, sample, roundings of the distance
    const auto* sphere = std::get_if<SphereLight>(&source.light);
    if (!sphere || s.distance == INFINITY) return direct;
    const dvec3 to_center = dvec3(sphere->center) - surface.position;
    const double root = glm::dot(to_center, s.direction) - s.distance, d2 = glm::dot(to_center, to_center);
    const double radicand = 128 * ROUNDING * d2;  // its error: of d^2 sin^2, to which position and cap add
    return direct + radicand / std::max(root, std::sqrt(radicand));
}

bool near_checker_border(const SceneMaterial& material, const dvec3& p) {
    if (!material.diffuse_checker) return false;
    bool near = false;
    for (int k = 0; k < 3; ++k) {
        const double cell = p[k] / material.diffuse_checker->scale + 1.0 / 4096;
        near |=
            std::abs(cell - std::round(cell)) < 1e-5;  // POSITION_ERROR over the scale, 3 roundings of a cell below 8
    }
    return near;
}

class Shade : public testing::Test {
  protected:
    Expected expected(const Ray& ray, const Hit& hit, const Slot& slot) const {
        const reference::Ray r = exact(ray);
        const reference::Hit h = exact(hit);
        Expected e;
        e.surface = tracer_.surface(r, h);
        const SceneLight& source = scene_.lights[slot.light];
        const SceneMaterial& m = scene_.materials[e.surface.material];
        e.light = tracer_.sample_light(slot.light, slot.sample, e.surface.position, ray.sample, ray.path);
        const auto terms = tracer_.local_terms(r, h, e.surface, slot.light, slot.sample, ray.sample, ray.path);
        const dvec3 absorbed = e.surface.inside ? glm::exp(-h.t * dvec3(m.absorption)) : dvec3(1);
        const dvec3 weight = (1.0 - m.reflection - m.transmission) * absorbed * reference::to_dvec3(ray.throughput);
        e.diffuse = weight * terms.diffuse;
        e.specular = weight * terms.specular;
        e.distance_error = distance_error(source, e.surface, e.light);
        set_errors(e, source, m, weight, terms);
        const double side = e.surface.inside ? -1 : 1;
        const dvec3 to_sphere = e.light.direction;
        e.ambiguous =
            std::abs(glm::dot(e.light.direction, e.surface.geometric_normal)) < COSINE_ERROR ||
            std::abs(side * glm::dot(e.light.direction, e.surface.shading_normal)) < COSINE_ERROR ||
            std::abs(glm::dot(reference::to_dvec3(ray.direction), e.surface.geometric_normal)) < COSINE_ERROR ||
            near_checker_border(m, e.surface.position) ||
            (std::holds_alternative<SphereLight>(source.light) && std::abs(to_sphere.z) < 1e-5);
        return e;
    }

    static void set_errors(Expected& e, const SceneLight& source, const SceneMaterial& m, const dvec3& weight,
                           const reference::LocalTerms& terms) {
        const Unshaped full = unshaped(source, e.light);
        // I_in: its distance (96 over 2) enters squared, a cap's size twice that, with 16 roundings; its shape at the
        // direction's error. Texture: 8 texels a unit of uv (below 2, 8 roundings), each at most 1 from the next,
        // twice.
        const dvec3 incoming_error =
            220 * ROUNDING * e.light.incoming + 2 * DIRECTION_ERROR * full.steepness * full.incoming;
        const double texture_error = m.diffuse_map ? 2 * 8 * 18 * ROUNDING : 0;
        const dvec3 brightest = e.light.incoming + incoming_error;
        e.diffuse_error =
            weight * ((COSINE_ERROR + texture_error) * brightest + incoming_error) + 16 * ROUNDING * e.diffuse;
        // d(h^a) = a h^(a-1) dh, at most a dh; near h = 0 that is nothing unless a is small, where a dh bounds it too.
        // Half vectors are at least 0.05 long but for grazing pairs, whose highlights are faint: dh is taken 4 times.
        // power() adds (4 + 4 a |log2 h|), largest 4 + 6 of h^a, roundings.
        const double steep = std::max(1.0, double{m.shininess}) * 4 * HIGHLIGHT_ERROR + 16 * ROUNDING;
        e.specular_error = weight * dvec3(m.specular) * (m.shininess > 0 ? steep * brightest : 0.0 * brightest) +
                           weight * dvec3(m.specular) * incoming_error + 16 * ROUNDING * e.specular;
        (void)terms;
    }

    /// The rays of segment (chunk, k) by pixel, which is the ray's index.
    static std::vector<const ShadowRay*> by_item(const ShadeResult& result, uint slot_count, uint k,
                                                 std::size_t items) {
        std::vector<const ShadowRay*> found(items, nullptr);
        for (std::size_t chunk = 0; chunk * CHUNK < items; ++chunk) {
            const std::size_t segment = chunk * slot_count + k;
            uint previous = 0;
            for (uint i = 0; i < result.counts[segment]; ++i) {
                const ShadowRay& ray = result.rays[segment * CHUNK + i];
                EXPECT_EQ(ray.pixel / CHUNK, chunk);
                EXPECT_TRUE(i == 0 || ray.pixel > previous) << "segments keep the order of the hits";
                previous = ray.pixel;
                found.at(ray.pixel) = &ray;
            }
        }
        return found;
    }

    void expect_ray(const ShadowRay& ray, const Ray& from, const Hit& hit, const Slot& slot, const Expected& e) const {
        // On smooth triangles the ray starts above the hit; its distance is a multiple of the direction's length.
        const reference::Ray shadow = tracer_.shadow_ray(exact(from), exact(hit), e.surface, e.light);
        const double length = glm::length(shadow.direction);
        ASSERT_EQ(ray.light, slot.light);
        ASSERT_EQ(ray.route, from.route);
        const dvec3 origin = reference::to_dvec3(ray.origin);
        ASSERT_LE(glm::length(reference::to_dvec3(ray.direction) - shadow.direction / length), 2 * DIRECTION_ERROR);
        if (e.light.distance == INFINITY) {
            ASSERT_EQ(ray.t_max, INFINITY);
        } else {
            ASSERT_NEAR(ray.t_max, e.light.shadow_distance * length, 2 * e.distance_error);
        }
        // The largest offset is a plane's: 16 roundings of two coordinates of 4.
        // The lift over a smooth triangle errs as the position and the normals do, over edges of up to 3.
        ASSERT_LE(glm::length(origin - shadow.origin),
                  POSITION_ERROR + 128 * ROUNDING + (e.surface.smooth ? 3 * NORMAL_ERROR : 0));
        const double height = height_over(scene_, hit.primitive, origin);
        ASSERT_GT(e.surface.inside ? -height : height, 0);
    }

    static void expect_terms(const ShadowRay* ray, const Expected& e) {
        for (int k = 0; k < 3; ++k) {
            ASSERT_NEAR(ray ? ray->diffuse[k] : 0, e.diffuse[k], e.diffuse_error[k]) << "channel " << k;
            ASSERT_NEAR(ray ? ray->specular[k] : 0, e.specular[k], e.specular_error[k]) << "channel " << k;
        }
    }

    const Scene scene_ = shading_scene();
    const reference::Tracer tracer_{scene_};
    const KernelRig rig_{scene_};
};

TEST_F(Shade, every_shadow_ray_is_the_reference_s) {
    const HitQueue queue = random_hits(scene_, 4000, 3, 17);
    const std::vector<Slot> slots = slots_of(scene_);
    std::size_t ambiguous = 0, pushed = 0, compared = 0;
    for (uint first = 0; first < slots.size(); first += SHADOW_SAMPLES) {
        const uint count = std::min<uint>(SHADOW_SAMPLES, static_cast<uint>(slots.size()) - first);
        const ShadeResult result = rig_.shade(queue.rays, queue.hits, first, count);
        std::size_t in_this_range = 0;
        for (uint k = 0; k < count; ++k) {
            const auto found = by_item(result, count, k, queue.rays.size());
            for (std::size_t i = 0; i < queue.rays.size(); ++i) {
                in_this_range += found[i] != nullptr;
                if (queue.hits[i].primitive == NO_INDEX) {
                    ASSERT_EQ(found[i], nullptr);
                    continue;
                }
                const Expected e = expected(queue.rays[i], queue.hits[i], slots[first + k]);
                ++compared;
                if (e.ambiguous) {
                    ++ambiguous;
                    continue;
                }
                SCOPED_TRACE(testing::Message()
                             << "hit " << i << " on primitive " << queue.hits[i].primitive << " of material "
                             << e.surface.material << ", light " << slots[first + k].light);
                if (found[i]) expect_ray(*found[i], queue.rays[i], queue.hits[i], slots[first + k], e);
                expect_terms(found[i], e);
                if (HasFatalFailure()) return;
            }
        }
        EXPECT_EQ(result.film.counters.shadow_rays, in_this_range);
        pushed += in_this_range;
    }
    EXPECT_LT(ambiguous, compared / 1000);  // guards fall within 1e-5 of their border
    EXPECT_GT(pushed, compared / 5);
}

TEST_F(Shade, ambient_and_emission_are_added_with_the_first_light_sample_alone) {
    const HitQueue queue = random_hits(scene_, 2000, 4, 13);
    const ShadeResult first = rig_.shade(queue.rays, queue.hits, 0, 2),
                      later = rig_.shade(queue.rays, queue.hits, 2, 2);
    EXPECT_TRUE(std::ranges::all_of(later.film.sums, [](std::int64_t sum) { return sum == 0; }));
    for (std::size_t i = 0; i < queue.rays.size(); ++i) {
        dvec3 light(0);
        if (queue.hits[i].primitive != NO_INDEX) {
            const reference::Ray ray = exact(queue.rays[i]);
            const reference::Surface s = tracer_.surface(ray, exact(queue.hits[i]));
            const SceneMaterial& m = scene_.materials[s.material];
            const dvec3 absorbed = s.inside ? glm::exp(-double{queue.hits[i].t} * dvec3(m.absorption)) : dvec3(1);
            light = reference::to_dvec3(queue.rays[i].throughput) * absorbed *
                    ((1.0 - m.reflection - m.transmission) * tracer_.ambient_term(s) + tracer_.emission(s));
        }
        // exp_minus has 6 roundings and 2 of the exponent (below 2), the products 4; the film half a unit of 2^-32
        // twice.
        for (int k = 0; k < 3; ++k)
            ASSERT_NEAR(static_cast<double>(first.film.at(static_cast<uint>(i), k)) * 0x1p-32, light[k],
                        16 * ROUNDING * light[k] + 0x1p-32)
                << i;
        const bool covers = queue.hits[i].primitive != NO_INDEX && queue.rays[i].route == ROUTE_CAMERA;
        ASSERT_EQ(first.film.at(static_cast<uint>(i), 3), covers ? FILM_ONE : 0) << i;
    }
}

TEST_F(Shade, queues_of_any_size_give_the_same_rays_and_touch_nothing_else) {
    const HitQueue queue = random_hits(scene_, 200, 5);
    const ShadeResult whole = rig_.shade(queue.rays, queue.hits, 1, 3);
    for (const uint size : {0u, 1u, 63u, 64u, 65u, 200u}) {
        const std::span<const Ray> rays(queue.rays.data(), size);
        const std::span<const Hit> hits(queue.hits.data(), size);
        const ShadeResult part = rig_.shade(rays, hits, 1, 3);
        const std::size_t chunks = (size + CHUNK - 1) / CHUNK;
        for (std::size_t segment = 0; segment < chunks * 3; ++segment) {
            const std::size_t first = segment * CHUNK;
            if ((segment / 3 + 1) * CHUNK <= size || size == 200) {
                ASSERT_EQ(part.counts[segment], whole.counts[segment]);
            }
            for (std::size_t i = 0; i < CHUNK; ++i) {
                if (i < part.counts[segment]) {
                    ASSERT_TRUE(same_bits(part.rays[first + i], whole.rays[first + i]));
                } else {
                    ASSERT_TRUE(is_untouched(part.rays[first + i])) << size;
                }
            }
        }
        EXPECT_EQ(touched_from(part.rays, chunks * 3 * CHUNK), 0u);
        EXPECT_EQ(touched_from(part.counts, chunks * 3), 0u);
    }
}

TEST_F(Shade, a_batch_in_the_middle_of_a_queue_is_shaded_like_one_at_its_start) {
    const HitQueue queue = random_hits(scene_, 200, 6);
    const std::span<const Hit> hits(queue.hits.data() + 70, 130);
    const ShadeResult middle = rig_.shade(queue.rays, hits, 0, 4, 70);
    const ShadeResult start = rig_.shade(std::span(queue.rays).subspan(70), hits, 0, 4);
    ASSERT_EQ(middle.counts, start.counts);
    for (std::size_t i = 0; i < middle.rays.size(); ++i) ASSERT_TRUE(same_bits(middle.rays[i], start.rays[i])) << i;
}

TEST(ShadeWithoutOffset, shadow_rays_start_at_the_hit_itself) {
    Scene scene = shading_scene();
    scene.settings.shadow_offset = ShadowOffset::none;
    const HitQueue queue = random_hits(scene, 1000, 7);
    const ShadeResult result = KernelRig(scene).shade(queue.rays, queue.hits, 0, 1);
    const reference::Tracer tracer(scene);
    for (std::size_t segment = 0; segment < 1000 / CHUNK; ++segment)
        for (uint i = 0; i < result.counts[segment]; ++i) {
            const ShadowRay& ray = result.rays[segment * CHUNK + i];
            const auto surface = tracer.surface(exact(queue.rays[ray.pixel]), exact(queue.hits[ray.pixel]));
            ASSERT_LE(glm::length(reference::to_dvec3(ray.origin) - surface.position), POSITION_ERROR);
        }
}

TEST(ShadeGouraud, a_lamp_on_a_vertex_lights_it_with_nothing) {
    Scene scene;
    scene.materials.push_back(material_of(Shading::gouraud, Highlight::phong, 4));
    scene.lights.push_back(light_of(PointLight{{0, 0, 0}, {1, 1, 1}, {0, 0, 1}, 0}));
    scene.lights.push_back(light_of(SpotLight{{0, 0, 0}, {0, 0, -1}, {1, 1, 1}, {1, 0, 0}, 10, 40}));
    for (const glm::vec3& p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}) {
        Vertex vertex{};
        store(vertex.position, p);
        store(vertex.normal, glm::normalize(glm::vec3(0.1f, 0.1f, 1)));
        scene.vertices.push_back(vertex);
    }
    scene.triangles.push_back({{0, 1, 2}, 0, 0});
    // The lamps must shine on the hit: it is a little below their plane, through a second triangle of other vertices.
    scene.vertices.push_back(scene.vertices[1]);
    scene.vertices.push_back(scene.vertices[2]);
    scene.vertices[3].position[2] = scene.vertices[4].position[2] = -0.5f;
    scene.triangles.push_back({{0, 3, 4}, 0, 0});
    const std::vector<Ray> rays = {make_ray({0.3f, 0.3f, 3}, {0, 0, -1}, 0), make_ray({0.3f, 0.3f, 3}, {0, 0, -1}, 1)};
    const std::vector<Hit> hits = {{3, 0.3f, 0.3f, 0}, {3.3f, 0.3f, 0.3f, 1}};
    const ShadeResult result = KernelRig(scene).shade(rays, hits, 0, 2);
    for (std::size_t segment = 0; segment < 2; ++segment)
        for (uint i = 0; i < result.counts[segment]; ++i)
            for (int k = 0; k < 3; ++k) {
                EXPECT_TRUE(std::isfinite(result.rays[segment * CHUNK + i].diffuse[k]));
                EXPECT_TRUE(std::isfinite(result.rays[segment * CHUNK + i].specular[k]));
            }
}

}  // namespace
}  // namespace raymill::test
