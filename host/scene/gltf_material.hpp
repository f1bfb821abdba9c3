// glTF's materials as Raymill's.
#pragma once

#include <map>

#include "scene/gltf_file.hpp"

namespace raymill {

/// How a texture's coordinates come from the mesh: the set TEXCOORD_n, then KHR_texture_transform.
struct GltfTextureUse {
    std::uint32_t uv_set = 0;
    glm::dvec2 offset{0};
    double rotation = 0;  // radians, counter-clockwise as seen with v downwards
    glm::dvec2 scale{1};
    glm::dvec2 operator()(const glm::dvec2& uv) const;
};

struct GltfMaterial {
    std::uint32_t index = 0;                 // into Scene::materials
    std::optional<GltfTextureUse> base_map;  // of diffuse_map
};

/// Materials are turned into scene materials where they are first used. A physically based surface as one of Phong's,
/// with the base colour c, the metallic factor m, the roughness r, each times the mean of its texture:
/// - diffuse = c, textured; ambient = the mean of that. What a metal does not mirror it spreads like a diffuse surface.
/// - highlight "blinn", shininess s = 2 / r^4 - 2, at most 10000 (the exponent of Blinn's distribution that is as wide
/// as
///   GGX with alpha = r^2: Karis, "Specular BRDF Reference", 2013; Walter et al. 2007).
/// - specular = F0 (s + 2) / 8, at most 1 (the normalised highlight: Akenine-Moeller et al., Real-Time Rendering 4e,
///   section 9.8.1), where F0 = ((ior - 1) / (ior + 1))^2 blended with c by m; KHR_materials_specular scales it.
/// - reflection = m (1 - r)^2, tinted by c: rougher metals mirror less, as a Whitted ray tracer knows no blurred
/// mirror.
/// - emission = the emissive factor, times its strength and the mean of its texture.
/// - KHR_materials_transmission: transmission = (1 - m) times the factor, tinted by c. With KHR_materials_ior, or a
///   thickness in KHR_materials_volume, it refracts by Fresnel's equations and the volume absorbs; else it is a thin
///   sheet that bends nothing.
/// - alphaMode BLEND: transmission = 1 - alpha, the mean over the texture, untinted and unbent; MASK is opaque.
/// - KHR_materials_unlit: emission = c, and nothing else; with a texture or vertex colours it is lit all the same.
/// - KHR_materials_pbrSpecularGlossiness: c, F0 and r = 1 - glossiness as they stand.
class GltfMaterials {
  public:
    GltfMaterials(Loading& loading, GltfFile& file) : loading_(loading), file_(file) {}

    /// The scene material for materials[index], converted once.
    GltfMaterial use(std::uint64_t index);
    /// A copy of the material whose diffuse colour is multiplied by colours at the vertices.
    std::uint32_t with_colors(std::uint32_t material, const glm::vec3& color, std::optional<std::uint32_t> image);

  private:
    struct Surface;

    GltfMaterial convert(const GltfValue& value);
    void read_surface(const GltfValue& value, Surface& surface);
    void read_specular_glossiness(const GltfValue& value, Surface& surface);
    void read_base_texture(const GltfValue& info, Surface& surface);
    void read_transmission(const GltfValue& value, Surface& surface, SceneMaterial& material);
    void read_emission(const GltfValue& value, SceneMaterial& material);
    void note_left_out(const GltfValue& value);
    std::optional<std::uint32_t> image_of(const GltfValue& texture_info);
    std::optional<glm::dvec4> raw_mean(const GltfValue& texture_info);
    glm::vec3 mean_of(std::uint32_t image) const;

    Loading& loading_;
    GltfFile& file_;
    std::map<std::uint64_t, GltfMaterial> used_;
};

}  // namespace raymill
