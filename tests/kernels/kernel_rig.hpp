// Runs one kernel at a time on queues that a test fills, and hands back all that it wrote.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bvh/bvh.hpp"
#include "scene/scene.hpp"
#include "wavefront/film_planes.hpp"
#include "wavefront/stages.hpp"

namespace raymill::test {

/// Every buffer that a kernel writes is longer than its capacity by this many items, and all of it filled with
/// UNTOUCHED bytes before; what comes back includes them.
inline constexpr std::size_t GUARD_ITEMS = 130;
inline constexpr unsigned char UNTOUCHED = 0xa5;

template <class T>
bool is_untouched(const T& item) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &item, sizeof(T));
    for (const unsigned char byte : bytes)
        if (byte != UNTOUCHED) return false;
    return true;
}

/// The number of items from `first` on that were written.
template <class T>
std::size_t touched_from(const std::vector<T>& items, std::size_t first) {
    std::size_t touched = 0;
    for (std::size_t i = first; i < items.size(); ++i) touched += !is_untouched(items[i]);
    return touched;
}

template <class T>
bool same_bits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// The film, cleared before the kernel ran. It has as many pixels as the queue's items name, and guards of zero.
struct FilmState {
    std::vector<std::int64_t> sums;
    Counters counters{};

    std::int64_t at(uint pixel, int channel) const { return sums[std::size_t{pixel} * FILM_CHANNELS + channel]; }
};

struct IntersectResult {
    std::vector<Hit> hits;
    FilmState film;
};

struct ShadeResult {
    std::vector<ShadowRay> rays;  // CHUNK a segment
    std::vector<uint> counts;
    FilmState film;
};

struct SecondaryResult {
    std::vector<Ray> children;
    FilmState film;
};

/// A scene on the device. Kernels are those embedded in the program, or of the folder that the environment variable
/// RAYMILL_TEST_KERNELS names, so that a change may be tried without building.
class KernelRig {
  public:
    explicit KernelRig(const Scene& scene);
    KernelRig(const Scene& scene, const Bvh& bvh);
    /// With planes beside the beauty. The film has all of them, each of the scene's whole image.
    KernelRig(const Scene& scene, const FilmPlanes& planes);
    ~KernelRig();

    /// How kernels trace from now on; before, as suits the device. With a folder, those in it.
    void use(Traversal traversal, const std::string& folder = "");

    std::vector<Ray> generate(std::uint64_t first_sample, uint count) const;
    /// Rays [first, end) of the queue, in so many launches of all. pixels_once: no two of them share a pixel.
    IntersectResult intersect(std::span<const Ray> rays, uint first = 0, bool pixels_once = false,
                              int launches = 1) const;
    /// hits[i] belongs to rays[first + i].
    ShadeResult shade(std::span<const Ray> rays, std::span<const Hit> hits, uint first_slot, uint slot_count,
                      uint first = 0, bool pixels_once = false) const;
    /// hits[i] belongs to rays[first + i].
    FilmState features(std::span<const Ray> rays, std::span<const Hit> hits, uint depth, uint first = 0) const;
    /// rays: CHUNK for each of the counts. pixels_once: no two of them share a pixel.
    FilmState shadow(std::span<const ShadowRay> rays, std::span<const uint> counts, bool pixels_once = false) const;
    SecondaryResult secondary(std::span<const Ray> rays, std::span<const Hit> hits, uint capacity,
                              uint first = 0) const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

/// resolve over sums, without a scene.
std::vector<float> resolve_on_device(std::span<const std::int64_t> sums, uint spp);

/// Runs kernel `name` of tests/kernels/`file` over `items` work-items: inputs are read-only words, then the number of
/// items, then `selector`, then the output of `output_words` words.
std::vector<uint> run_probe(const std::string& file, const char* name, const std::vector<std::vector<uint>>& inputs,
                            uint items, uint selector, std::size_t output_words);

}  // namespace raymill::test
