#include "verify/item_replay.hpp"

namespace raymill::verify {

Units Contribution::total() const {
    Units sum{};
    for (int c = 0; c < 3; ++c) sum[c] = ambient[c] + diffuse[c] + specular[c] + emission[c];
    return sum;
}

ItemReplay::ItemReplay(const Device& device, Stages& stages, const DeviceScene& scene)
    : device_(device), stages_(stages), scene_(scene) {
    for (const int plane : {FILM_AMBIENT, FILM_DIFFUSE, FILM_SPECULAR, FILM_EMISSION}) planes_.keep(plane);
}

Buffer<Ray> ItemReplay::renamed(std::span<const Ray> rays) const {
    std::vector<Ray> copies(rays.begin(), rays.end());
    for (std::size_t i = 0; i < copies.size(); ++i) {
        copies[i].pixel = static_cast<uint>(i);
        copies[i].route = ROUTE_CAMERA;  // so that the terms go to planes of their own
    }
    return Buffer<Ray>(device_, std::span<const Ray>(copies));
}

DeviceScene ItemReplay::scene_for(std::size_t items) const {
    DeviceScene scene = scene_;  // shares all memory but the constants
    SceneConstants constants = scene_.constants.read_one(device_);
    constants.film_pixels = static_cast<uint>(items);
    for (int plane = 0; plane < FILM_PLANES; ++plane)
        constants.plane[plane] = planes_.keeps(plane) ? planes_.index(plane) : 0;
    scene.constants = Buffer<SceneConstants>(device_, std::span<const SceneConstants>(&constants, 1));
    return scene;
}

Film ItemReplay::film_for(std::size_t items) const {
    Film film{{device_, items * FILM_CHANNELS * planes_.count()}, {device_, 1}};
    if (items > 0) film.sums.clear(device_);
    film.counters.clear(device_);
    return film;
}

std::vector<Contribution> ItemReplay::read(const Film& film, std::size_t items) const {
    const std::vector<cl_long> sums = film.sums.read(device_);
    std::vector<Contribution> added(items);
    const auto take = [&](int plane, std::size_t item, Units& units) {
        const std::size_t first = (planes_.index(plane) * items + item) * FILM_CHANNELS;
        for (std::size_t c = 0; c < 3; ++c) units[c] = sums[first + c];
    };
    for (std::size_t i = 0; i < items; ++i) {
        take(FILM_AMBIENT, i, added[i].ambient);
        take(FILM_DIFFUSE, i, added[i].diffuse);
        take(FILM_SPECULAR, i, added[i].specular);
        take(FILM_EMISSION, i, added[i].emission);
        added[i].coverage = sums[i * FILM_CHANNELS + 3];
    }
    return added;
}

std::vector<Contribution> ItemReplay::intersect(std::span<const Ray> rays) {
    const uint count = static_cast<uint>(rays.size());
    const Buffer<Ray> queue = renamed(rays);
    Buffer<Hit> hits(device_, rays.size());
    Film film = film_for(rays.size());
    stages_.intersect(scene_for(rays.size()), {queue, 0, count}, hits, film);
    return read(film, rays.size());
}

ShadeReplay ItemReplay::shade(std::span<const Ray> rays, std::span<const Hit> hits, SlotRange slots) {
    const uint count = static_cast<uint>(rays.size());
    const Buffer<Ray> queue = renamed(rays);
    const Buffer<Hit> hit_queue(device_, hits);
    const std::size_t segments = std::size_t{Stages::chunks(count)} * slots.count;
    ShadowQueue shadow{{device_, segments * CHUNK}, {device_, segments}};
    Film film = film_for(rays.size());
    stages_.shade(scene_for(rays.size()), {queue, 0, count}, hit_queue, slots, shadow, film);
    return {read(film, rays.size()), shadow.rays.read(device_), shadow.counts.read(device_)};
}

std::vector<Contribution> ItemReplay::shadow(std::span<const ShadowRay> rays, std::span<const uint> counts) {
    std::vector<ShadowRay> copies(rays.begin(), rays.end());
    for (std::size_t i = 0; i < copies.size(); ++i) {
        copies[i].pixel = static_cast<uint>(i);
        copies[i].route = ROUTE_CAMERA;
    }
    const ShadowQueue queue{{device_, std::span<const ShadowRay>(copies)}, {device_, counts}};
    Film film = film_for(copies.size());
    stages_.shadow(scene_for(copies.size()), queue, static_cast<uint>(counts.size()), film);
    return read(film, copies.size());
}

}  // namespace raymill::verify
