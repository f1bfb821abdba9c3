#include "verify/film_ledger.hpp"

#include <fmt/format.h>

namespace raymill::verify {

namespace {

constexpr int planes = FILM_REFRACTION + 1;
constexpr const char* plane_names[planes] = {"beauty",   "ambient",    "diffuse",   "specular",
                                             "emission", "reflection", "refraction"};

}  // namespace

FilmPlanes ledger_planes() {
    FilmPlanes kept;
    kept.keep_light();
    return kept;
}

FilmLedger::FilmLedger(std::size_t pixels) : pixels_(pixels), sums_(pixels * planes * FILM_CHANNELS, 0) {}

std::int64_t& FilmLedger::sum(int plane, std::size_t pixel, int channel) {
    return sums_[(static_cast<std::size_t>(plane) * pixels_ + pixel) * FILM_CHANNELS +
                 static_cast<std::size_t>(channel)];
}

void FilmLedger::book(int term, uint route, uint pixel, const Units& units) {
    const int plane = route == ROUTE_CAMERA ? term : route == ROUTE_REFLECTED ? FILM_REFLECTION : FILM_REFRACTION;
    for (int c = 0; c < 3; ++c) {
        sum(FILM_BEAUTY, pixel, c) += units[static_cast<std::size_t>(c)];
        sum(plane, pixel, c) += units[static_cast<std::size_t>(c)];
    }
}

void FilmLedger::add(const Wave& wave) {
    for (std::size_t i = 0; i < wave.rays.size(); ++i) {
        const Ray& ray = wave.rays[i];
        if (ray.pixel >= pixels_) continue;  // compare() finds the pixel that it should have been
        book(FILM_AMBIENT, ray.route, ray.pixel, wave.added[i].ambient);
        book(FILM_EMISSION, ray.route, ray.pixel, wave.added[i].emission);
        sum(FILM_BEAUTY, ray.pixel, 3) += wave.added[i].coverage;
    }
    for (const ShadowItem& item : wave.shadow_rays) {
        if (item.ray.pixel >= pixels_) continue;
        book(FILM_DIFFUSE, item.ray.route, item.ray.pixel, item.arrived.diffuse);
        book(FILM_SPECULAR, item.ray.route, item.ray.pixel, item.arrived.specular);
    }
}

std::array<std::int64_t, FILM_CHANNELS> FilmLedger::beauty(std::size_t pixel) const {
    std::array<std::int64_t, FILM_CHANNELS> channels{};
    for (std::size_t c = 0; c < FILM_CHANNELS; ++c) channels[c] = sums_[pixel * FILM_CHANNELS + c];
    return channels;
}

void FilmLedger::compare(const Frame& frame, StageReport& report) const {
    report.count(pixels_);
    for (std::size_t pixel = 0; pixel < pixels_; ++pixel) {
        Comparison c;
        for (int plane = 0; plane < planes; ++plane) {
            const std::span<const cl_long> sums = frame.plane(plane);
            for (std::size_t channel = 0; channel < (plane == FILM_BEAUTY ? 4 : 3); ++channel) {
                const std::int64_t booked =
                    sums_[(static_cast<std::size_t>(plane) * pixels_ + pixel) * FILM_CHANNELS + channel];
                const std::int64_t held = sums[pixel * FILM_CHANNELS + channel];
                // Integers of 64 bits: compared as such, and shown by their difference.
                if (booked != held)
                    c.number(fmt::format("{}[{}]", plane_names[plane], channel), static_cast<double>(held - booked), 0,
                             0);
            }
        }
        report.add(c, [&] { return fmt::format("  pixel {}, in units of 2^-32 too much:\n", pixel); });
    }
}

}  // namespace raymill::verify
