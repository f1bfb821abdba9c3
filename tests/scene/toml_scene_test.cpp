// What a sound scene file becomes.
#include <gtest/gtest.h>

#include "scene_files.hpp"

namespace raymill {
namespace {

TEST(SceneFile, that_is_empty_has_the_defaults_and_a_warning) {
    const Scene scene = SceneFiles().toml("");
    EXPECT_EQ(scene.settings.width, 640);
    EXPECT_EQ(scene.settings.height, 480);
    EXPECT_EQ(scene.settings.spp, 1);
    EXPECT_EQ(scene.settings.depth, 5);
    EXPECT_EQ(scene.camera.fov, 40);
    EXPECT_EQ(scene.primitive_count(), 0u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].message.find("there are no objects"), std::string::npos);
}

TEST(SceneFile, sets_every_key_of_render) {
    const Scene scene = SceneFiles().toml(
        "[render]\nsize = [32, 16]\nspp = 7\ndepth = 0\nintegrator = 'whitted'\nbackground = [0.1, 0.2, 3]\n"
        "shadows = 'opaque'\nshadow_offset = 'none'\nseed = 4294967295\nexposure = -1.5\nmin_weight = 0.25\n"
        "crop = [0.25, 0.75, 0, 0.5]\n");
    const RenderSettings& s = scene.settings;
    EXPECT_EQ(s.width, 32);
    EXPECT_EQ(s.height, 16);
    EXPECT_EQ(s.spp, 7);
    EXPECT_EQ(s.depth, 0);
    EXPECT_EQ(s.background, glm::dvec3(glm::vec3(0.1f, 0.2f, 3)));
    EXPECT_EQ(s.shadows, ShadowMode::opaque);
    EXPECT_EQ(s.shadow_offset, ShadowOffset::none);
    EXPECT_EQ(s.seed, 4294967295u);
    EXPECT_EQ(s.exposure, -1.5);
    EXPECT_EQ(s.min_weight, 0.25);
    const PixelWindow window = crop_window(s);
    EXPECT_EQ(window.x0, 8);
    EXPECT_EQ(window.y0, 0);
    EXPECT_EQ(window.width, 16);
    EXPECT_EQ(window.height, 8);
}

TEST(CropWindow, of_neighbouring_crops_shares_no_pixel_and_leaves_none_out) {
    RenderSettings settings;
    settings.width = 10;
    int next = 0;
    for (const auto& [x0, x1] : {std::pair(0.0, 0.33), std::pair(0.33, 0.5), std::pair(0.5, 1.0)}) {
        settings.crop = {x0, x1, 0, 1};
        EXPECT_EQ(crop_window(settings).x0, next);
        next += crop_window(settings).width;
    }
    EXPECT_EQ(next, 10);
}

TEST(SceneFile, sets_every_key_of_the_camera) {
    const Camera camera = SceneFiles()
                              .toml(
                                  "[camera]\nprojection = 'orthographic'\neye = [1, 2, 3]\nlook_at = [4, 5, 6]\n"
                                  "up = [0, 0, 1]\nheight = 8\naperture = 0.5\nfocus = 2.5\n")
                              .camera;
    EXPECT_EQ(camera.projection, Projection::orthographic);
    EXPECT_EQ(camera.eye, glm::dvec3(1, 2, 3));
    EXPECT_EQ(camera.look_at, glm::dvec3(4, 5, 6));
    EXPECT_EQ(camera.up, glm::dvec3(0, 0, 1));
    EXPECT_EQ(camera.height, 8);
    EXPECT_EQ(camera.aperture, 0.5);
    EXPECT_EQ(camera.focus, 2.5);
    EXPECT_EQ(SceneFiles().toml("[camera]\nfov = 55\n").camera.fov, 55);
}

TEST(SceneFile, sets_every_key_of_a_material) {
    const Scene scene = SceneFiles().toml(
        "[[material]]\nname = 'm'\nambient = 0.1\ndiffuse = [0.2, 0.3, 0.4]\nspecular = 0.5\nshininess = 100\n"
        "highlight = 'blinn'\nshading = 'gouraud'\nemission = [1, 2, 3]\nreflection = 0.25\ntransmission = 0.75\n"
        "base_color = [0.5, 0.6, 0.7]\nior = 1.33\nexterior_ior = 1.1\nfresnel = true\nabsorption = [1, 0, 2]\n"
        "[[material]]\nname = 'checker'\ndiffuse_checker = { a = 0.25, b = [1, 0, 0], scale = 2 }\n");
    ASSERT_EQ(scene.materials.size(), 3u);
    const SceneMaterial& m = scene.materials[1];
    EXPECT_EQ(m.name, "m");
    EXPECT_EQ(m.ambient, glm::vec3(0.1f));
    EXPECT_EQ(m.diffuse, glm::vec3(0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.specular, glm::vec3(0.5f));
    EXPECT_EQ(m.shininess, 100);
    EXPECT_EQ(m.highlight, Highlight::blinn);
    EXPECT_EQ(m.shading, Shading::gouraud);
    EXPECT_EQ(m.emission, glm::vec3(1, 2, 3));
    EXPECT_FALSE(m.one_sided_emission);
    EXPECT_EQ(m.reflection, 0.25f);
    EXPECT_EQ(m.transmission, 0.75f);
    EXPECT_EQ(m.base_color, glm::vec3(0.5f, 0.6f, 0.7f));
    EXPECT_EQ(m.ior, 1.33f);
    EXPECT_EQ(m.exterior_ior, 1.1f);
    EXPECT_TRUE(m.fresnel);
    EXPECT_EQ(m.absorption, glm::vec3(1, 0, 2));
    ASSERT_TRUE(scene.materials[2].diffuse_checker);
    EXPECT_EQ(scene.materials[2].diffuse_checker->a, glm::vec3(0.25f));
    EXPECT_EQ(scene.materials[2].diffuse_checker->b, glm::vec3(1, 0, 0));
    EXPECT_EQ(scene.materials[2].diffuse_checker->scale, 2);
}

TEST(SceneFile, gives_objects_without_material_the_default_one) {
    const Scene scene = SceneFiles().toml(
        "[[object]]\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n"
        "[[object]]\nname = 'ball'\nmaterial = 'm'\nshape = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n"
        "[[material]]\nname = 'm'\n");
    EXPECT_EQ(scene.spheres[0].material, 0u);
    EXPECT_EQ(scene.materials[0].diffuse, glm::vec3(0.8f));
    EXPECT_EQ(scene.materials[0].shininess, 32);
    EXPECT_EQ(scene.spheres[1].material, 1u);
    EXPECT_EQ(scene.objects[0].name, "sphere");
    EXPECT_EQ(scene.objects[1].name, "ball");
    EXPECT_EQ(scene.spheres[1].object, 1u);
}

TEST(SceneFile, reads_lights_of_each_type) {
    const Scene scene = SceneFiles().toml(
        "[[light]]\ntype = 'ambient'\ncolor = [0.1, 0.2, 0.3]\n"
        "[[light]]\ntype = 'point'\nposition = [1, 2, 3]\nintensity = 4\nattenuation = [0, 1, 2]\nradius = "
        "0.5\nsamples = 9\n"
        "[[light]]\ntype = 'directional'\ndirection = [0, -2, 0]\nintensity = [1, 2, 3]\n"
        "[[light]]\ntype = 'spot'\nposition = [1, 1, 1]\ndirection = [3, 0, 4]\ninner_angle = 10\nouter_angle = 20\n"
        "[[light]]\ntype = 'environment'\nradiance = 0.5\n");
    ASSERT_EQ(scene.lights.size(), 5u);
    EXPECT_EQ(std::get<AmbientLight>(scene.lights[0].light).color, glm::vec3(0.1f, 0.2f, 0.3f));
    const auto& point = std::get<PointLight>(scene.lights[1].light);
    EXPECT_EQ(point.position, glm::vec3(1, 2, 3));
    EXPECT_EQ(point.intensity, glm::vec3(4));
    EXPECT_EQ(point.attenuation, glm::vec3(0, 1, 2));
    EXPECT_EQ(point.radius, 0.5f);
    EXPECT_EQ(scene.lights[1].samples, 9u);
    EXPECT_EQ(std::get<DirectionalLight>(scene.lights[2].light).direction, glm::vec3(0, -1, 0));
    const auto& spot = std::get<SpotLight>(scene.lights[3].light);
    EXPECT_NEAR(glm::distance(spot.direction, glm::vec3(0.6f, 0, 0.8f)), 0, 1e-7);  // one float rounding
    EXPECT_EQ(spot.inner_angle, 10);
    EXPECT_EQ(spot.outer_angle, 20);
    EXPECT_EQ(std::get<EnvironmentLight>(scene.lights[4].light).radiance, glm::vec3(0.5f));
    for (const SceneLight& light : scene.lights) EXPECT_EQ(light.object, NO_INDEX);
    EXPECT_TRUE(scene.objects.empty());
}

constexpr const char* area_lights =
    "[[light]]\ntype = 'rectangle'\ncenter = [0, 2, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 0, 1]\nradiance = 5\n"
    "[[light]]\ntype = 'disk'\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 2\nradiance = [1, 2, 3]\n"
    "[[light]]\ntype = 'sphere'\ncenter = [1, 2, 3]\nradius = 0.5\nradiance = 7\n";

TEST(AreaLights, are_seen_as_geometry_that_shines_on_their_side) {
    const Scene scene = SceneFiles().toml(area_lights);
    ASSERT_EQ(scene.objects.size(), 3u);
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(scene.lights[i].object, i);
    for (const Triangle& t : scene.triangles) {
        const SceneMaterial& m = scene.materials[t.material];
        EXPECT_TRUE(m.one_sided_emission);
        EXPECT_EQ(m.diffuse, glm::vec3(0));
        EXPECT_EQ(m.emission, t.object == 0 ? glm::vec3(5) : glm::vec3(1, 2, 3));
        const glm::vec3 shining = t.object == 0 ? glm::vec3(0, -1, 0) : glm::vec3(0, 1, 0);
        EXPECT_NEAR(glm::distance(face_normal(scene, t), shining), 0, 1e-6);  // float rounding
    }
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_EQ(vec(scene.spheres[0].center), glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.spheres[0].radius, 0.5f);
    EXPECT_EQ(scene.spheres[0].object, 2u);
    EXPECT_FALSE(scene.materials[scene.spheres[0].material].one_sided_emission);
    EXPECT_EQ(scene.materials[scene.spheres[0].material].emission, glm::vec3(7));
}

TEST(AreaLights, that_are_not_visible_have_no_geometry) {
    std::string text = area_lights;
    for (std::size_t at = 0; (at = text.find("radiance", at)) != std::string::npos; at += 30)
        text.insert(at, "visible = false\n");
    const Scene scene = SceneFiles().toml(text);
    EXPECT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.primitive_count(), 0u);
    for (const SceneLight& light : scene.lights) EXPECT_EQ(light.object, NO_INDEX);
}

TEST(Mesh, with_a_material_uses_it_throughout_and_without_keeps_its_own) {
    const SceneFiles files;
    files.write("a.mtl", "newmtl own\nKd 1 0 0\n");
    files.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl own\nf 1 2 3\n");
    const std::string mesh = "[[material]]\nname = 'm'\n[[object]]\nshape = 'mesh'\nfile = 'a.obj'\n";
    const Scene with = files.toml(mesh + "material = 'm'\n"), without = files.toml(mesh);
    EXPECT_EQ(with.materials[with.triangles[0].material].name, "m");
    EXPECT_EQ(with.materials.size(), 2u);
    EXPECT_EQ(without.materials[without.triangles[0].material].name, "own");
}

TEST(Mesh, file_is_found_beside_the_scene_and_transformed) {
    const SceneFiles files;
    std::filesystem::create_directory(files.path("meshes"));
    files.write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Scene scene = files.toml("[[object]]\nshape = 'mesh'\nfile = 'meshes/a.obj'\ntranslate = [0, 0, 5]\n");
    EXPECT_EQ(position(scene, scene.triangles[0], 1), glm::vec3(1, 0, 5));
}

TEST(SceneHash, changes_with_any_byte_of_any_file) {
    const SceneFiles files;
    const std::string scene = "[[object]]\nshape = 'mesh'\nfile = 'a.obj'\n";
    const std::string mesh = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl own\nf 1 2 3\n";
    const auto hash = [&](const std::string& toml, const std::string& obj, const std::string& mtl) {
        files.write("a.obj", obj);
        files.write("a.mtl", mtl);
        return files.toml(toml).hash;
    };
    const std::uint64_t first = hash(scene, mesh, "newmtl own\n");
    EXPECT_EQ(hash(scene, mesh, "newmtl own\n"), first);
    EXPECT_NE(hash(scene + "\n", mesh, "newmtl own\n"), first);
    EXPECT_NE(hash(scene, mesh + "\n", "newmtl own\n"), first);
    EXPECT_NE(hash(scene, mesh, "newmtl own\n\n"), first);
}

}  // namespace
}  // namespace raymill
