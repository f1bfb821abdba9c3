// Rendering a bare model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "scene/shapes.hpp"
#include "scene_files.hpp"

namespace raymill {
namespace {

/// A box from -1 to 1 as OBJ, without the sides named in `open` ("+z" and so on), facing inwards.
std::string box_obj(const std::string& open) {
    const char* sides[] = {"-x 1 2 6 5", "+x 3 7 8 4", "-y 1 5 7 3", "+y 2 4 8 6", "-z 1 3 4 2", "+z 5 6 8 7"};
    std::string text;
    for (const int x : {-1, 1})
        for (const int z : {-1, 1})
            for (const int y : {-1, 1})
                text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    // Vertices: 1 + 4 [x] + 2 [z] + [y].
    const char* faces[] = {"1 2 4 3", "5 7 8 6", "1 3 7 5", "2 6 8 4", "1 5 6 2", "3 4 8 7"};
    for (int i = 0; i < 6; ++i)
        if (open.find(std::string(sides[i]).substr(0, 2)) == std::string::npos)
            text += std::string("f ") + faces[i] + "\n";
    return text;
}

/// Where the camera sees p: x and y in [-1, 1] inside the picture.
glm::dvec2 seen_at(const Scene& scene, const glm::dvec3& p) {
    const Camera& camera = scene.camera;
    const glm::dvec3 forward = glm::normalize(camera.look_at - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
    const glm::dvec3 d = p - camera.eye;
    const double tan_y = std::tan(glm::radians(camera.fov / 2)), z = glm::dot(d, forward);
    EXPECT_GT(z, 0);
    const double aspect = double(scene.settings.width) / scene.settings.height;
    return {glm::dot(d, right) / (z * tan_y * aspect), glm::dot(d, up) / (z * tan_y)};
}

void expect_framed(const Scene& scene) {
    double widest = 0;
    for (const Vertex& v : scene.vertices) {
        const glm::dvec2 at = glm::abs(seen_at(scene, glm::dvec3(vec(v.position))));
        widest = std::max({widest, at.x, at.y});
    }
    EXPECT_LE(widest, 1);
    EXPECT_GE(widest, 0.8);  // the margin is 5%; a little more where the box's far corners are empty
}

TEST(BareModel, is_seen_whole_from_the_right_in_front_and_above) {
    for (const char* scale : {"", "e6", "e-6"}) {
        std::string text;
        for (const char* p : {"0 0 0", "3 0 0", "0 1 0", "0 0 2"}) {
            text += "v";
            for (const char* c = p; *c; c += 2) text += std::string(" ") + *c + scale, c -= !c[1];
            text += "\n";
        }
        const Scene scene = SceneFiles().obj(text + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        expect_framed(scene);
        const glm::dvec3 towards_eye = scene.camera.eye - scene.camera.look_at;
        EXPECT_GT(towards_eye.z, towards_eye.x);
        EXPECT_GT(towards_eye.x, 0);
        EXPECT_GT(towards_eye.y, 0);
        EXPECT_EQ(scene.camera.up, glm::dvec3(0, 1, 0));
    }
}

TEST(BareModel, that_is_a_room_is_seen_through_its_open_side_and_lit_from_its_ceiling) {
    const std::pair<const char*, glm::dvec3> rooms[] = {
        {"+z", {0, 0, 1}}, {"-z", {0, 0, -1}}, {"+x", {1, 0, 0}}, {"-x", {-1, 0, 0}}};
    for (const auto& [open, out] : rooms) {
        const Scene scene = SceneFiles().obj(box_obj(open));
        expect_framed(scene);
        const glm::dvec3 towards_eye = glm::normalize(scene.camera.eye - scene.camera.look_at);
        EXPECT_NEAR(glm::distance(towards_eye, out), 0, 1e-5) << open;  // six digits
        const auto& key = std::get<PointLight>(scene.lights.at(0).light);
        EXPECT_GT(key.position.y, 0.5) << open;
        EXPECT_LT(key.position.y, 1) << open;
        EXPECT_LT(std::max(std::abs(key.position.x), std::abs(key.position.z)), 0.5) << open;
        const auto& fill = std::get<PointLight>(scene.lights.at(1).light);
        EXPECT_EQ(fill.position, glm::vec3(scene.camera.eye)) << open;
    }
}

TEST(BareModel, that_is_closed_or_open_twice_is_no_room) {
    for (const char* open : {"none", "+z-z", "+y"})
        EXPECT_GT(SceneFiles().obj(box_obj(open)).camera.eye.y, 0.1) << open;
}

TEST(BareModel, in_a_closed_room_is_seen_from_inside) {
    const Scene scene = SceneFiles().obj(box_obj("none") + "v 0 0 0\nv .2 0 0\nv 0 .2 .1\nf -3 -2 -1\n");
    const glm::dvec3 eye = glm::abs(scene.camera.eye);
    EXPECT_LT(std::max({eye.x, eye.y, eye.z}), 1);
    for (const glm::dvec3& corner : {glm::dvec3(0), glm::dvec3(0.2, 0, 0), glm::dvec3(0, 0.2, 0.1)}) {
        const glm::dvec2 at = glm::abs(seen_at(scene, corner));
        EXPECT_LE(std::max(at.x, at.y), 1);
    }
}

TEST(BareModel, under_a_lamp_is_framed_without_it_and_a_room_is_lit_from_there) {
    SceneFiles files;
    files.write("a.mtl", "newmtl wall\nKd 1 1 1\nnewmtl lamp\nKe 3 3 3\n");
    const std::string lamp = "usemtl lamp\nv .3 Y .4\nv .5 Y .4\nv .3 Y .6\nf -3 -1 -2\n";
    const auto with_lamp_at = [&](const std::string& shape, const std::string& y) {
        std::string text = "mtllib a.mtl\nusemtl wall\n" + shape + lamp;
        for (std::size_t at; (at = text.find('Y')) != std::string::npos;) text.replace(at, 1, y);
        return files.obj(text);
    };
    EXPECT_EQ(with_lamp_at(box_obj("none"), "50").camera.eye, SceneFiles().obj(box_obj("none")).camera.eye);
    const Scene room = with_lamp_at(box_obj("+z"), ".9");
    const auto& key = std::get<PointLight>(room.lights.at(0).light);
    EXPECT_NEAR(glm::distance(key.position, glm::vec3(0.4f, 0.8f, 0.5f)), 0, 1e-5);  // six digits
}

TEST(BareModel, has_a_key_a_fill_and_an_ambient_light_that_do_not_overexpose) {
    const Scene scene = SceneFiles().obj(box_obj("none"));
    ASSERT_EQ(scene.lights.size(), 3u);
    const auto& key = std::get<DirectionalLight>(scene.lights[0].light);
    const auto& fill = std::get<DirectionalLight>(scene.lights[1].light);
    const auto& ambient = std::get<AmbientLight>(scene.lights[2].light);
    EXPECT_GT(key.intensity.x, fill.intensity.x);
    // The brightest direction gets the length of the sum of both; 0.8 is the default surface.
    const double brightest = glm::length(key.intensity.x * key.direction + fill.intensity.x * fill.direction);
    EXPECT_LT(0.8 * brightest + ambient.color.x, 1);
    EXPECT_GT(0.8 * brightest, 0.5);
}

TEST(BareModel, of_nothing_or_a_point_or_not_a_number_still_has_a_camera) {
    for (const char* text : {"", "v 1 1 1\nf 1 1 1\n", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}) {
        const Scene scene = SceneFiles().obj(text);
        const glm::dvec3 view = scene.camera.eye - scene.camera.look_at;
        EXPECT_TRUE(std::isfinite(glm::length(view)) && glm::length(view) > 0) << text;
    }
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(BareModel, and_the_scene_file_printed_for_it_are_the_same_scene) {
    const SceneFiles files;
    files.write("a.mtl", "newmtl m\nKd 1 0 0\nKe 3 3 3\n");
    for (const std::string& shape : {box_obj("+z"), box_obj("none")}) {
        const std::string model = files.write(
            "a \"quoted\" \\ m\xc3\xb6"
            "del.obj",
            "mtllib a.mtl\nusemtl m\n" + shape);
        const std::string text = model_scene_toml(model);
        EXPECT_THAT(text, testing::HasSubstr("shape = \"mesh\""));
        const Scene bare = load_scene(model), written = files.toml(text);
        EXPECT_EQ(written.camera.eye, bare.camera.eye);
        EXPECT_EQ(written.camera.look_at, bare.camera.look_at);
        EXPECT_EQ(written.camera.up, bare.camera.up);
        EXPECT_EQ(written.camera.fov, bare.camera.fov);
        EXPECT_EQ(written.settings.width, bare.settings.width);
        ASSERT_EQ(written.lights.size(), bare.lights.size());
        for (std::size_t i = 0; i < 2; ++i) {
            ASSERT_EQ(written.lights[i].light.index(), bare.lights[i].light.index());
            if (const auto* a = std::get_if<PointLight>(&written.lights[i].light)) {
                const auto& b = std::get<PointLight>(bare.lights[i].light);
                EXPECT_EQ(a->position, b.position);
                EXPECT_EQ(a->intensity, b.intensity);
                continue;
            }
            const auto& a = std::get<DirectionalLight>(written.lights[i].light);
            const auto& b = std::get<DirectionalLight>(bare.lights[i].light);
            EXPECT_EQ(a.direction, b.direction);
            EXPECT_EQ(a.intensity, b.intensity);
        }
        EXPECT_EQ(std::get<AmbientLight>(written.lights[2].light).color,
                  std::get<AmbientLight>(bare.lights[2].light).color);
        EXPECT_TRUE(same_bytes(written.vertices, bare.vertices));
        EXPECT_TRUE(same_bytes(written.triangles, bare.triangles));
        ASSERT_EQ(written.materials.size(), bare.materials.size());
        EXPECT_EQ(written.materials[1].emission, bare.materials[1].emission);
        EXPECT_EQ(written.objects[0].name, bare.objects[0].name);
    }
}

}  // namespace
}  // namespace raymill
