// What can be checked of a glTF document before its data is read: references, trees, and the extents of data.
#include <fmt/format.h>

#include "scene/gltf_file.hpp"

namespace raymill {
namespace {

struct Reference {
    const char* pattern;     // "nodes[].mesh"; "[]" is each item, "*" each member
    const char* collection;  // what the index counts in
};

constexpr Reference references[] = {
    {"scene", "scenes"},
    {"scenes[].nodes[]", "nodes"},
    {"nodes[].children[]", "nodes"},
    {"nodes[].mesh", "meshes"},
    {"nodes[].camera", "cameras"},
    {"nodes[].skin", "skins"},
    {"nodes[].extensions.KHR_lights_punctual.light", "extensions.KHR_lights_punctual.lights"},
    {"meshes[].primitives[].attributes.*", "accessors"},
    {"meshes[].primitives[].targets[].*", "accessors"},
    {"meshes[].primitives[].indices", "accessors"},
    {"meshes[].primitives[].material", "materials"},
    {"accessors[].bufferView", "bufferViews"},
    {"accessors[].sparse.indices.bufferView", "bufferViews"},
    {"accessors[].sparse.values.bufferView", "bufferViews"},
    {"bufferViews[].buffer", "buffers"},
    {"materials[].pbrMetallicRoughness.baseColorTexture.index", "textures"},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture.index", "textures"},
    {"materials[].normalTexture.index", "textures"},
    {"materials[].occlusionTexture.index", "textures"},
    {"materials[].emissiveTexture.index", "textures"},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture.index", "textures"},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.specularGlossinessTexture.index", "textures"},
    {"textures[].source", "images"},
    {"textures[].sampler", "samplers"},
    {"images[].bufferView", "bufferViews"},
    {"skins[].inverseBindMatrices", "accessors"},
    {"skins[].skeleton", "nodes"},
    {"skins[].joints[]", "nodes"},
    {"animations[].channels[].target.node", "nodes"},
    {"animations[].samplers[].input", "accessors"},
    {"animations[].samplers[].output", "accessors"},
};

/// Calls `visit` for each value that the pattern matches below `value`; parts that are not there are passed over.
template <class Visit>
void match(const GltfValue& value, std::string_view pattern, const Visit& visit) {
    if (pattern.starts_with('.')) pattern.remove_prefix(1);
    if (pattern.empty()) return visit(value);
    if (pattern.starts_with("[]")) {
        for (const GltfValue& item : value.items()) match(item, pattern.substr(2), visit);
    } else if (pattern.starts_with('*')) {
        for (const auto& [name, member] : value.members()) match(member, pattern.substr(1), visit);
    } else {
        const std::size_t end = std::min(pattern.find_first_of(".["), pattern.size());
        const std::optional<GltfValue> found = value.find(std::string(pattern.substr(0, end)));
        if (found) match(*found, pattern.substr(end), visit);
    }
}

std::size_t size_of_collection(const GltfValue& root, const char* collection) {
    std::size_t size = 0;
    match(root, collection, [&](const GltfValue& array) { size = array.items().size(); });
    return size;
}

/// Nodes form trees: no node has two parents, and no circle holds one.
void check_trees(const GltfValue& root) {
    const std::size_t count = size_of_collection(root, "nodes");
    constexpr std::size_t none = ~std::size_t{0};
    std::vector<std::size_t> parent(count, none);
    std::size_t node = 0;
    match(root, "nodes[]", [&](const GltfValue& value) {
        match(value, "children[]", [&](const GltfValue& child) {
            std::size_t& known = parent[child.whole()];
            if (known != none)
                child.fail(fmt::format("is node {}, which node {} has as a child already", child.whole(), known));
            known = node;
        });
        ++node;
    });
    std::vector<std::size_t> seen_from(count, none);
    for (std::size_t start = 0; start < count; ++start)
        for (std::size_t i = start; i != none && (seen_from[i] == none || seen_from[i] == start); i = parent[i]) {
            if (seen_from[i] == start) root.at("nodes").items()[i].fail("has itself among its children's children");
            seen_from[i] = start;
        }
    match(root, "scenes[].nodes[]", [&](const GltfValue& value) {
        if (parent[value.whole()] != none) value.fail(fmt::format("is node {}, which is no root", value.whole()));
    });
}

void check_references(const GltfValue& root) {
    for (const auto& [pattern, collection] : references) {
        const std::size_t size = size_of_collection(root, collection);
        match(root, pattern, [&](const GltfValue& value) {
            const std::uint64_t index = value.whole();
            if (index >= size)
                value.fail(
                    fmt::format("refers to item {} of \"{}\", which has {}, counted from 0", index, collection, size));
        });
    }
}

std::uint64_t at_least_one(const GltfValue& value, const char* key) {
    const GltfValue number = value.at(key);
    const std::uint64_t whole = number.whole();
    if (whole == 0) number.fail("is 0, but must be at least 1");
    return whole;
}

void check_buffer_views(const GltfValue& root) {
    match(root, "buffers[]", [](const GltfValue& buffer) { at_least_one(buffer, "byteLength"); });
    match(root, "bufferViews[]", [&](const GltfValue& view) {
        const std::uint64_t offset = view.whole_or("byteOffset", 0), length = at_least_one(view, "byteLength");
        const std::uint64_t size = root.at("buffers").item(view.at("buffer").whole()).at("byteLength").whole();
        if (offset > size || length > size - offset)
            view.fail(fmt::format("is bytes {} to {} of a buffer of {}", offset, offset + length, size));
        const std::optional<GltfValue> stride = view.find("byteStride");
        if (stride && (stride->whole() < 4 || stride->whole() > 252))
            stride->fail(fmt::format("is {}, but must be from 4 to 252", stride->whole()));
    });
}

/// Bytes from `holder`'s byteOffset on that hold `count` elements must lie in its buffer view.
void check_extent(const GltfValue& root, const GltfValue& holder, std::uint64_t count, std::size_t element) {
    const GltfValue view = root.at("bufferViews").item(holder.at("bufferView").whole());
    const std::uint64_t offset = holder.whole_or("byteOffset", 0), stride = view.whole_or("byteStride", element);
    const std::uint64_t length = view.at("byteLength").whole();
    if (stride < element)
        view.fail(
            fmt::format("has the byteStride {}, but the elements of {} have {} bytes", stride, holder.path(), element));
    if (offset > length || element > length - offset || count - 1 > (length - offset - element) / stride)
        holder.fail(fmt::format("has {} elements of {} bytes from byte {} on, but {} has {}", count, element, offset,
                                view.path(), length));
}

void check_accessors(const GltfValue& root) {
    match(root, "accessors[]", [&](const GltfValue& accessor) {
        const std::size_t element = gltf_element_size(accessor);
        const std::uint64_t count = at_least_one(accessor, "count");
        if (accessor.find("bufferView"))
            check_extent(root, accessor, count, element);
        else if (accessor.find("byteOffset"))
            accessor.at("byteOffset").fail("stands without a bufferView");
        const std::optional<GltfValue> sparse = accessor.find("sparse");
        if (!sparse) return;
        const std::uint64_t replaced = at_least_one(*sparse, "count");
        if (replaced > count) sparse->fail(fmt::format("has {} elements of {}", replaced, count));
        check_extent(root, sparse->at("indices"), replaced, gltf_component_size(sparse->at("indices")));
        check_extent(root, sparse->at("values"), replaced, element);
    });
}

}  // namespace

void check_gltf_document(const GltfValue& root) {
    for (const char* collection : {"accessors", "animations", "buffers", "bufferViews", "cameras", "images",
                                   "materials", "meshes", "nodes", "samplers", "scenes", "skins", "textures"})
        if (const auto array = root.find(collection))
            for (const GltfValue& item : array->items()) item.members();
    check_references(root);
    check_trees(root);
    check_buffer_views(root);
    check_accessors(root);
    match(root, "images[]", [](const GltfValue& image) {
        if (image.find("uri").has_value() == image.find("bufferView").has_value())
            image.fail("must have either a URI or a bufferView");
    });
}

}  // namespace raymill
