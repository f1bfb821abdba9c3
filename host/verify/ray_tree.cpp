#include "verify/ray_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "lib/random.h"
#include "verify/film_ledger.hpp"

namespace raymill::verify {

namespace {

/// Grows the tree wave by wave. A child names its parent by its path, which is a function of the parent's.
class TreeBuilder {
  public:
    void add(const Wave& wave) {
        const std::size_t first = tree_.nodes.size();
        for (std::size_t i = 0; i < wave.rays.size(); ++i) {
            link(wave, wave.rays[i]);
            tree_.nodes.push_back({wave.rays[i], wave.hits[i], wave.depth, wave.added[i], {}, {}, {}});
            tree_.contributions += wave.added[i].total() != Units{};
        }
        for (const ShadowItem& item : wave.shadow_rays) {
            tree_.nodes[first + item.hit].shadow_rays.push_back(item);
            tree_.contributions += item.arrived.total() != Units{};
        }
        for (std::size_t i = first; i < tree_.nodes.size(); ++i) {
            const Ray& ray = tree_.nodes[i].ray;
            for (uint branch = 0; branch < 2; ++branch)
                expected_[{ray.sample, path_child(ray.path, branch)}] = {i, branch};
        }
        ledger_.add(wave);
    }

    RayTree finish(const Frame& frame) {
        const auto by_sample = [&](std::size_t a, std::size_t b) {
            return tree_.nodes[a].ray.sample < tree_.nodes[b].ray.sample;
        };
        std::ranges::sort(tree_.roots, by_sample);
        const auto by_slot = [](const ShadowItem& a, const ShadowItem& b) { return a.slot < b.slot; };
        for (RayNode& node : tree_.nodes) std::ranges::sort(node.shadow_rays, by_slot);
        tree_.booked = ledger_.beauty(0);
        std::ranges::copy(frame.plane(FILM_BEAUTY), tree_.film.begin());
        return std::move(tree_);
    }

  private:
    void link(const Wave& wave, const Ray& ray) {
        const std::size_t index = tree_.nodes.size();
        if (wave.generated) {
            tree_.roots.push_back(index);
            return;
        }
        const auto parent = expected_.find({ray.sample, ray.path});
        if (parent == expected_.end())
            throw DeviceError(
                fmt::format("a ray of depth {} with path {:08x} descends from no hit", wave.depth, ray.path));
        const auto [node, branch] = parent->second;
        (branch == 0 ? tree_.nodes[node].reflected : tree_.nodes[node].refracted) = index;
    }

    RayTree tree_;
    FilmLedger ledger_{1};
    std::map<std::pair<uint, uint>, std::pair<std::size_t, uint>> expected_;  // sample and path to parent and branch
};

}  // namespace

void crop_to_pixel(RenderSettings& settings, int x, int y) {
    // Half a pixel off the borders, so that no rounding of the fractions can move the window.
    settings.crop = {(x - 0.5) / settings.width, (x + 0.5) / settings.width, (y - 0.5) / settings.height,
                     (y + 0.5) / settings.height};
}

RayTree trace_pixel(const Device& device, Renderer& renderer) {
    TreeBuilder builder;
    WaveRecorder recorder(device, renderer, [&](const Wave& wave) { builder.add(wave); });
    const Frame frame = renderer.render();
    recorder.finish();
    return builder.finish(frame);
}

}  // namespace raymill::verify
