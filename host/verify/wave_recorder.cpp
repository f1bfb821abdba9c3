#include "verify/wave_recorder.hpp"

#include <fmt/format.h>

#include <cstring>

namespace raymill::verify {

namespace {

/// The replay of a shadow ray must be the ray itself but for the fields that were renamed.
bool same_but_renamed(ShadowRay replayed, const ShadowRay& ray) {
    replayed.pixel = ray.pixel;
    replayed.route = ray.route;
    return std::memcmp(&replayed, &ray, sizeof ray) == 0;
}

void add(Contribution& sum, const Contribution& more) {
    for (std::size_t c = 0; c < 3; ++c) {
        sum.ambient[c] += more.ambient[c];
        sum.emission[c] += more.emission[c];
        sum.diffuse[c] += more.diffuse[c];
        sum.specular[c] += more.specular[c];
    }
    sum.coverage += more.coverage;
}

}  // namespace

WaveRecorder::WaveRecorder(const Device& device, Renderer& renderer, Receiver receiver)
    : WaveRecorder(device, renderer.stages(), renderer.device_scene(), std::move(receiver)) {
    renderer_ = &renderer;
    renderer.observe([this](const char* stage, const WaveView& view) { see(stage, view); });
}

WaveRecorder::WaveRecorder(const Device& device, Stages& stages, const DeviceScene& scene, Receiver receiver)
    : device_(device), replay_(device, stages, scene), receiver_(std::move(receiver)) {}

WaveRecorder::~WaveRecorder() {
    if (renderer_) renderer_->observe({});
}

void WaveRecorder::finish() {
    if (wave_) receiver_(*wave_);
    wave_.reset();
}

void WaveRecorder::see(const std::string& stage, const WaveView& view) {
    if (stage == "generate") {
        begin(view);
        wave_->generated = true;
    } else if (stage == "intersect") {
        const bool fresh = wave_ && wave_->generated && wave_->hits.empty();
        if (!fresh) begin(view);
        take_hits(view);
    } else if (stage == "shade") {
        take_shadow_rays(view);
    } else if (stage == "secondary") {
        wave_->children = view.children->items.read(device_, view.children->first, view.children->count);
    }
}

void WaveRecorder::begin(const WaveView& view) {
    finish();
    wave_.emplace();
    wave_->depth = view.batch.depth;
    wave_->rays = view.rays.items.read(device_, view.rays.first, view.rays.count);
}

void WaveRecorder::take_hits(const WaveView& view) {
    wave_->hits = view.hits.read(device_, 0, view.rays.count);
    wave_->added_by_intersect = replay_.intersect(wave_->rays);
    wave_->added = wave_->added_by_intersect;
}

void WaveRecorder::take_shadow_rays(const WaveView& view) {
    const std::size_t segments = std::size_t{Stages::chunks(view.rays.count)} * view.slots.count;
    const auto rays = view.shadow_rays.rays.read(device_, 0, segments * CHUNK);
    const auto counts = view.shadow_rays.counts.read(device_, 0, segments);
    ShadeReplay replay = replay_.shade(wave_->rays, wave_->hits, view.slots);
    const std::vector<Contribution> arrived = replay_.shadow(rays, counts);
    for (std::size_t i = 0; i < replay.added.size(); ++i) {
        if (wave_->rays[i].route != ROUTE_CAMERA) replay.added[i].coverage = 0;  // replayed as a camera ray
        add(wave_->added[i], replay.added[i]);
    }
    for (std::size_t segment = 0; segment < segments; ++segment) {
        if (replay.counts[segment] != counts[segment]) {
            wave_->replay_faults.push_back(fmt::format("shade pushed {} rays into segment {}, and {} when repeated",
                                                       counts[segment], segment, replay.counts[segment]));
            continue;
        }
        const uint slot = view.slots.first + static_cast<uint>(segment % view.slots.count);
        for (std::size_t place = segment * CHUNK; place < segment * CHUNK + counts[segment]; ++place) {
            const uint hit = replay.rays[place].pixel;
            if (hit >= wave_->rays.size() || !same_but_renamed(replay.rays[place], rays[place]))
                wave_->replay_faults.push_back(fmt::format("shadow ray {} differs when shade is repeated", place));
            else
                wave_->shadow_rays.push_back({rays[place], hit, slot, arrived[place]});
        }
    }
}

}  // namespace raymill::verify
