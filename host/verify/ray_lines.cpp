// The rays of a pixel as an OBJ file that any modeller draws. Source: Wavefront OBJ, appendix B1, "v" and "l".
#include <fmt/format.h>

#include "verify/explanation.hpp"
#include "verify/scene_parts.hpp"

namespace raymill::verify {

namespace {

class LineWriter {
  public:
    LineWriter(const Truth& truth, const RayTree& tree, double escape) : truth_(truth), tree_(tree), escape_(escape) {}

    void write_ray(std::size_t index, const std::string& branch) {
        const RayNode& node = tree_.nodes[index];
        const bool hits = node.hit.primitive != NO_INDEX;
        const std::string end = hits ? object_name(truth_.scene, node.hit.primitive) : "nothing";
        segment(fmt::format("sample {}, {} ray, depth {}, hits {}", node.ray.sample, branch, node.depth, end),
                reference_ray(node.ray), hits ? double{node.hit.t} : escape_);
        for (const ShadowItem& item : node.shadow_rays) write_shadow_ray(node, item);
        if (node.reflected) write_ray(*node.reflected, branch + " > reflected");
        if (node.refracted) write_ray(*node.refracted, branch + " > refracted");
    }

    std::string take() { return std::move(out_); }

  private:
    void write_shadow_ray(const RayNode& node, const ShadowItem& item) {
        const Passage passage = passage_of(truth_, item.ray);
        const double length = passage.blocker ? passage.blocker->t : std::min(double{item.ray.t_max}, escape_);
        segment(fmt::format("sample {}, shadow ray to light {}, {}", node.ray.sample, item.ray.light + 1,
                            passage.blocker ? "blocked by " + object_name(truth_.scene, passage.blocker->primitive)
                                            : "visible"),
                reference_ray(item.ray), length);
    }

    void segment(const std::string& comment, const reference::Ray& ray, double length) {
        const dvec3 end = ray.origin + length * ray.direction;
        out_ += fmt::format("# {}\nv {:.9g} {:.9g} {:.9g}\nv {:.9g} {:.9g} {:.9g}\nl -2 -1\n", comment, ray.origin.x,
                            ray.origin.y, ray.origin.z, end.x, end.y, end.z);
    }

    const Truth& truth_;
    const RayTree& tree_;
    double escape_;
    std::string out_;
};

}  // namespace

std::string ray_lines(const Truth& truth, const RayTree& tree, std::optional<std::uint32_t> sample, double escape) {
    LineWriter writer(truth, tree, escape);
    for (const std::size_t root : tree.roots)
        if (!sample || tree.nodes[root].ray.sample == *sample) writer.write_ray(root, "camera");
    return writer.take();
}

}  // namespace raymill::verify
