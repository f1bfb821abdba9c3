#include "scene/gltf_material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/texture.hpp"

namespace raymill {
namespace {

constexpr float sharpest = 10000;  // shininess beyond which highlights are smaller than pixels

glm::vec3 vec3_or(const GltfValue& value, const std::string& key, const glm::vec3& otherwise, double most) {
    const std::optional<GltfValue> found = value.find(key);
    if (!found) return otherwise;
    const std::vector<double> v = found->numbers(3, 0, most);
    return {float(v[0]), float(v[1]), float(v[2])};
}

glm::vec4 vec4_or(const GltfValue& value, const std::string& key, const glm::vec4& otherwise) {
    const std::optional<GltfValue> found = value.find(key);
    if (!found) return otherwise;
    const std::vector<double> v = found->numbers(4, 0, 1);
    return {float(v[0]), float(v[1]), float(v[2]), float(v[3])};
}

glm::dvec2 pair_or(const GltfValue& value, const std::string& key, const glm::dvec2& otherwise) {
    const std::optional<GltfValue> found = value.find(key);
    if (!found) return otherwise;
    const std::vector<double> v = found->numbers(2);
    return {v[0], v[1]};
}

GltfTextureUse texture_use(const GltfValue& info) {
    GltfTextureUse use;
    use.uv_set = static_cast<std::uint32_t>(info.whole_or("texCoord", 0));
    const std::optional<GltfValue> transform = info.extension("KHR_texture_transform");
    if (!transform) return use;
    use.uv_set = static_cast<std::uint32_t>(transform->whole_or("texCoord", use.uv_set));
    use.offset = pair_or(*transform, "offset", use.offset);
    use.scale = pair_or(*transform, "scale", use.scale);
    use.rotation = transform->number_or("rotation", 0, -gltf_infinity, gltf_infinity);
    return use;
}

}  // namespace

/// A material of glTF with its textures averaged, between the file and the lecture's terms.
struct GltfMaterials::Surface {
    glm::vec3 color{1};   // of the factor alone
    glm::vec3 mean{1};    // with the texture's mean
    bool blends = false;  // else alpha does not count
    float alpha = 1;
    float metallic = 1;
    float roughness = 1;
    glm::vec3 f0{0.04f};
    float ior = 1.5f;
    std::optional<std::uint32_t> image;
    std::optional<GltfTextureUse> base_map;
};

glm::dvec2 GltfTextureUse::operator()(const glm::dvec2& uv) const {
    const glm::dvec2 scaled = uv * scale;
    const double c = std::cos(rotation), s = std::sin(rotation);
    return {c * scaled.x + s * scaled.y + offset.x, c * scaled.y - s * scaled.x + offset.y};
}

GltfMaterial GltfMaterials::use(std::uint64_t index) {
    const auto known = used_.find(index);
    if (known != used_.end()) return known->second;
    return used_.emplace(index, convert(file_.root().at("materials").item(index))).first->second;
}

std::uint32_t GltfMaterials::with_colors(std::uint32_t index, const glm::vec3& color,
                                         std::optional<std::uint32_t> image) {
    SceneMaterial material = loading_.scene.materials[index];
    material.diffuse *= color;
    material.ambient *= image ? mean_of(*image) : color;
    material.diffuse_map = image;
    loading_.scene.materials.push_back(std::move(material));
    return static_cast<std::uint32_t>(loading_.scene.materials.size() - 1);
}

GltfMaterial GltfMaterials::convert(const GltfValue& value) {
    Surface surface;
    surface.blends = value.text_or("alphaMode", "OPAQUE") == "BLEND";
    read_surface(value, surface);
    SceneMaterial material;
    material.name = value.text_or("name", "");
    material.diffuse = surface.color;
    material.diffuse_map = surface.image;
    material.ambient = surface.mean;
    const float r4 = surface.roughness * surface.roughness * surface.roughness * surface.roughness;
    material.highlight = Highlight::blinn;
    material.shininess = r4 * (sharpest + 2) > 2 ? 2 / r4 - 2 : sharpest;
    const glm::vec3 f0 = glm::mix(surface.f0, surface.mean, surface.metallic);
    material.specular = glm::min(f0 * ((material.shininess + 2) / 8), glm::vec3(1));
    const float smoothness = (1 - surface.roughness) * (1 - surface.roughness);
    material.reflection = surface.metallic * smoothness;
    if (material.reflection > 0) material.base_color = surface.mean;
    read_transmission(value, surface, material);
    read_emission(value, material);
    if (value.extension("KHR_materials_unlit")) {
        if (surface.image) {
            file_.leave_out("the lack of shading of unlit materials with a texture");
        } else {
            const glm::vec3 color = surface.color;
            material = SceneMaterial{};
            material.name = value.text_or("name", "");
            material.diffuse = glm::vec3(0);
            material.emission = color;
        }
    }
    note_left_out(value);
    loading_.scene.materials.push_back(std::move(material));
    return {static_cast<std::uint32_t>(loading_.scene.materials.size() - 1), surface.base_map};
}

void GltfMaterials::read_surface(const GltfValue& value, Surface& surface) {
    if (const auto glossy = value.extension("KHR_materials_pbrSpecularGlossiness"))
        return read_specular_glossiness(*glossy, surface);
    if (const auto ior = value.extension("KHR_materials_ior")) {
        const double index = ior->number_or("ior", 1.5, 0, gltf_infinity);
        if (index > 0 && index < 1) ior->at("ior").fail(fmt::format("is {}, but must be 0 or at least 1", index));
        surface.ior = index > 0 ? static_cast<float>(index) : surface.ior;
        surface.f0 = glm::vec3(static_cast<float>(std::pow((index - 1) / (index + 1), 2)));
    }
    if (const auto specular = value.extension("KHR_materials_specular")) {
        const auto factor = static_cast<float>(specular->number_or("specularFactor", 1, 0, 1));
        surface.f0 *= factor * vec3_or(*specular, "specularColorFactor", glm::vec3(1), gltf_infinity);
        surface.f0 = glm::min(surface.f0, glm::vec3(1));
    }
    if (const std::optional<GltfValue> pbr = value.find("pbrMetallicRoughness")) {
        const glm::vec4 color = vec4_or(*pbr, "baseColorFactor", glm::vec4(1));
        surface.color = surface.mean = glm::vec3(color);
        surface.alpha = color.a;
        surface.metallic = static_cast<float>(pbr->number_or("metallicFactor", 1, 0, 1));
        surface.roughness = static_cast<float>(pbr->number_or("roughnessFactor", 1, 0, 1));
        if (const auto info = pbr->find("baseColorTexture")) read_base_texture(*info, surface);
        const auto info = pbr->find("metallicRoughnessTexture");
        if (const auto mean = info ? raw_mean(*info) : std::nullopt) {
            surface.roughness *= static_cast<float>(mean->g);
            surface.metallic *= static_cast<float>(mean->b);
            file_.leave_out("how metallicRoughnessTexture varies (its mean is used)");
        }
    }
}

void GltfMaterials::read_specular_glossiness(const GltfValue& value, Surface& surface) {
    const glm::vec4 color = vec4_or(value, "diffuseFactor", glm::vec4(1));
    surface.color = surface.mean = glm::vec3(color);
    surface.alpha = color.a;
    surface.metallic = 0;
    surface.f0 = vec3_or(value, "specularFactor", glm::vec3(1), 1);
    surface.roughness = 1 - static_cast<float>(value.number_or("glossinessFactor", 1, 0, 1));
    if (const auto info = value.find("diffuseTexture")) read_base_texture(*info, surface);
    if (value.find("specularGlossinessTexture")) {
        surface.f0 = glm::vec3(0.04f);
        surface.roughness = 1;
        file_.leave_out("specularGlossinessTexture");
    }
}

void GltfMaterials::read_base_texture(const GltfValue& info, Surface& surface) {
    surface.image = image_of(info);
    if (!surface.image) return;
    surface.base_map = texture_use(info);
    surface.mean = surface.color * mean_of(*surface.image);
    const GltfValue texture = file_.referred(info.at("index"), "textures");
    if (const auto reference = texture.find("sampler")) {
        const GltfValue sampler = file_.referred(*reference, "samplers");
        constexpr std::uint64_t repeat = 10497, nearest = 9728, linear = 9729;
        if (sampler.whole_or("wrapS", repeat) != repeat || sampler.whole_or("wrapT", repeat) != repeat)
            file_.leave_out("the wrapping of textures other than by repetition");
        if (sampler.whole_or("magFilter", linear) == nearest) file_.leave_out("the nearest filter of textures");
    }
    const std::optional<glm::dvec4> raw = surface.blends ? raw_mean(info) : std::nullopt;
    if (raw && raw->a < 1) {
        surface.alpha *= static_cast<float>(raw->a);
        file_.leave_out("how the alpha of baseColorTexture varies");
    }
}

void GltfMaterials::read_transmission(const GltfValue& value, Surface& surface, SceneMaterial& material) {
    if (surface.blends && surface.alpha < 1) {
        material.transmission = (1 - material.reflection) * (1 - surface.alpha);
        material.base_color = glm::vec3(1);
        material.ior = 1;
    }
    const std::optional<GltfValue> transmission = value.extension("KHR_materials_transmission");
    if (!transmission) return;
    const auto factor = static_cast<float>(transmission->number_or("transmissionFactor", 0, 0, 1));
    if (factor == 0) return;
    material.transmission = std::min((1 - surface.metallic) * factor, 1 - material.reflection);
    material.base_color = surface.mean;
    const std::optional<GltfValue> volume = value.extension("KHR_materials_volume");
    const bool thick = volume && volume->number_or("thicknessFactor", 0, 0, gltf_infinity) > 0;
    const bool refracts = thick || value.extension("KHR_materials_ior");
    material.ior = refracts ? surface.ior : 1;
    material.fresnel = refracts;
    if (!thick || !volume->find("attenuationDistance")) return;
    const double distance = volume->at("attenuationDistance").number(0);
    if (!(distance > 0)) volume->at("attenuationDistance").fail("must be above 0");
    const glm::vec3 color = vec3_or(*volume, "attenuationColor", glm::vec3(1), 1);
    constexpr float darkest = 1e-6f;  // whose logarithm is finite
    for (int c = 0; c < 3; ++c)
        material.absorption[c] = static_cast<float>(-std::log(std::max(color[c], darkest)) / distance);
}

void GltfMaterials::read_emission(const GltfValue& value, SceneMaterial& material) {
    material.emission = vec3_or(value, "emissiveFactor", glm::vec3(0), gltf_infinity);
    if (const auto strength = value.extension("KHR_materials_emissive_strength"))
        material.emission *= static_cast<float>(strength->number_or("emissiveStrength", 1, 0, gltf_infinity));
    if (!std::isfinite(material.emission.x + material.emission.y + material.emission.z))
        value.fail("has an emission beyond 32-bit floats");
    const std::optional<GltfValue> info = value.find("emissiveTexture");
    if (!info || material.emission == glm::vec3(0)) return;
    if (const auto image = image_of(*info)) {
        material.emission *= mean_of(*image);
        file_.leave_out("how emissiveTexture varies (its mean is used)");
    }
}

void GltfMaterials::note_left_out(const GltfValue& value) {
    for (const char* key : {"normalTexture", "occlusionTexture"})
        if (value.find(key)) file_.leave_out(key);
    if (value.text_or("alphaMode", "OPAQUE") == "MASK") file_.leave_out("alphaMode MASK");
    for (const char* name : {"KHR_materials_specular", "KHR_materials_transmission", "KHR_materials_volume"})
        if (const auto extension = value.extension(name))
            for (const auto& [key, member] : extension->members())
                if (key.ends_with("Texture")) file_.leave_out(key);
}

std::optional<std::uint32_t> GltfMaterials::image_of(const GltfValue& texture_info) {
    const GltfValue texture = file_.referred(texture_info.at("index"), "textures");
    const std::optional<GltfValue> source = texture.find("source");
    if (!source) {
        file_.leave_out("textures without a source");
        return std::nullopt;
    }
    const GltfPicture picture = file_.picture(file_.referred(*source, "images"));
    if (picture.is_file) return load_texture(loading_, picture.name, {file_.path()}, true);
    return add_texture(loading_, picture.name, picture.bytes, {file_.path()});
}

std::optional<glm::dvec4> GltfMaterials::raw_mean(const GltfValue& texture_info) {
    const GltfValue texture = file_.referred(texture_info.at("index"), "textures");
    const std::optional<GltfValue> source = texture.find("source");
    if (!source) return std::nullopt;
    const GltfValue image = file_.referred(*source, "images");
    GltfPicture picture = file_.picture(image);
    if (picture.is_file) {
        std::string reason;
        std::optional<std::string> bytes = loading_.files.read(picture.name, reason);
        if (!bytes) {
            loading_.warn({file_.path()}, fmt::format("cannot read the texture \"{}\": {}", picture.name, reason));
            return std::nullopt;
        }
        picture.bytes = std::move(*bytes);
    }
    try {
        return mean_of_channels(picture.bytes);
    } catch (const std::exception& fault) {
        image.fail(fmt::format("cannot be decoded: {}", fault.what()));
    }
}

glm::vec3 GltfMaterials::mean_of(std::uint32_t image) const {
    glm::dvec3 sum(0);
    const std::vector<glm::vec3>& texels = loading_.scene.images[image].texels;
    for (const glm::vec3& texel : texels) sum += glm::dvec3(texel);
    return glm::vec3(sum / static_cast<double>(texels.size()));
}

}  // namespace raymill
