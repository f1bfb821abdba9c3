// PLY.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "scene/color.hpp"
#include "scene/ply_reader.hpp"
#include "scene_files.hpp"

namespace raymill {
namespace {

using testing::HasSubstr;

const std::string quad_vertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// An ascii file of four vertices and, with `body`, all that comes after them.
std::string quad(const std::string& vertex_properties, const std::string& elements, const std::string& body) {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
           vertex_properties + elements + "end_header\n" + body;
}

std::string simple_quad(const std::string& faces) {
    const auto count = std::to_string(std::count(faces.begin(), faces.end(), '\n'));
    return quad("", "element face " + count + "\nproperty list uchar int vertex_indices\n", quad_vertices + faces);
}

/// What the fault says, without the file's name.
std::string fault_of(const std::string& ply) {
    try {
        read_ply(ply, "a.ply");
    } catch (const SceneError& error) {
        return std::string(error.what()).substr(5);
    }
    return "none";
}

/// Numbers as bytes of either order.
class Bytes {
  public:
    explicit Bytes(bool big) : big_(big) {}
    template <class T>
    Bytes& operator<<(T value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        if (big_) std::reverse(bytes, bytes + sizeof value);
        text.append(bytes, sizeof value);
        return *this;
    }
    std::string text;

  private:
    bool big_;
};

TEST(Ply, of_ascii_has_its_vertices_and_faces) {
    const PlyFile ply = read_ply(simple_quad("3 0 1 2\n3 0 2 3\n"), "a.ply");
    ASSERT_EQ(ply.mesh.positions.size(), 4u);
    EXPECT_EQ(ply.mesh.positions[2], glm::dvec3(1, 1, 0));
    ASSERT_EQ(ply.mesh.triangles.size(), 2u);
    for (int c = 0; c < 3; ++c) {
        const std::uint32_t expected[2][3] = {{0, 1, 2}, {0, 2, 3}};
        for (int t = 0; t < 2; ++t) EXPECT_EQ(ply.mesh.triangles[t][c], (Corner{expected[t][c], NO_INDEX, NO_INDEX}));
    }
}

TEST(Ply, of_polygons_is_cut_into_triangles_and_faces_of_two_corners_are_left_out_with_a_warning) {
    const PlyFile ply = read_ply(simple_quad("4 0 1 2 3\n2 0 1\n"), "a.ply");
    EXPECT_EQ(ply.mesh.triangles.size(), 2u);
    ASSERT_EQ(ply.warnings.size(), 1u);
    EXPECT_THAT(ply.warnings[0].message, HasSubstr("1 faces with fewer than three corners"));
}

TEST(Ply, of_every_number_type_and_byte_order_is_read) {
    for (const bool big : {false, true}) {
        Bytes bytes(big);
        for (const auto& [x, y, z] : {std::array{1.5, -2.0, 3.0}, {4.25, 5.0, 6.0}, {7.0, 8.0, 9.0}})
            bytes << x << static_cast<float>(y) << static_cast<std::int16_t>(z) << std::uint8_t{200} << std::int8_t{-3};
        bytes << std::uint32_t{3} << std::uint16_t{2} << std::uint16_t{1} << std::uint16_t{0} << std::int32_t{-7};
        const std::string header = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                                   "_endian 1.0\nelement vertex 3\nproperty double x\nproperty float32 y\n"
                                   "property short z\nproperty uint8 quality\nproperty char other\nelement face 1\n"
                                   "property list uint ushort vertex_index\nproperty int flags\nend_header\n";
        const PlyFile ply = read_ply(header + bytes.text, "a.ply");
        EXPECT_EQ(ply.mesh.positions, (std::vector<glm::dvec3>{{1.5, -2, 3}, {4.25, 5, 6}, {7, 8, 9}}));
        ASSERT_EQ(ply.mesh.triangles.size(), 1u);
        EXPECT_EQ(ply.mesh.triangles[0][0].position, 2u);
        EXPECT_EQ(ply.mesh.triangles[0][2].position, 0u);
        // One byte less, and one byte more.
        EXPECT_THAT(fault_of(header + bytes.text.substr(0, bytes.text.size() - 1)),
                    HasSubstr("the file ends before all its elements are read (at byte"));
        EXPECT_THAT(fault_of(header + bytes.text + "x"), HasSubstr("1 bytes are left"));
    }
}

TEST(Ply, may_have_elements_in_any_order_line_ends_of_any_kind_and_unknown_parts) {
    for (const char* end : {"\n", "\r\n", "\r"}) {
        std::string text;
        for (const char c : std::string(
                 "ply\nformat ascii 1.0\ncomment made by hand\nobj_info x\nelement edge 2\nproperty int vertex1\n"
                 "property list uchar float weights\nelement face 1\nproperty uchar flags\n"
                 "property list uchar uint vertex_indices\nelement vertex 3\nproperty float x\nproperty float x\n"
                 "property float y\nproperty float z\nend_header\n5 2 0.5 0.25\n6 0\n9 3 0 1 2\n0 9 0 0\n1 9 0 0\n"
                 "0 9 1 0\n"))
            text += c == '\n' ? end : std::string(1, c);
        const PlyFile ply = read_ply(text, "a.ply");
        EXPECT_EQ(ply.mesh.positions, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
        EXPECT_EQ(ply.mesh.triangles.size(), 1u);
    }
}

TEST(Ply, has_normals_and_texture_coordinates_of_any_spelling) {
    for (const char* names : {"u v", "s t", "texture_u texture_v", "texture_s texture_t"}) {
        const std::string u = std::string(names).substr(0, std::string(names).find(' '));
        const std::string v = std::string(names).substr(u.size() + 1);
        const PlyFile ply =
            read_ply(quad("property float nx\nproperty float ny\nproperty float nz\nproperty float " + u +
                              "\nproperty float " + v + "\n",
                          "element face 1\nproperty list uchar int vertex_indices\n",
                          "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n1 1 0 0 0 2 1 0.5\n0 1 0 nan 0 1 0 1\n3 0 1 2\n"),
                     "a.ply");
        EXPECT_EQ(ply.mesh.triangles[0][2], (Corner{2, 2, 2}));
        EXPECT_EQ(ply.mesh.normals[2], glm::dvec3(0, 0, 2));
        EXPECT_EQ(ply.mesh.uvs[2], glm::dvec2(1, 0.5));
    }
}

TEST(Ply, whose_normals_oppose_the_winding_is_turned) {
    const auto with_normals = [](const char* second) {
        return read_ply(quad("property float nx\nproperty float ny\nproperty float nz\n",
                             "element face 1\nproperty list uchar int vertex_indices\n",
                             std::string("0 0 0 0 0 -1\n1 0 0 ") + second + "\n1 1 0 0 0 -1\n0 1 0 0 0 1\n3 0 1 2\n"),
                        "a.ply")
            .mesh.triangles[0];
    };
    EXPECT_EQ(with_normals("0 0 -1")[1].position, 2u);
    EXPECT_EQ(with_normals("0 0 1")[1].position, 1u);
}

TEST(Ply, of_triangle_strips_turns_every_second_one_and_begins_anew_at_minus_one) {
    const PlyFile ply = read_ply(quad("", "element tristrips 1\nproperty list int int vertex_indices\n",
                                      quad_vertices + "9 0 1 3 2 -1 3 3 2 1\n"),
                                 "a.ply");
    ASSERT_EQ(ply.mesh.triangles.size(), 3u);
    const std::uint32_t expected[3][3] = {{0, 1, 3}, {3, 1, 2}, {2, 3, 1}};
    for (int t = 0; t < 3; ++t)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(ply.mesh.triangles[t][c].position, expected[t][c]) << t;
}

TEST(Ply, with_texture_coordinates_at_corners_keeps_them_apart) {
    const PlyFile ply = read_ply(quad("",
                                      "element face 2\nproperty list uchar int vertex_indices\n"
                                      "property list uchar float texcoord\n",
                                      quad_vertices + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 .5 0 1 .5 0 1\n"),
                                 "a.ply");
    EXPECT_EQ(ply.mesh.uvs[ply.mesh.triangles[0][0].uv], glm::dvec2(0, 0));
    EXPECT_EQ(ply.mesh.uvs[ply.mesh.triangles[1][0].uv], glm::dvec2(0.5, 0));
}

/// The texture at the uv as the kernels sample it: bilinear between texel centres, repeating, rows from the top.
glm::vec3 sampled(const TextureImage& image, const float (&uv)[2]) {
    const double x = uv[0] * image.width - 0.5, y = (1 - uv[1]) * image.height - 0.5;
    const double fx = x - std::floor(x), fy = y - std::floor(y);
    const auto texel = [&](int i, int j) {
        const std::size_t column = (std::size_t(x) + i) % image.width, row = (std::size_t(y) + j) % image.height;
        return glm::dvec3(image.texels[row * image.width + column]);
    };
    return glm::vec3(glm::mix(glm::mix(texel(0, 0), texel(1, 0), fx), glm::mix(texel(0, 1), texel(1, 1), fx), fy));
}

TEST(Ply, with_vertex_colors_shows_them_at_the_vertices_and_linear_between) {
    const Scene scene = SceneFiles().load(
        "a.ply", quad("property uchar red\nproperty uchar green\nproperty uchar blue\n",
                      "element face 2\nproperty list uchar int vertex_indices\n",
                      "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 128 128 128\n3 0 1 2\n3 0 2 3\n"));
    const float grey = static_cast<float>(srgb_to_linear(128 / 255.0));
    const glm::vec3 colors[2][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}, glm::vec3(grey)}};
    ASSERT_EQ(scene.images.size(), 1u);
    for (std::size_t t = 0; t < 2; ++t) {
        const SceneMaterial& material = scene.materials[scene.triangles[t].material];
        EXPECT_EQ(material.diffuse, glm::vec3(1));
        ASSERT_EQ(material.diffuse_map, 0u);
        float middle[2] = {0, 0};
        for (int c = 0; c < 3; ++c) {
            const Vertex& vertex = scene.vertices[scene.triangles[t].vertex[c]];
            EXPECT_EQ(sampled(scene.images[0], vertex.uv), colors[t][c]);  // texel centres are exact
            for (int k = 0; k < 2; ++k) middle[k] += vertex.uv[k] / 3;
        }
        const glm::vec3 mean = (colors[t][0] + colors[t][1] + colors[t][2]) / 3.0f;
        EXPECT_LT(glm::distance(sampled(scene.images[0], middle), mean), 1e-5f);  // uvs of 24 bits, 8 texels
    }
}

TEST(Ply, of_one_color_has_no_texture_and_floating_colors_are_linear) {
    const Scene scene =
        SceneFiles().load("a.ply", quad("",
                                        "element face 1\nproperty list uchar int vertex_indices\nproperty float red\n"
                                        "property float green\nproperty float blue\n",
                                        quad_vertices + "4 0 1 2 3 0.5 0.25 1\n"));
    EXPECT_TRUE(scene.images.empty());
    EXPECT_EQ(scene.materials[scene.triangles[0].material].diffuse, glm::vec3(0.5f, 0.25f, 1));
}

TEST(Ply, with_a_material_of_the_scene_has_that_and_its_place) {
    const SceneFiles files;
    files.write("a.ply", simple_quad("3 0 1 2\n"));
    const Scene scene = files.toml(
        "[[material]]\nname = \"m\"\n[[object]]\nshape = \"mesh\"\nfile = \"a.ply\"\nmaterial = \"m\"\n"
        "translate = [0, 0, 5]\n");
    EXPECT_EQ(scene.materials.at(scene.triangles.at(0).material).name, "m");
    EXPECT_EQ(position(scene, scene.triangles[0], 1), glm::vec3(1, 0, 5));
}

TEST(Ply, that_is_faulty_is_refused_with_the_place) {
    const std::pair<std::string, std::string> cases[] = {
        {"", ":1: a PLY file begins with the line \"ply\""},
        {"solid\n", ":1: a PLY file begins"},
        {"ply\n", ":1: the file ends before the line \"end_header\""},
        {"ply\nend_header\n", ":2: the header has no line \"format\""},
        {"ply\nformat ascii 2.0\n", ":2: \"2.0\" is not the version"},
        {"ply\nformat text 1.0\n", ":2: \"text\" is none of the formats"},
        {"ply\nformat ascii 1.0\nelement vertex -1\n", ":3: an element needs a name and a count"},
        {"ply\nformat ascii 1.0\nproperty float x\n", ":3: a property before the first element"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", ":4: \"half\" is not a type"},
        {"ply\nformat ascii 1.0\nelement face 0\nproperty list float int a\n", ":4: the length of a list must be"},
        {"ply\nformat ascii 1.0\nelement a 1\nelement a 1\n", ":4: there is a second element \"a\""},
        {"ply\nformat ascii 1.0\nend_header\n", ": there is no element \"vertex\""},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", ":3: the vertices have no"},
        {simple_quad("3 0 1 4\n"), ":14: a face refers to vertex 4, but there are 4, counted from 0"},
        {simple_quad("3 0 -1 2\n"), ":14: a face refers to vertex -1"},
        {simple_quad("3 0 1.5 2\n"), ":14: a face refers to vertex 1.5"},
        {simple_quad("3 0 1 x\n"), ":14: \"x\" is not a number"},
        {simple_quad("3 0 1 2\n3 0 1\n"), ":16: the file ends before all its elements are read"},
        {simple_quad("3 0 1 2\n") + "7 7 7\n", ":15: all elements are read, but 6 bytes are left"},
        {simple_quad("200 0 1 2\n"), ":14: the list \"vertex_indices\" has the length 200, but the file ends"},
        {simple_quad("-3 0 1 2\n"), ":14: the list \"vertex_indices\" has the length -3"},
        {quad("", "", "0 0 0\n1 0 0\n1 inf 0\n0 1 0\n"), ":10: the property \"y\" must be a finite number"},
        {quad("", "", "0 0 0\n1 0 nan\n1 0 0\n0 1 0\n"), ":9: the property \"z\" must be a finite number"},
    };
    for (const auto& [text, message] : cases) EXPECT_THAT(fault_of(text), testing::StartsWith(message)) << text;
}

TEST(Ply, that_claims_more_than_its_bytes_hold_is_refused_before_memory_is_asked_for) {
    for (const char* format : {"ascii", "binary_little_endian"})
        for (const char* element :
             {"vertex 1000000000000000000", "face 1000000000000000000", "other 18446744073709551615"}) {
            std::string text = std::string("ply\nformat ") + format + " 1.0\nelement " + element +
                               "\nproperty float x\nproperty float y\nproperty float z\n";
            if (!std::string(element).starts_with("vertex"))
                text += "element vertex 0\nproperty float x\nproperty float y\nproperty float z\n";
            EXPECT_THAT(fault_of(text + "end_header\n"), testing::StartsWith(":3: ")) << element;
        }
}

TEST(Ply, with_bytes_changed_at_random_loads_or_is_refused_with_a_place) {
    Bytes body(false);
    for (int i = 0; i < 12; ++i) body << static_cast<float>(i % 5);
    for (int i = 0; i < 2; ++i) body << std::uint8_t{3} << 0 << 1 << 2 + i;
    const std::string faces = "element face 2\nproperty list uchar int vertex_indices\n";
    std::string binary = quad("", faces, body.text);
    binary.replace(binary.find("ascii"), 5, "binary_little_endian");
    const std::string texts[] = {simple_quad("3 0 1 2\n3 0 2 3\n"), binary};
    ASSERT_EQ(fault_of(binary), "none");
    std::mt19937 random(1);
    int refused = 0;
    for (int round = 0; round < 3000; ++round) {
        std::string bytes = texts[round % 2];
        for (int changes = 1 + round % 3; changes > 0; --changes)
            bytes[random() % bytes.size()] = "0123456789-e \n\0\x7f\xff"[random() % 17];
        const std::string fault = fault_of(bytes);
        if (fault == "none") continue;
        EXPECT_THAT(fault, testing::StartsWith(":"));
        ++refused;
    }
    EXPECT_GT(refused, 600);
}

}  // namespace
}  // namespace raymill
