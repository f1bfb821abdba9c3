#include "verify/verifier.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <map>
#include <tuple>

#include "lib/random.h"
#include "verify/compare.hpp"
#include "wavefront/records.hpp"

namespace raymill::verify {

namespace {

/// One of each `stride` items, at a place that is random but the same in every run.
class Subset {
  public:
    Subset(std::uint64_t items, std::uint64_t primitives, std::uint64_t budget)
        : stride_(std::max<std::uint64_t>(1, (items * primitives + budget - 1) / std::max<std::uint64_t>(budget, 1))) {}

    /// Whether the next item is one of it.
    bool next() {
        const std::uint64_t block = seen_ / stride_, place = seen_ % stride_;
        ++seen_;
        return place == hash4(static_cast<uint>(block), static_cast<uint>(block >> 32), 0x5eed, 0) % stride_;
    }

  private:
    std::uint64_t stride_;
    std::uint64_t seen_ = 0;
};

/// Which child of which hit a queue's ray is.
using ChildKey = std::tuple<uint, uint, uint>;  // pixel, sample, path
ChildKey key_of(const Ray& ray) {
    return {ray.pixel, ray.sample, ray.path};
}

class Verifier {
  public:
    Verifier(const Scene& scene, const RayCounts& counts, const VerifyOptions& options)
        : scene_(scene),
          tracer_(scene),
          truth_{scene, tracer_},
          slots_(light_slots(scene)),
          hits_(counts.camera + counts.secondary, scene.primitive_count(), options.primitive_tests),
          arrivals_(counts.shadow, scene.primitive_count(), options.primitive_tests),
          ledger_(film_pixels(scene)),
          seen_(film_pixels(scene) * static_cast<std::size_t>(scene.settings.spp), 0) {}

    void take(const Wave& wave) {
        if (wave.generated) take_camera_rays(wave);
        take_hits(wave);
        take_shading(wave, {0, static_cast<uint>(slots_.size())});
        take_arrivals(wave);
        if (spawns_secondary_rays(scene_) && wave.depth < scene_.settings.depth) take_children(wave);
        ledger_.add(wave);
        for (const std::string& fault : wave.replay_faults) shade_.fail(fault);
    }

    /// The items of one stage alone.
    const StageReport& take_stage(const Wave& wave, profile::Stage stage, SlotRange slots) {
        switch (stage) {
            case profile::Stage::generate:
                take_camera_rays(wave);
                return generate_;
            case profile::Stage::intersect:
                take_hits(wave);
                return intersect_;
            case profile::Stage::shade:
                take_shading(wave, slots);
                for (const std::string& fault : wave.replay_faults) shade_.fail(fault);
                return shade_;
            case profile::Stage::shadow:
                take_arrivals(wave);
                return shadow_;
            default:
                take_children(wave);
                return secondary_;
        }
    }

    std::vector<StageReport> finish(const Frame& frame) {
        std::uint64_t wrong = 0;
        for (const unsigned char times : seen_) wrong += times != 1;
        if (wrong > 0) generate_.fail(fmt::format("{} camera samples did not come exactly once", wrong));
        ledger_.compare(frame, film_);
        return {generate_, intersect_, shade_, shadow_, secondary_, film_};
    }

  private:
    /// Compares items in parallel and reports them in order. compare(i) must not touch the verifier's state.
    template <class Compare, class Describe>
    void each(StageReport& report, std::size_t count, const Compare& compare, const Describe& describe) {
        std::vector<Comparison> results(count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { results[i] = compare(i); });
        for (std::size_t i = 0; i < count; ++i) report.add(results[i], [&] { return describe(i); });
    }

    void take_camera_rays(const Wave& wave) {
        const auto spp = static_cast<std::size_t>(scene_.settings.spp);
        generate_.count(wave.rays.size());
        for (const Ray& ray : wave.rays) {
            const std::size_t place = ray.pixel * spp + ray.sample;
            if (place < seen_.size() && ray.sample < spp && seen_[place] < 2) ++seen_[place];
        }
        each(
            generate_, wave.rays.size(), [&](std::size_t i) { return compare_camera_ray(truth_, wave.rays[i]); },
            [&](std::size_t i) { return describe(wave.rays[i]); });
    }

    void take_hits(const Wave& wave) {
        intersect_.count(wave.rays.size());
        std::vector<std::size_t> chosen;
        for (std::size_t i = 0; i < wave.rays.size(); ++i)
            if (hits_.next()) chosen.push_back(i);
        each(
            intersect_, chosen.size(),
            [&](std::size_t i) {
                const std::size_t item = chosen[i];
                return compare_hit(truth_, wave.rays[item], wave.hits[item], wave.added_by_intersect[item]);
            },
            [&](std::size_t i) { return describe(wave.rays[chosen[i]]) + describe(wave.hits[chosen[i]]); });
    }

