// What several scenes together say.
#include <algorithm>
#include <cmath>

#include "measure.hpp"

namespace raymill::bench {

double SceneResult::worst_difference() const {
    double worst = 0;
    for (const SetResult& set : sets)
        for (const VariantResult& variant : set.variants) worst = std::max(worst, variant.differing);
    return worst;
}

std::vector<SetSummary> summarise(const std::vector<SceneResult>& scenes) {
    std::vector<SetSummary> summaries;
    std::vector<std::vector<double>> ratios;
    for (const SceneResult& scene : scenes)
        for (const SetResult& set : scene.sets)
            for (const VariantResult& variant : set.variants) {
                if (variant.name != AUTOMATIC) continue;
                const auto found = std::ranges::find(summaries, set.name, &SetSummary::set);
                const auto place = static_cast<std::size_t>(found - summaries.begin());
                if (found == summaries.end()) {
                    summaries.push_back({set.name, 0, INFINITY, {}});
                    ratios.emplace_back();
                }
                ratios[place].push_back(variant.ratio.median);
                if (variant.ratio.median >= summaries[place].worst) continue;
                summaries[place].worst = variant.ratio.median;
                summaries[place].worst_scene = scene.name;
            }
    for (std::size_t i = 0; i < summaries.size(); ++i) summaries[i].geometric_mean = geometric_mean(ratios[i]);
    return summaries;
}

}  // namespace raymill::bench
