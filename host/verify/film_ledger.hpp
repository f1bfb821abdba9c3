// What the film must hold: the sum of what every item of every queue adds, to the last integer.
#pragma once

#include "verify/report.hpp"
#include "verify/wave_recorder.hpp"

namespace raymill::verify {

/// Planes that a frame must keep so that a ledger can be compared with it in full.
FilmPlanes ledger_planes();

class FilmLedger {
  public:
    explicit FilmLedger(std::size_t pixels);

    /// Books all items of a wave.
    void add(const Wave& wave);
    /// Every pixel of the beauty and of the six planes of light, which `frame` must keep.
    void compare(const Frame& frame, StageReport& report) const;
    /// R, G, B, coverage of the beauty.
    std::array<std::int64_t, FILM_CHANNELS> beauty(std::size_t pixel) const;

  private:
    void book(int term, uint route, uint pixel, const Units& units);
    std::int64_t& sum(int plane, std::size_t pixel, int channel);

    std::size_t pixels_;
    std::vector<std::int64_t> sums_;
};

}  // namespace raymill::verify
