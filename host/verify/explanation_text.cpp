// The layout of an explanation.
#include <fmt/format.h>

#include <algorithm>

#include "verify/explanation.hpp"
#include "verify/scene_parts.hpp"
#include "wavefront/records.hpp"

namespace raymill::verify {

namespace {

std::string text(double number) {
    return fmt::format("{:.6g}", number == 0 ? 0.0 : number);
}
std::string text(const dvec3& v) {
    return fmt::format("({}, {}, {})", text(v.x), text(v.y), text(v.z));
}
std::string text(const float (&v)[3]) {
    return text(reference::to_dvec3(v));
}
std::string text(const Units& u) {
    return text(dvec3(from_units(u[0]), from_units(u[1]), from_units(u[2])));
}

Units operator+(const Units& a, const Units& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

// Levels beyond it are not moved further to the right, so that lines stay short; each ray tells its depth.
constexpr int deepest_indent = 8;

class Writer {
  public:
    Writer(const Truth& truth, const RayTree& tree) : truth_(truth), tree_(tree), slots_(light_slots(truth.scene)) {}

    /// The camera ray of a sample and all that follows from it.
    void write_sample(std::size_t root) {
        line(0, "sample {}", tree_.nodes[root].ray.sample);
        const Units sum = write_ray(root, 1, "camera ray");
        line(1, "sum of this sample: {}", text(sum));
    }

    void write_total() {
        const auto integers = [](const auto& channels) {
            return fmt::format("({}, {}, {})", channels[0], channels[1], channels[2]);
        };
        const double samples = truth_.scene.settings.spp;
        line(0, "sum of all {} contributions, in units of 2^-32  {}", tree_.contributions, integers(tree_.booked));
        line(0, "the film's pixel, in units of 2^-32  {}: {}", integers(tree_.film),
             tree_.sums_agree() ? "equal" : "NOT EQUAL");
        const Units film{tree_.film[0], tree_.film[1], tree_.film[2]};
        const dvec3 radiance(from_units(film[0]), from_units(film[1]), from_units(film[2]));
        line(0, "mean of {} sample{}: radiance {}, coverage {}", samples, samples == 1 ? "" : "s",
             text(radiance / samples), text(from_units(tree_.film[3]) / samples));
    }

    std::string take() { return std::move(out_); }

  private:
    template <class... Arguments>
    void line(int level, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        out_ += std::string(2 * static_cast<std::size_t>(std::min(level, deepest_indent)), ' ');
        out_ += fmt::format(format, std::forward<Arguments>(arguments)...);
        out_ += '\n';
    }

    Units write_ray(std::size_t index, int level, const char* kind) {
        const RayNode& node = tree_.nodes[index];
        line(level, "{}, depth {}, weight {}", kind, node.depth, text(node.ray.throughput));
        line(level + 1, "from {} along {}", text(node.ray.origin), text(node.ray.direction));
        if (node.hit.primitive == NO_INDEX) {
            line(level + 1, "ends: it hits nothing; the background adds {}", text(node.added.emission));
            return node.added.total();
        }
        const HitContext context = hit_context(truth_, node.ray, node.hit);
        write_hit(node, context, level + 1);
        const Units local = write_local(node, context, level + 1);
        return local + write_children(node, context, level + 1);
    }

    void write_hit(const RayNode& node, const HitContext& context, int level) {
        const reference::Surface& s = context.surface;
        const double side = s.inside ? -1 : 1;
        line(level, "hits {}, {}, primitive {}, at distance {}, from {}", object_name(truth_.scene, node.hit.primitive),
             material_name(truth_.scene, s.material), node.hit.primitive, text(node.hit.t),
             s.inside ? "inside" : "outside");
        line(level, "position {}, normal {}", text(s.position), text(side * s.geometric_normal));
        if (s.shading_normal != s.geometric_normal) line(level, "shading normal {}", text(side * s.shading_normal));
        const SceneMaterial& material = truth_.scene.materials[s.material];
        if (s.inside && material.absorption != glm::vec3(0))
            line(level, "absorption on the way here leaves the weight {}", text(context.throughput.value));
        const reference::Split split = truth_.tracer.split(context.ray, s);
        line(level, "weights: local {}, reflection {}, transmission {}", text(split.local), text(split.reflection),
             text(split.transmission));
    }

    Units write_local(const RayNode& node, const HitContext& context, int level) {
        line(level, "ambient adds {}", text(node.added.ambient));
        if (node.added.emission != Units{}) line(level, "emission adds {}", text(node.added.emission));
        Units sum = node.added.total();
        for (uint slot = 0; slot < slots_.size(); ++slot) {
            const auto sent = std::ranges::find(node.shadow_rays, slot, &ShadowItem::slot);
            const ShadowItem* item = sent == node.shadow_rays.end() ? nullptr : &*sent;
            write_light(node, context, slots_[slot], item, level);
            if (item) sum = sum + item->arrived.total();
        }
        return sum;
    }

    void write_light(const RayNode& node, const HitContext& context, const LightSlot& slot, const ShadowItem* item,
                     int level) {
        const SceneLight& light = truth_.scene.lights[slot.light];
        const LightTerms terms = light_terms(truth_, context, node.ray, slot);
        const std::string which =
            light.samples > 1 ? fmt::format(", its sample {} of {}", slot.sample + 1, light.samples) : "";
        line(level, "light {}, {}{}: distance {}, attenuation {}, n.l {}, {} {}", slot.light + 1, light_type(light), which,
             text(terms.sample.distance), text(terms.attenuation), text(terms.n_dot_l), highlight_name(context),
             text(terms.highlight));
        if (!item) {
            line(level + 1, "adds nothing: {}", why_no_shadow_ray(context, terms));
            return;
        }
        line(level + 1, "I_in {}", text(terms.sample.incoming));
        line(level + 1, "diffuse {}, weighted {}", text(terms.diffuse), text(item->ray.diffuse));
        line(level + 1, "specular {}, weighted {}", text(terms.specular), text(item->ray.specular));
        write_passage(*item, level + 1);
    }

    const char* highlight_name(const HitContext& context) const {
        return truth_.scene.materials[context.surface.material].highlight == Highlight::phong ? "v.r" : "n.h";
    }

    static const char* why_no_shadow_ray(const HitContext& context, const LightTerms& terms) {
        if (!context.surface.smooth && terms.geometric_n_dot_l <= 0) return "the light is behind the surface";
        if (terms.sample.incoming == dvec3(0)) return "the light does not shine here";
        if (context.local.value == dvec3(0)) return "local illumination has no weight";
        if (terms.n_dot_l <= 0) return "the light is behind the shading normal";
        return "its terms are zero";
    }

    void write_passage(const ShadowItem& item, int level) {
        const Passage passage = passage_of(truth_, item.ray);
        const bool arrived = item.arrived.total() != Units{};
        for (const Obstacle& filter : passage.filters)
            line(level, "filtered by {} at {}: times {}", object_name(truth_.scene, filter.primitive), text(filter.t),
                 text(shadow_filter(truth_.scene, filter.primitive)));
        if (passage.blocker)
            line(level, "blocked by {}, {}, at {} of {}", object_name(truth_.scene, passage.blocker->primitive),
                 material_name(truth_.scene, material_index(truth_.scene, passage.blocker->primitive)),
                 text(passage.blocker->t), text(item.ray.t_max));
        else if (passage.filters.empty())
            line(level, "visible");
        if (arrived == passage.blocker.has_value())
            line(level, "the kernel finds it {}: within rounding of an edge, or a defect; raymill verify tells",
                 arrived ? "visible" : "blocked");
        line(level, "adds diffuse {}", text(item.arrived.diffuse));
        line(level, "adds specular {}", text(item.arrived.specular));
    }

    Units write_children(const RayNode& node, const HitContext& context, int level) {
        const SceneMaterial& material = truth_.scene.materials[context.surface.material];
        if (material.reflection + material.transmission <= 0) {
            line(level, "ends: the material neither reflects nor transmits");
            return {};
        }
        if (material.transmission > 0 || material.fresnel) write_snell(context, level);
        if (node.depth == truth_.scene.settings.depth) {
            line(level, "ends: the recursion limit is {}", node.depth);
            return {};
        }
        const reference::Split split = truth_.tracer.split(context.ray, context.surface);
        const Units reflected = write_child(node.reflected, split.reflection, "reflected ray", level);
        return reflected + write_child(node.refracted, split.transmission, "refracted ray", level);
    }

    void write_snell(const HitContext& context, int level) {
        const Snell snell = snell_at(truth_, context);
        const std::string indices = fmt::format("Snell, angles in degrees: n1 {}, n2 {}, theta1 {}", text(snell.n1),
                                                text(snell.n2), text(snell.incident));
        if (snell.refracted)
            line(level, "{}, theta2 {}", indices, text(*snell.refracted));
        else
            line(level, "{}, critical {}: total reflection", indices, text(snell.critical));
    }

    Units write_child(std::optional<std::size_t> child, double share, const char* kind, int level) {
        if (child) return write_ray(*child, level, kind);
        if (share > 0)
            line(level, "{}: cut, its weight is zero or below min_weight {}", kind,
                 text(truth_.scene.settings.min_weight));
        return {};
    }

    const Truth& truth_;
    const RayTree& tree_;
    std::vector<LightSlot> slots_;
    std::string out_;
};

}  // namespace

std::string explanation_text(const Truth& truth, const RayTree& tree, std::optional<std::uint32_t> sample) {
    Writer writer(truth, tree);
    for (const std::size_t root : tree.roots)
        if (!sample || tree.nodes[root].ray.sample == *sample) writer.write_sample(root);
    writer.write_total();
    return writer.take();
}

}  // namespace raymill::verify
