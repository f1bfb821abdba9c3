#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene_builder.hpp"

namespace raymill::reference {
namespace {

/// A floor y = 0, outward up, with a point light at `light` of intensity 1.
SceneBuilder lit_floor(const SceneMaterial& material, const glm::vec3& light) {
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    PointLight point;
    point.position = light;
    b.add_light(point);
    return b;
}

/// A ray that hits the origin from `from`.
Ray to_origin(const dvec3& from) {
    return {from, glm::normalize(-from)};
}

TEST(Lambert, is_kd_times_the_cosine_from_any_eye) {
    SceneMaterial material;
    material.diffuse = {0.5f, 0.25f, 1};
    const SceneBuilder b = lit_floor(material, {3, 4, 0});
    for (const dvec3 eye : {dvec3(0, 5, 0), dvec3(-2, 1, 3)}) {
        const LocalTerms terms = first_terms(b.scene, to_origin(eye));
        expect_near(terms.diffuse, dvec3(0.5, 0.25, 1) * 0.8, rounding);  // cosine 4 / 5
        EXPECT_EQ(terms.specular, dvec3(0));
    }
}

TEST(Specular, phong_and_blinn_raise_their_cosines_to_the_shininess) {
    SceneMaterial material = black();
    material.specular = {1, 0.5f, 0};
    material.shininess = 10;
    const dvec3 eye(-1, 2, 0);
    const dvec3 v = glm::normalize(eye);
    const LocalTerms phong = first_terms(lit_floor(material, {3, 4, 0}).scene, to_origin(eye));
    // The mirror of (3, 4) / 5 about y is (-3, 4) / 5.
    expect_near(phong.specular, std::pow(glm::dot(v, dvec3(-0.6, 0.8, 0)), 10) * dvec3(1, 0.5, 0), rounding);
    material.highlight = Highlight::blinn;
    const LocalTerms blinn = first_terms(lit_floor(material, {3, 4, 0}).scene, to_origin(eye));
    const dvec3 h = glm::normalize(dvec3(0.6, 0.8, 0) + v);
    expect_near(blinn.specular, std::pow(h.y, 10) * dvec3(1, 0.5, 0), rounding);
    EXPECT_EQ(phong.diffuse, dvec3(0));
}

TEST(Facing, a_surface_is_lit_on_the_side_it_is_seen_from) {
    const SceneBuilder above = lit_floor({}, {0, 2, 0});
    EXPECT_GT(first_terms(above.scene, to_origin({0, 1, 1})).diffuse.x, 0);
    EXPECT_EQ(first_terms(above.scene, to_origin({0, -1, 1})).diffuse, dvec3(0));
    const SceneBuilder below = lit_floor({}, {0, -2, 0});
    EXPECT_EQ(first_terms(below.scene, to_origin({0, 1, 1})).diffuse, dvec3(0));
    EXPECT_EQ(first_terms(below.scene, to_origin({0, -1, 1})).diffuse, dvec3(0.8f));  // perpendicular: k_d
}

/// A triangle in y = 0 around the origin (weights 1/3 each), facing up, with these vertex normals.
SceneBuilder smooth_triangle(const SceneMaterial& material, const std::array<glm::vec3, 3>& normals) {
    SceneBuilder b;
    b.add_triangle({glm::vec3(-1, 0, 1), glm::vec3(1, 0, 1), glm::vec3(0, 0, -2)}, b.add_material(material), normals);
    return b;
}

const std::array<glm::vec3, 3> leaning{glm::vec3(0.6f, 0.8f, 0), glm::vec3(0.6f, 0.8f, 0), glm::vec3(0.6f, 0.8f, 0)};

TEST(Guard, neither_below_the_shading_nor_below_the_geometric_surface) {
    SceneMaterial material;
    material.specular = glm::vec3(1);
    material.shininess = 0;  // the highlight is 1 wherever it is let through
    DirectionalLight light;
    const auto terms = [&](const glm::vec3& to_light, ShadowMode shadows) {
        SceneBuilder b = smooth_triangle(material, leaning);
        b.scene.settings.shadows = shadows;
        light.direction = -to_light;
        b.add_light(light);
        return first_terms(b.scene, to_origin({0, 3, 0}));
    };
    const glm::vec3 above(0, 1, 0), below_shading(-0.9f, 0.1f, 0), below_geometric(0.9f, -0.1f, 0);
    EXPECT_GT(terms(above, ShadowMode::none).diffuse.x, 0);
    EXPECT_EQ(terms(above, ShadowMode::none).specular, dvec3(1));
    for (const glm::vec3 dark : {below_shading, below_geometric}) {
        EXPECT_EQ(terms(dark, ShadowMode::none).diffuse, dvec3(0));
        EXPECT_EQ(terms(dark, ShadowMode::none).specular, dvec3(0));
    }
    // With shadows it is the shadow ray, which starts on the curved surface, that tells what is below that.
    EXPECT_EQ(terms(below_shading, ShadowMode::opaque).diffuse, dvec3(0));
    EXPECT_GT(terms(below_geometric, ShadowMode::opaque).diffuse.x, 0);
    material.shading = Shading::flat;
    EXPECT_EQ(terms(below_geometric, ShadowMode::opaque).diffuse, dvec3(0));
}

TEST(Shading, flat_uses_the_face_and_phong_the_renormalised_interpolation) {
    const std::array<glm::vec3, 3> normals{glm::vec3(1, 1, 0), glm::vec3(0, 1, 1), glm::vec3(0, 1, 0)};
    DirectionalLight light;
    const auto cosine = [&](Shading shading) {
        SceneMaterial material;
        material.diffuse = glm::vec3(1);
        material.shading = shading;
        SceneBuilder b = smooth_triangle(material, normals);
        b.add_light(light);
        return first_terms(b.scene, to_origin({0.1, 3, 0})).diffuse.x;
    };
    EXPECT_NEAR(cosine(Shading::flat), 1, rounding);
    EXPECT_NEAR(cosine(Shading::phong), 3 / std::sqrt(11.0), rounding);  // (1, 3, 1) / sqrt 11
}

TEST(Gouraud, interpolates_what_the_vertices_see) {
    SceneMaterial material;
    material.diffuse = glm::vec3(1);
    material.specular = glm::vec3(1);
    material.shininess = 3;
    material.shading = Shading::gouraud;
    const dvec3 normals[3] = {{0, 1, 0}, glm::normalize(dvec3(1, 2, 0)), {0, 0, -1}};
    const dvec3 points[3] = {{-1, 0, 1}, {1, 0, 1}, {0, 0, -2}};
    SceneBuilder b = smooth_triangle(material, {glm::vec3(0, 1, 0), glm::vec3(1, 2, 0), glm::vec3(0, 0, -1)});
    PointLight light;
    light.position = {0, 1, 0.5f};
    light.attenuation = {0, 1, 1};
    b.add_light(light);
    const dvec3 eye(0.5, 2, 0);
    dvec3 diffuse(0), specular(0);
    for (int k = 0; k < 3; ++k) {
        const dvec3 to_light = dvec3(0, 1, 0.5) - points[k];
        const double d = glm::length(to_light);
        const dvec3 l = to_light / d, v = glm::normalize(eye - points[k]);
        const double cosine = glm::dot(l, normals[k]);
        EXPECT_EQ(cosine <= 0, k == 2);  // the guard holds vertex by vertex
        if (cosine <= 0) continue;
        const double incoming = 1 / (d + d * d) / 3;  // attenuated from the vertex; each weighs a third
        const dvec3 r = 2 * cosine * normals[k] - l;
        diffuse += cosine * incoming;
        specular += std::pow(std::max(0.0, glm::dot(r, v)), 3) * incoming;
    }
    const LocalTerms terms = first_terms(b.scene, to_origin(eye));
    expect_near(terms.diffuse, diffuse, 1e-7);  // the middle vertex normal was rounded to single precision
    expect_near(terms.specular, specular, 1e-7);
}

TEST(Gouraud, an_area_light_keeps_what_it_gives_to_the_pixel) {
    SceneMaterial material;
    material.diffuse = glm::vec3(1);
    material.shading = Shading::gouraud;
    const glm::vec3 y(0, 1, 0);
    SceneBuilder b = smooth_triangle(material, {y, y, y});
    DiskLight light;
    light.center = {0, 2, 0};
    b.add_light(light);
    const Ray ray = to_origin({0.5, 2, 0});
    const LightSample s = Tracer(b.scene).sample_light(0, 0, dvec3(0), 0, 0);
    const dvec3 q = s.distance * s.direction;
    double cosines = 0;
    for (const dvec3 p : {dvec3(-1, 0, 1), dvec3(1, 0, 1), dvec3(0, 0, -2)}) cosines += glm::normalize(q - p).y;
    EXPECT_NEAR(first_terms(b.scene, ray).diffuse.x, cosines / 3 * s.incoming.x, rounding);
}

TEST(Gouraud, spheres_are_shaded_at_the_pixel) {
    SceneMaterial smooth, gouraud;
    gouraud.shading = Shading::gouraud;
    const auto terms = [](const SceneMaterial& material) {
        SceneBuilder b = lit_floor({}, {1, 3, 2});
        b.add_sphere({0, 2, 0}, 0.5f, b.add_material(material));
        return first_terms(b.scene, {{0.1, 5, 0.2}, {0, -1, 0}}).diffuse;
    };
    EXPECT_GT(terms(smooth).x, 0);
    EXPECT_EQ(terms(gouraud), terms(smooth));
}

TEST(Gouraud, a_face_without_normals_has_its_own_at_each_vertex) {
    SceneMaterial gouraud;
    gouraud.diffuse = glm::vec3(1);
    gouraud.shading = Shading::gouraud;
    SceneBuilder b = lit_floor({}, {1, 3, 2});
    b.add_triangle({glm::vec3(2, 1, 1), glm::vec3(4, 1, 1), glm::vec3(3, 1, -2)}, b.add_material(gouraud));
    const dvec3 diffuse = first_terms(b.scene, {{3.1, 5, 0.2}, {0, -1, 0}}).diffuse;
    // n.l at the vertices: the light is 2 above the face, and sqrt(6), sqrt(14), sqrt(24) away from them.
    const double v = 0.8 / 3, u = (1.1 - v) / 2;
    const double expected = 2 * ((1 - u - v) / std::sqrt(6) + u / std::sqrt(14) + v / std::sqrt(24));
    expect_near(diffuse, dvec3(expected), rounding);
}

TEST(DiffuseColor, a_checker_alternates_in_all_three_directions) {
    SceneMaterial material;
    material.diffuse_checker = Checker{glm::vec3(1), glm::vec3(0.25f), 0.5f};
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    const Tracer tracer(b.scene);
    const auto at = [&](const dvec3& p) {
        Surface s{};
        s.position = p;
        s.material = 1;
        return tracer.diffuse_color(s).x;
    };
    EXPECT_EQ(at({0.1, 0.1, 0.1}), 1);
    EXPECT_EQ(at({0.6, 0.1, 0.1}), 0.25);
    EXPECT_EQ(at({0.1, -0.1, 0.1}), 0.25);
    EXPECT_EQ(at({0.6, 0.1, -0.1}), 1);
    EXPECT_EQ(at({-0.1, -0.6, 1.4}), 0.25);  // cells -1, -2, 2
}

TEST(DiffuseColor, a_checkered_floor_on_a_cell_border_has_no_noise) {
    SceneMaterial material;
    material.diffuse_checker = Checker{};
    SceneBuilder b;
    b.add_plane({0, 0, 0}, {0, 1, 0}, b.add_material(material));
    b.add_quad({-9, 2, 9}, {9, 2, 9}, {9, 2, -9}, {-9, 2, -9}, 1);
    const Tracer tracer(b.scene);
    for (int i = 0; i < 100; ++i) {
        const dvec3 target(0.01 * i + 0.003, 0, 0.5);
        for (const double height : {0.0, 2.0}) {
            const Ray ray = {{0.3, 5.1, 3.7}, target + dvec3(0, height, 0) - dvec3(0.3, 5.1, 3.7)};
            const Hit hit = tracer.intersect_primitive(ray, height == 0 ? 2 : tracer.intersect(ray).primitive);
            EXPECT_EQ(tracer.surface(ray, hit).position.y, height);
        }
    }
}

TEST(DiffuseColor, a_texture_is_bilinear_repeats_and_starts_at_its_bottom_row) {
    SceneMaterial material;
    material.diffuse = glm::vec3(0.5f);
    material.diffuse_map = 0;
    SceneBuilder b;
    b.add_material(material);
    b.scene.images.push_back({"", 2, 2, {glm::vec3(1), glm::vec3(2), glm::vec3(3), glm::vec3(4)}});  // 1 2 above 3 4
    const Tracer tracer(b.scene);
    const auto at = [&](double u, double v) {
        Surface s{};
        s.uv = {u, v};
        s.material = 1;
        return tracer.diffuse_color(s).x / 0.5;
    };
    EXPECT_NEAR(at(0.25, 0.25), 3, rounding);  // texel centres
    EXPECT_NEAR(at(0.75, 0.25), 4, rounding);
    EXPECT_NEAR(at(0.25, 0.75), 1, rounding);
    EXPECT_NEAR(at(0.75, 0.75), 2, rounding);
    EXPECT_NEAR(at(0.375, 0.25), 3.25, rounding);    // a quarter of the way
    EXPECT_NEAR(at(0.25, 0.5), 2, rounding);         // between the rows
    EXPECT_NEAR(at(0, 0.25), 3.5, rounding);         // across the seam
    EXPECT_NEAR(at(-0.75, 3.25), 3, 10 * rounding);  // repeats both ways
    EXPECT_NEAR(at(17.75, -4.25), 2, 100 * rounding);
}

TEST(Ambient, is_ka_times_the_sum_of_the_ambient_lights) {
    SceneMaterial material = black();
    material.ambient = {0.5f, 1, 0};
    SceneBuilder b = lit_floor(material, {0, -1, 0});
    b.add_light(AmbientLight{glm::vec3(1, 2, 3)});
    b.add_light(AmbientLight{glm::vec3(0.5f)});
    EXPECT_EQ(radiance(b.scene, to_origin({0, 1, 0})), dvec3(0.75, 2.5, 0));
}

TEST(Split, takes_the_weights_as_they_are_without_fresnel) {
    SceneMaterial glass;
    glass.reflection = 0.25f;
    glass.transmission = 0.5f;
    const SceneBuilder b = lit_floor(glass, {0, 1, 0});
    const Tracer tracer(b.scene);
    const Ray ray = to_origin({-3, 4, 0});
    const Split s = tracer.split(ray, tracer.surface(ray, tracer.intersect(ray)));
    EXPECT_EQ(s.local, 0.25);
    EXPECT_EQ(s.reflection, 0.25);
    EXPECT_EQ(s.transmission, 0.5);
    expect_near(s.reflected, {0.6, 0.8, 0}, rounding);
    expect_near(s.refracted, {0.4, -std::sqrt(1 - 0.16), 0}, rounding);  // sine 0.6 / 1.5
}

TEST(Split, between_two_media_uses_the_ratio_of_both_indices) {
    SceneMaterial glass = black();
    glass.transmission = 1;
    glass.ior = 1.5f;
    glass.exterior_ior = 1.25f;
    const SceneBuilder b = lit_floor(glass, {0, 1, 0});
    const Tracer tracer(b.scene);
    for (const double side : {1.0, -1.0}) {
        const Ray ray = to_origin({-3, 4 * side, 0});
        const Split s = tracer.split(ray, tracer.surface(ray, tracer.intersect(ray)));
        EXPECT_NEAR(s.refracted.x, side > 0 ? 0.6 / 1.2 : 0.6 * 1.2, rounding);
    }
}

TEST(Split, past_the_critical_angle_reflection_carries_the_weight_of_both) {
    SceneMaterial glass;
    glass.reflection = 0.25f;
    glass.transmission = 0.5f;
    const SceneBuilder b = lit_floor(glass, {0, 1, 0});
    const Tracer tracer(b.scene);
    const Ray ray = to_origin({-4, -3, 0});  // from inside; sine 0.8 > 1 / 1.5
    const Split s = tracer.split(ray, tracer.surface(ray, tracer.intersect(ray)));
    EXPECT_EQ(s.local, 0.25);
    EXPECT_EQ(s.reflection, 0.75);
    EXPECT_EQ(s.transmission, 0);
    expect_near(s.reflected, {0.8, -0.6, 0}, rounding);
}

TEST(Split, fresnel_divides_the_sum_of_both_weights) {
    SceneMaterial glass;
    glass.reflection = 0.25f;
    glass.transmission = 0.5f;
    glass.fresnel = true;
    const SceneBuilder b = lit_floor(glass, {0, 1, 0});
    const Tracer tracer(b.scene);
    const Ray ray = to_origin({0, 1, 0});
    const Split s = tracer.split(ray, tracer.surface(ray, tracer.intersect(ray)));
    EXPECT_NEAR(s.reflection, 0.75 * 0.04, rounding);  // ((1.5 - 1) / (1.5 + 1))^2
    EXPECT_NEAR(s.transmission, 0.75 * 0.96, rounding);
    EXPECT_EQ(s.local, 0.25);
}

TEST(Split, directions_stay_on_their_side_of_the_geometric_surface) {
    SceneMaterial glass = black();
    glass.reflection = 0.5f;
    glass.transmission = 0.5f;
    for (const float lean : {0.2f, 0.6f, 0.95f}) {
        const glm::vec3 normal(lean, std::sqrt(1 - lean * lean), 0);
        const SceneBuilder b = smooth_triangle(glass, {normal, normal, normal});
        const Tracer tracer(b.scene);
        for (int i = 1; i < 180; ++i) {
            const double angle = glm::radians(static_cast<double>(i));
            for (const double side : {1.0, -1.0}) {
                const Ray ray = to_origin({std::cos(angle), side * std::sin(angle), 0});
                const Split s = tracer.split(ray, tracer.surface(ray, tracer.intersect(ray)));
                EXPECT_GT(side * s.reflected.y, 0);
                if (s.transmission > 0) {
                    EXPECT_LT(side * s.refracted.y, 0);
                }
            }
        }
    }
}

TEST(Split, equal_indices_do_not_bend_even_where_the_shading_normal_faces_away) {
    SceneMaterial air = black();
    air.transmission = 1;
    air.ior = 1;
    const SceneBuilder b = smooth_triangle(air, leaning);
    const Tracer tracer(b.scene);
    const Ray ray = to_origin({-1, 0.1, 0});  // behind the leaning normal, before the face
    const Split s = tracer.split(ray, tracer.surface(ray, tracer.intersect(ray)));
    EXPECT_EQ(s.refracted, ray.direction);
    EXPECT_EQ(s.transmission, 1);
}

}  // namespace
}  // namespace raymill::reference
