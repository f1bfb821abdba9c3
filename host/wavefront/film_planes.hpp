// Which planes a film keeps beside the beauty.
#pragma once

#include <bitset>

#include "layout.h"

namespace raymill {

class FilmPlanes {
  public:
    void keep(int plane) { kept_.set(static_cast<std::size_t>(plane)); }
    /// The six planes whose sum is the beauty.
    void keep_light() {
        for (int plane = FILM_AMBIENT; plane <= FILM_REFRACTION; ++plane) keep(plane);
    }
    bool keeps(int plane) const { return plane == FILM_BEAUTY || kept_.test(static_cast<std::size_t>(plane)); }
    bool any_feature() const {
        return keeps(FILM_ALBEDO) || keeps(FILM_NORMAL) || keeps(FILM_POSITION) || keeps(FILM_IDS);
    }
    /// Planes in all.
    uint count() const { return index(FILM_PLANES); }
    /// Where a plane lies in the film: the number of kept planes before it.
    uint index(int plane) const {
        uint before = 0;
        for (int p = 0; p < plane; ++p) before += keeps(p);
        return before;
    }

  private:
    std::bitset<FILM_PLANES> kept_;
};

}  // namespace raymill
