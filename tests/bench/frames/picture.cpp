#include "frames/picture.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>

namespace raymill::bench {

PictureDifference difference(std::span<const float> picture, std::span<const float> expected) {
    assert(picture.size() == expected.size() && picture.size() >= 4);
    double sum = 0, apart = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        sum += std::abs(double{expected[i]});
        apart += std::abs(double{picture[i]} - expected[i]);
    }
    const double mean = sum / static_cast<double>(picture.size());
    std::size_t off = 0;
    for (std::size_t pixel = 0; pixel < picture.size(); pixel += 4) {
        bool differs = false;
        for (std::size_t i = pixel; i < pixel + 4; ++i) {
            const double distance = std::abs(double{picture[i]} - expected[i]);
            differs |= !(distance <= 0.02 * (std::abs(double{expected[i]}) + mean));
        }
        off += differs;
    }
    PictureDifference result;
    result.mean = apart == 0 ? 0 : apart / sum;
    result.pixels = static_cast<double>(off) / static_cast<double>(picture.size() / 4);
    return result;
}

}  // namespace raymill::bench
