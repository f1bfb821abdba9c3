// glTF files that are faulty: each is refused in a sentence that says where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "gltf_document.hpp"

namespace raymill {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// What the only fault of the file says, without its name.
std::string fault_of(const std::string& name, const std::string& bytes) {
    const SceneFiles files;
    const std::string file = files.write(name, bytes);
    try {
        load_scene(file);
    } catch (const SceneError& error) {
        const std::string text = error.what();
        return error.diagnostics().size() == 1 ? text.substr(file.size()) : "several: " + text;
    }
    return "none";
}

struct Case {
    const char* message;
    std::function<void(GltfDocument&)> spoil;
};

const Case cases[] = {
    {": asset is of version \"1.0\"", [](auto& d) { d.json["asset"]["version"] = "1.0"; }},
    {": the document must have the property \"asset\"", [](auto& d) { d.json.erase("asset"); }},
    {": the file cannot be shown without the extension KHR_draco_mesh_compression",
     [](auto& d) { d.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }},
    {": nodes must be an array", [](auto& d) { d.json["nodes"] = 5; }},
    {": meshes[0] must be an object", [](auto& d) { d.json["meshes"][0] = "mesh"; }},
    {": scene refers to item 3 of \"scenes\", which has 1", [](auto& d) { d.json["scene"] = 3; }},
    {": nodes[0].mesh refers to item 7", [](auto& d) { d.json["nodes"][0]["mesh"] = 7; }},
    {": nodes[0].mesh is -1, but must be a whole number", [](auto& d) { d.json["nodes"][0]["mesh"] = -1; }},
    {": nodes[0].mesh is 0.5, but must be a whole number", [](auto& d) { d.json["nodes"][0]["mesh"] = 0.5; }},
    {": nodes[0].mesh must be a whole number", [](auto& d) { d.json["nodes"][0]["mesh"] = "0"; }},
    {": nodes[0] has itself among its children's children", [](auto& d) { d.json["nodes"][0]["children"] = {0}; }},
    {": nodes[2].children[0] is node 1, which node 0 has as a child already",
     [](auto& d) {
         d.json["nodes"][0]["children"] = {1};
         d.json["nodes"][1] = json::object();
         d.json["nodes"][2]["children"] = {1};
     }},
    {": nodes[0].rotation must be 4 numbers, not 3",
     [](auto& d) {
         d.json["nodes"][0]["rotation"] = {0, 0, 1};
     }},
    {": nodes[0].rotation must be a quaternion",
     [](auto& d) {
         d.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
     }},
    {": nodes[0].matrix must not stand beside \"scale\"",
     [](auto& d) {
         d.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
         d.json["nodes"][0]["scale"] = {1, 1, 1};
     }},
    {": meshes[0].primitives[0].mode is 7", [](auto& d) { d.primitive()["mode"] = 7; }},
    {": meshes[0].primitives[0].indices refers to vertex 4, but there are 4",
     [](auto& d) {
         d.primitive()["indices"] = d.accessor(std::vector<std::uint8_t>{0, 1, 4}, "SCALAR", 5121, 3);
     }},
    {": meshes[0].primitives[0].attributes.NORMAL has 3 elements, but POSITION has 4",
     [](auto& d) { d.attribute("NORMAL") = d.floats("VEC3", 3, std::vector<float>(9, 1)); }},
    {": accessors[2] has the type \"VEC2\", but meshes[0].primitives[0].attributes.POSITION needs VEC3",
     [](auto& d) { d.attribute("POSITION") = d.floats("VEC2", 4, std::vector<float>(8, 1)); }},
    {": accessors[2] has numbers that are not finite",
     [](auto& d) {
         d.attribute("POSITION") = d.floats("VEC3", 1, {NAN, 0, 0});
     }},
    {": accessors[0].componentType is 9", [](auto& d) { d.json["accessors"][0]["componentType"] = 9; }},
    {": accessors[0].type is \"VEC9\"", [](auto& d) { d.json["accessors"][0]["type"] = "VEC9"; }},
    {": accessors[0] has 5 elements of 12 bytes from byte 0 on, but bufferViews[0] has 48",
     [](auto& d) { d.json["accessors"][0]["count"] = 5; }},
    {": accessors[0] has 1000000000000000 elements",
     [](auto& d) { d.json["accessors"][0]["count"] = 1000000000000000; }},
    {": accessors[0] has no data, and more than",
     [](auto& d) {
         d.json["accessors"][0].erase("bufferView");
         d.json["accessors"][0]["count"] = 4000000000;
     }},
    {": bufferViews[0] is bytes 0 to 500 of a buffer of 60",
     [](auto& d) { d.json["bufferViews"][0]["byteLength"] = 500; }},
    {": bufferViews[0].byteStride is 2, but must be from 4 to 252",
     [](auto& d) { d.json["bufferViews"][0]["byteStride"] = 2; }},
    {": materials[0].pbrMetallicRoughness.metallicFactor is 2, but must be from 0 to 1",
     [](auto& d) { d.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 2; }},
    {": materials[0].pbrMetallicRoughness.baseColorFactor must be an array",
     [](auto& d) { d.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = "red"; }},
    {": extensions.KHR_lights_punctual.lights[0].type is \"lamp\"",
     [](auto& d) { d.json["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = "lamp"; }},
};

/// A document with something of everything that is read.
GltfDocument textured_document() {
    GltfDocument document;
    document.square_faces();
    document.attribute("NORMAL") = document.floats("VEC3", 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    document.attribute("COLOR_0") = document.floats("VEC3", 4, {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
    document.primitive()["material"] = 0;
    document.json["materials"][0] = {{"emissiveFactor", {1, 1, 1}}, {"alphaMode", "BLEND"}};
    const int indices = document.accessor(std::vector<std::uint8_t>{1}, "SCALAR", 5121, 1);
    const int values = document.floats("VEC3", 1, {2, 0, 0});
    document.json["accessors"][0]["sparse"] = {{"count", 1},
                                               {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                               {"values", {{"bufferView", values}}}};
    document.json["nodes"][0]["scale"] = {1, -1, 2};
    document.json["nodes"][0]["camera"] = 0;
    document.json["cameras"][0] = {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}};
    document.json["extensions"]["KHR_lights_punctual"]["lights"][0] = {{"type", "spot"}, {"spot", json::object()}};
    document.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    return document;
}

TEST(GltfErrors, say_which_property_is_wrong) {
    for (const auto& [message, spoil] : cases) {
        GltfDocument document;
        document.square_faces();
        spoil(document);
        EXPECT_THAT(fault_of("a.gltf", document.text()), testing::StartsWith(message));
    }
}

TEST(GltfErrors, of_json_have_a_line) {
    EXPECT_EQ(fault_of("a.gltf", ""), ":1:1: the JSON text is not complete");
    EXPECT_EQ(fault_of("a.gltf", "{\n\"asset\" 1}"), ":2:9: this is not JSON");
    EXPECT_EQ(fault_of("a.gltf", "[]"), ": the JSON text must be an object");
    EXPECT_EQ(fault_of("a.gltf", "{\"a\": 1e999}"), ": a number of the JSON text is too large");
}

TEST(GltfErrors, of_buffers_name_the_buffer) {
    const auto with_buffer = [](const json& buffer) {
        GltfDocument document;
        document.square_faces();
        document.text();
        document.json["buffers"][0] = buffer;
        return fault_of("a.gltf", document.json.dump());
    };
    EXPECT_THAT(with_buffer({{"byteLength", 60}, {"uri", "none.bin"}}),
                HasSubstr(": buffers[0] cannot be read: \"none.bin\": No such file"));
    EXPECT_THAT(with_buffer({{"byteLength", 60}, {"uri", "http://example.com/a.bin"}}),
                HasSubstr("only data: and files are read"));
    EXPECT_THAT(with_buffer({{"byteLength", 60}, {"uri", "data:;base64,AA$A"}}), HasSubstr("its data is not base64"));
    EXPECT_THAT(with_buffer({{"byteLength", 60}, {"uri", "data:;base64,AAAA"}}),
                HasSubstr("buffers[0] must have 60 bytes, but there are 3"));
    EXPECT_THAT(with_buffer({{"byteLength", 60}}), HasSubstr("refers to a buffer without data"));
}

TEST(GltfErrors, of_glb_that_is_cut_off_anywhere_are_refused) {
    GltfDocument document;
    document.square_faces();
    const std::string whole = document.binary();
    ASSERT_EQ(fault_of("a.glb", whole), "none");
    for (std::size_t size = 0; size < whole.size(); size += 7)
        EXPECT_THAT(fault_of("a.glb", whole.substr(0, size)), testing::StartsWith(": ")) << size;
    std::string wrong = whole;
    wrong[4] = 1;
    EXPECT_THAT(fault_of("a.glb", wrong), HasSubstr("GLB of version 1"));
    EXPECT_THAT(fault_of("a.glb", "{}"), HasSubstr("begins with the letters"));
}

TEST(GltfErrors, of_files_with_bytes_changed_at_random_never_are_more_than_a_sentence) {
    GltfDocument document = textured_document();
    const std::string texts[] = {document.text(), document.binary()};
    const char* names[] = {"a.gltf", "a.glb"};
    std::mt19937 random(1);
    int refused = 0;
    for (int round = 0; round < 1500; ++round) {
        std::string bytes = texts[round % 2];
        for (int changes = 1 + round % 3; changes > 0; --changes)
            bytes[random() % bytes.size()] = "0123456789-e\"[]{}:,\0\xff"[random() % 21];
        const std::string fault = fault_of(names[round % 2], bytes);
        if (fault == "none") continue;
        EXPECT_THAT(fault, testing::StartsWith(":"));
        EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
        ++refused;
    }
    EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace raymill
