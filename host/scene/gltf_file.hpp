// glTF 2.0 and GLB as a checked document with its buffers and pictures, before meshes and materials.
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf_value.hpp"
#include "scene/loading.hpp"

namespace raymill {

/// A picture's bytes; or its path, where it is a file beside the document.
struct GltfPicture {
    std::string name;  // the path, or the file and its images[i]
    std::string bytes;
    bool is_file = false;
};

/// The numbers of an accessor, one element after the other; `normalized` ones are in [0, 1] or [-1, 1].
struct GltfNumbers {
    std::size_t count = 0;
    std::size_t components = 0;
    std::vector<double> values;
    const double* operator[](std::size_t i) const { return &values[i * components]; }
};

/// The document is read with nlohmann-json rather than tinygltf (2.7 of Debian 12), which takes properties of a wrong
/// type for missing ones, follows references to nothing, refuses buffers without data that nothing uses, and does not
/// say where in the document a fault lies.
/// Source: Khronos, "glTF 2.0 Specification", 2021.
class GltfFile {
  public:
    /// Checks the container, the version, the required extensions and the document, and loads the buffers. Throws
    /// SceneError.
    GltfFile(Loading& loading, const std::string& path, std::string bytes);

    const std::string& path() const { return path_; }
    GltfValue root() const { return {document_, "", path_}; }
    /// collection[index], such as meshes[3]; `reference` is the value that holds the index.
    GltfValue referred(const GltfValue& reference, const std::string& collection) const;
    /// The numbers of the accessor that `reference` names, with its sparse part. `types` are those allowed, such as
    /// "VEC3"; `component_types` the codes allowed, all if empty. Throws SceneError for data that is not there and for
    /// numbers that are not finite.
    GltfNumbers accessor(const GltfValue& reference, std::span<const char* const> types,
                         std::span<const int> component_types);
    GltfPicture picture(const GltfValue& image) const;

    /// Notes what the file asks for and does not get; each is named once.
    void leave_out(const std::string& what) { left_out_.insert(what); }
    /// One warning that names all that is left out, if anything is.
    void warn_of_left_out();

  private:
    struct View {
        std::string_view bytes;
        std::size_t stride = 0;  // 0: packed
    };

    void parse(std::string_view text);
    std::string_view open_container(const std::string& bytes);
    void load_buffers();
    std::string read_uri(const std::string& uri);
    View buffer_view(const GltfValue& reference) const;
    void read_dense(const GltfValue& accessor, const GltfValue& view_reference, int component_type, bool normalized,
                    GltfNumbers& numbers);
    void read_sparse(const GltfValue& sparse, int component_type, bool normalized, GltfNumbers& numbers);

    Loading& loading_;
    std::string path_;
    nlohmann::json document_;
    std::optional<std::string> binary_chunk_;
    std::set<std::string> left_out_;
    std::map<std::uint64_t, std::string> buffers_;  // loaded ones
};

/// Throws SceneError for what can be told wrong without the data: a reference to an item that is not there, a node with
/// two parents or in a circle, collections that are no arrays of objects, views and accessors that leave their buffers.
void check_gltf_document(const GltfValue& root);

/// Bytes of a number by the componentType of an accessor, or of the indices of a sparse one. Throws for an unknown one.
std::size_t gltf_component_size(const GltfValue& accessor);
/// Bytes of one packed element of an accessor; columns of matrices begin at multiples of four. Throws as above.
std::size_t gltf_element_size(const GltfValue& accessor);

}  // namespace raymill
