// Wavefront OBJ: the text of a file as polygons, before materials and the scene.
#pragma once

#include <string>
#include <vector>

#include "scene/error.hpp"
#include "scene/mesh.hpp"

namespace raymill {

/// What an OBJ file says. The triangles of the mesh are the file's polygons, triangulated, in order.
struct ObjFile {
    /// mesh.materials are indices into material_names, or NO_INDEX before the first usemtl; mesh.objects into
    /// object_names.
    IndexedMesh mesh;
    std::vector<std::string> material_names;  // as usemtl spells them, each once
    std::vector<int> material_lines;          // where each is first used
    std::vector<std::string> object_names;    // of `o` and `g` with faces; "" for faces before any
    struct Library {
        std::string names;  // the rest of a mtllib line
        int line;
    };
    std::vector<Library> libraries;
    std::vector<Diagnostic> errors;  // bad numbers and indices, with their lines; reading stops after 20
    std::vector<Diagnostic> warnings;
};

/// Reads v, vn, vt, f, o, g, s, usemtl, mtllib; lines and points are skipped with a warning, all else silently.
/// Numbers are C's, and MSVC's "1.#IND" and "1.#INF"; coordinates that are not finite are kept. Indices may be relative
/// (negative) and may refer to later vertices; one that refers to nothing is an error.
/// The geometry is read here rather than by tinyobjloader, which reads "nan" as 0, cuts polygons of more than 255
/// corners, takes an index before the first uv for "no uv", and does not say in which line a bad face stands.
/// Source: Wavefront, "Advanced Visualizer", appendix B1.
ObjFile read_obj(const std::string& text, const std::string& file);

}  // namespace raymill
