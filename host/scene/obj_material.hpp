// MTL materials as Raymill's.
#pragma once

#include <map>
#include <string>

#include "scene/loading.hpp"

namespace raymill {

/// A material library read by tinyobjloader, its materials turned into scene materials only where they are used.
///
/// How MTL's parameters are read, beside Ka, Kd, Ks, Ns, Ke as ambient, diffuse, specular, shininess, emission:
/// - A negative or not finite parameter counts as 0. `illum` 0 and 1 have no highlight (1: specular = 0; 0 is read as
/// 2,
///   since exporters write it for "unknown").
/// - illum 3 and above: reflection = the largest component of Ks (at most 1).
/// - illum 4, 6, 7, 9 (glass): transmission = the largest component of Tf, or 1 - d where there is no Tf; ior = Ni,
/// with 1
///   for an Ni that is not positive. illum 7 is fresnel.
/// - `base_color` carries the tint: Tf over its largest component for glass, else Ks over its largest.
/// - Other materials with d < 1 are see-through without refraction: transmission = 1 - d, ior = 1. `d` wins over `Tr`.
/// - Where reflection + transmission would exceed 1, both are scaled to sum to 1.
/// - No illum at all: glass with fresnel if there is a Tf, or d < 1 with Ni > 1; a mirror if Kd is 0 and Ks is not;
/// else 2.
/// - map_Kd is the texture, multiplied by Kd (0.6 without one). Other maps, and map_Kd's options, are named in a
/// warning.
class MaterialLibrary {
  public:
    /// Reads one more file; its materials do not replace those of the same name before it. False if it cannot be read,
    /// with the reason.
    bool add_file(Loading& loading, const std::string& path, std::string& reason);

    /// The index into Scene::materials, appended on first use; nothing for an unknown name.
    std::optional<std::uint32_t> use(Loading& loading, const std::string& name);

  private:
    struct Entry {
        SceneMaterial material;
        std::string file;             // of the library
        std::string diffuse_texture;  // path, or empty
        std::string not_supported;    // words for a warning, or empty
        std::optional<std::uint32_t> index;
    };
    std::map<std::string, Entry> entries_;
};

}  // namespace raymill