    /// Items are each hit's ambient, emission and coverage, where the range has the first light sample, and its light
    /// samples.
    void take_shading(const Wave& wave, SlotRange range) {
        std::vector<std::size_t> hits;
        for (std::size_t i = 0; i < wave.hits.size(); ++i)
            if (wave.hits[i].primitive != NO_INDEX) hits.push_back(i);
        std::vector<const ShadowItem*> sent(wave.hits.size() * slots_.size(), nullptr);
        for (const ShadowItem& item : wave.shadow_rays) {
            const ShadowItem*& place = sent[item.hit * slots_.size() + item.slot];
            if (place || wave.hits[item.hit].primitive == NO_INDEX)
                shade_.fail(fmt::format("hit {} sends two shadow rays to light sample {}, or sends one from nowhere",
                                        item.hit, item.slot));
            place = &item;
        }
        const std::size_t unshadowed = range.first == 0 ? 1 : 0;
        const std::size_t parts = unshadowed + range.count;
        shade_.count(hits.size() * parts);
        std::vector<Comparison> results(hits.size() * parts);
        tbb::parallel_for(std::size_t{0}, hits.size(), [&](std::size_t i) {
            const std::size_t item = hits[i];
            const HitContext context = hit_context(truth_, wave.rays[item], wave.hits[item]);
            if (unshadowed) results[i * parts] = compare_unshadowed(truth_, context, wave.rays[item], wave.added[item]);
            for (std::size_t k = 0; k < range.count; ++k) {
                const std::size_t slot = range.first + k;
                const ShadowItem* shadow = sent[item * slots_.size() + slot];
                results[i * parts + unshadowed + k] =
                    compare_shadow_ray(truth_, context, wave.rays[item], slots_[slot], shadow ? &shadow->ray : nullptr);
            }
        });
        for (std::size_t i = 0; i < results.size(); ++i) {
            const std::size_t item = hits[i / parts], part = i % parts;
            shade_.add(results[i], [&] {
                const std::string hit = describe(wave.rays[item]) + describe(wave.hits[item]);
                if (part < unshadowed) return hit + "  ambient, emission and coverage\n";
                const std::size_t slot = range.first + part - unshadowed;
                const ShadowItem* shadow = sent[item * slots_.size() + slot];
                return hit + (shadow ? describe(shadow->ray) : "") +
                       fmt::format("  light {}, its sample {}\n", slots_[slot].light, slots_[slot].sample);
            });
        }
    }

    void take_arrivals(const Wave& wave) {
        shadow_.count(wave.shadow_rays.size());
        std::vector<const ShadowItem*> chosen;
        for (const ShadowItem& item : wave.shadow_rays)
            if (arrivals_.next()) chosen.push_back(&item);
        each(
            shadow_, chosen.size(), [&](std::size_t i) { return compare_arrival(truth_, *chosen[i]); },
            [&](std::size_t i) { return describe(chosen[i]->ray); });
    }

    /// Items are the two branches of every hit, with a child or without.
    void take_children(const Wave& wave) {
        std::map<ChildKey, const Ray*> children;
        for (const Ray& child : wave.children)
            if (!children.emplace(key_of(child), &child).second)
                secondary_.fail("two children have the same pixel, sample and path:\n" + describe(child));
        struct Item {
            std::size_t hit;
            uint branch;
            const Ray* child;
        };
        std::vector<Item> items;
        for (std::size_t i = 0; i < wave.hits.size(); ++i) {
            if (wave.hits[i].primitive == NO_INDEX) continue;
            const Ray& parent = wave.rays[i];
            for (uint branch = 0; branch < 2; ++branch) {
                const auto child = children.extract({parent.pixel, parent.sample, path_child(parent.path, branch)});
                items.push_back({i, branch, child.empty() ? nullptr : child.mapped()});
            }
        }
        if (!children.empty())
            secondary_.fail(fmt::format("{} children belong to no hit; one of them:\n{}", children.size(),
                                        describe(*children.begin()->second)));
        secondary_.count(items.size());
        each(
            secondary_, items.size(),
            [&](std::size_t i) {
                const Ray& parent = wave.rays[items[i].hit];
                const HitContext context = hit_context(truth_, parent, wave.hits[items[i].hit]);
                return compare_child(truth_, context, parent, items[i].branch, items[i].child);
            },
            [&](std::size_t i) {
                return describe(wave.rays[items[i].hit]) + describe(wave.hits[items[i].hit]) +
                       (items[i].child ? "  child\n" + describe(*items[i].child) : std::string());
            });
    }

    const Scene& scene_;
    reference::Tracer tracer_;
    Truth truth_;
    std::vector<LightSlot> slots_;
    Subset hits_, arrivals_;
    FilmLedger ledger_;
    std::vector<unsigned char> seen_;  // how often each camera sample came, up to 2
    StageReport generate_{"generate"}, intersect_{"intersect"}, shade_{"shade"}, shadow_{"shadow"},
        secondary_{"secondary"}, film_{"film"};
};

}  // namespace

StageReport verify_stage(const Scene& scene, const Wave& wave, profile::Stage stage, SlotRange slots,
                         const VerifyOptions& options) {
    RayCounts counts;
    counts.camera = wave.rays.size();
    counts.shadow = wave.shadow_rays.size();
    return Verifier(scene, counts, options).take_stage(wave, stage, slots);
}

std::vector<StageReport> verify_frame(const Device& device, const Scene& scene, Renderer& renderer,
                                      const VerifyOptions& options) {
    const RayCounts counts = renderer.render().rays;
    Verifier verifier(scene, counts, options);
    WaveRecorder recorder(device, renderer, [&](const Wave& wave) { verifier.take(wave); });
    const Frame frame = renderer.render();
    recorder.finish();
    return verifier.finish(frame);
}

}  // namespace raymill::verify
