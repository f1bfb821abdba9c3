#include "cli/aov.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <sstream>

#include "common/error.hpp"

namespace raymill {

namespace {

/// What a plane's sums are divided by.
enum class Mean {
    samples,  // camera samples: premultiplied, as denoisers and compositors expect
    hits,     // camera samples that hit something: positions must not be mixed with nothing
    count,    // the plane's own fourth channel
    none      // plain integers
};

struct Aov {
    const char* name;
    int plane;
    int first_channel;
    std::vector<std::string> channels;
    Mean mean;
};

const std::vector<Aov>& known_aovs() {
    static const std::vector<Aov> aovs = [] {
        const auto rgb = [](const char* name, int plane, Mean mean = Mean::samples) {
            const std::string prefix = std::string(name) + ".";
            return Aov{name, plane, 0, {prefix + "R", prefix + "G", prefix + "B"}, mean};
        };
        return std::vector<Aov>{rgb("ambient", FILM_AMBIENT),
                                rgb("diffuse", FILM_DIFFUSE),
                                rgb("specular", FILM_SPECULAR),
                                rgb("reflection", FILM_REFLECTION),
                                rgb("refraction", FILM_REFRACTION),
                                rgb("emission", FILM_EMISSION),
                                rgb("shadow", FILM_SHADOW, Mean::count),
                                rgb("albedo", FILM_ALBEDO),
                                {"N", FILM_NORMAL, 0, {"N.X", "N.Y", "N.Z"}, Mean::samples},
                                {"Z", FILM_POSITION, 3, {"Z"}, Mean::hits},
                                {"P", FILM_POSITION, 0, {"P.X", "P.Y", "P.Z"}, Mean::hits},
                                {"id", FILM_IDS, 0, {"id.object", "id.material"}, Mean::none},
                                {"depth", FILM_IDS, 2, {"depth.V"}, Mean::none},
                                {"samples", FILM_IDS, 3, {"samples.V"}, Mean::none}};
    }();
    return aovs;
}

const Aov* find_aov(const std::string& name) {
    for (const Aov& aov : known_aovs())
        if (name == aov.name) return &aov;
    return nullptr;
}

/// Where a position is not known: nothing was hit.
constexpr float far_away = std::numeric_limits<float>::infinity();

/// Mean of a channel. hits: camera samples of the pixel that hit something; count: the plane's fourth channel.
float mean_of(const Aov& aov, cl_long sum, double samples, cl_long hits, cl_long count) {
    const auto ratio = [sum](auto divisor) { return static_cast<float>(static_cast<double>(sum) / divisor); };
    if (aov.mean == Mean::samples) return ratio(samples * FILM_ONE);
    if (aov.mean == Mean::hits) return hits > 0 ? ratio(static_cast<double>(hits)) : far_away;
    if (aov.mean == Mean::count) return count > 0 ? ratio(static_cast<double>(count)) : 1.0f;
    return ratio(1.0);
}

ImageLayer layer_of(const Frame& frame, const Aov& aov) {
    const std::span<const cl_long> plane = frame.plane(aov.plane), beauty = frame.plane(FILM_BEAUTY);
    const std::size_t channels = aov.channels.size();
    ImageLayer layer{aov.channels, {}, aov.mean == Mean::hits || aov.mean == Mean::none};
    layer.values.reserve(plane.size() / FILM_CHANNELS * channels);
    for (std::size_t pixel = 0; pixel < plane.size(); pixel += FILM_CHANNELS)
        for (std::size_t c = 0; c < channels; ++c) {
            const cl_long sum = plane[pixel + static_cast<std::size_t>(aov.first_channel) + c];
            layer.values.push_back(mean_of(aov, sum, frame.samples_per_pixel, beauty[pixel + 3], plane[pixel + 3]));
        }
    return layer;
}

}  // namespace

std::vector<std::string> parse_aovs(const std::string& list) {
    std::vector<std::string> names;
    std::istringstream in(list);
    for (std::string name; std::getline(in, name, ',');) {
        if (name != "all" && !find_aov(name)) {
            std::vector<std::string> known;
            for (const Aov& aov : known_aovs()) known.push_back(aov.name);
            throw UsageError(
                fmt::format("--aov: there is no layer \"{}\"; known are {} and all", name, fmt::join(known, ", ")));
        }
        for (const Aov& aov : known_aovs())
            if ((name == "all" || name == aov.name) && std::ranges::find(names, aov.name) == names.end())
                names.push_back(aov.name);
    }
    return names;
}

FilmPlanes aov_planes(const std::vector<std::string>& names) {
    FilmPlanes planes;
    for (const std::string& name : names) planes.keep(find_aov(name)->plane);
    return planes;
}

std::vector<ImageLayer> aov_layers(const Frame& frame, const std::vector<std::string>& names) {
    std::vector<ImageLayer> layers;
    for (const std::string& name : names) layers.push_back(layer_of(frame, *find_aov(name)));
    return layers;
}

}  // namespace raymill
