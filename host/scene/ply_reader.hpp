// PLY: the bytes of a file as triangles, before the scene.
#pragma once

#include <string>
#include <vector>

#include "scene/error.hpp"
#include "scene/vertex_colors.hpp"

namespace raymill {

/// What a PLY file says. The triangles of the mesh are the file's polygons, triangulated, and its strips, in order.
struct PlyFile {
    ColoredMesh mesh;
    std::vector<std::string> textures;  // pictures that the header names, in MeshLab's way
    std::vector<Diagnostic> warnings;
};

/// Reads the elements vertex, face and tristrips of ascii and binary files; others, and properties not named here, are
/// skipped.
/// - vertex: x y z; nx ny nz; u v, s t, texture_u texture_v or texture_s texture_t; red green blue or diffuse_red ...
/// - face: vertex_indices or vertex_index; texcoord (two numbers a corner, as MeshLab has them); red green blue, which
///   serve where vertices have no colours.
/// - tristrips: vertex_indices, where -1 begins a new strip.
/// Colours of whole types are sRGB, floating ones linear. Normals that are not finite leave their corners flat; a
/// triangle whose normals all oppose its winding is turned.
/// Throws SceneError for the first fault, with the line (ascii) or the byte (binary): data that is cut off or left
/// over, numbers that are none or not finite, indices that refer to nothing, counts that the file is too short for.
PlyFile read_ply(const std::string& bytes, const std::string& file);

}  // namespace raymill
