// The atomic operations that kernels count, against what the film and the queues show of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "frames.hpp"
#include "wavefront/records.hpp"

namespace raymill {
namespace {

using profile::Detail;
using profile::Launch;
using profile::Stage;

/// With one light sample there is one shadow ray a hit.
Scene scene_with_one_lamp() {
    Scene scene = branching_scene();
    scene.lights.resize(2);  // the ambient light and the point light
    return scene;
}

FilmPlanes all_planes() {
    FilmPlanes planes;
    for (int plane = FILM_AMBIENT; plane < FILM_PLANES; ++plane) planes.keep(plane);
    return planes;
}

/// Integers of light, or of what features there are but ids, that differ.
std::uint64_t changes(const std::vector<cl_long>& before, const std::vector<cl_long>& after, const FilmPlanes& planes,
                      bool features) {
    const std::size_t plane_size = after.size() / planes.count();
    std::uint64_t sum = 0;
    for (int plane = 0; plane < FILM_PLANES; ++plane) {
        const bool is_feature = plane == FILM_ALBEDO || plane == FILM_NORMAL || plane == FILM_POSITION;
        if (!planes.keeps(plane) || plane == FILM_IDS || is_feature != features) continue;
        const std::size_t first = planes.index(plane) * plane_size;
        for (std::size_t i = first; i < first + plane_size; ++i) sum += before[i] != after[i];
    }
    return sum;
}

/// What was seen of one launch.
struct Seen {
    std::string stage;
    int depth;
    std::uint64_t atomics;
};

/// Counts the adds of launches on a single ray, which reach an integer once: each that is not of zero changes it.
class FilmReader {
  public:
    FilmReader(ProfiledScene& s, const FilmPlanes& planes) : s_(s), planes_(planes) {
        film_.resize(film_pixels(s.scene) * FILM_CHANNELS * planes.count());
        s.renderer->observe([this](const std::string& stage, const WaveView& view) { see(stage, view); });
    }
    std::vector<Seen> seen;
    std::uint64_t feature_adds = 0;

    /// Looks at what has been added since the last look.
    void look(const std::vector<cl_long>& film) {
        feature_adds += changes(film_, film, planes_, true);
        film_ = film;
    }

  private:
    void see(const std::string& stage, const WaveView& view) {
        if (stage == "generate") return;
        const std::vector<cl_long> film = view.film.sums.read(s_.device);
        const Counters now = view.film.counters.read_one(s_.device);
        std::uint64_t atomics = changes(film_, film, planes_, false);
        if (stage == "shade") atomics += now.shadow_rays != counters_.shadow_rays;
        if (stage == "shadow")
            atomics +=
                (now.shadow_traced != counters_.shadow_traced) + (now.shadow_blocked != counters_.shadow_blocked);
        if (stage == "secondary") atomics = view.children->count > 0;
        look(film);
        counters_ = now;
        seen.push_back({stage, view.batch.depth, atomics});
    }

    ProfiledScene& s_;
    FilmPlanes planes_;
    std::vector<cl_long> film_;
    Counters counters_{};
};

/// Compares each launch that an observer sees. deepest: of the launches to compare.
void compare(const profile::FrameProfile& frame, const FilmReader& reader, int deepest) {
    std::vector<const Launch*> launches;
    for (const Launch& launch : frame.launches)
        if (launch.stage != Stage::generate && launch.stage != Stage::features && launch.stage != Stage::resolve)
            launches.push_back(&launch);
    ASSERT_EQ(launches.size(), reader.seen.size());
    std::array<std::uint64_t, profile::stage_count> compared{};
    for (std::size_t i = 0; i < launches.size(); ++i) {
        ASSERT_EQ(profile::stage_name(launches[i]->stage), reader.seen[i].stage);
        ASSERT_EQ(launches[i]->depth, reader.seen[i].depth);
        if (launches[i]->depth > deepest) continue;
        ASSERT_EQ(launches[i]->traffic.atomics, reader.seen[i].atomics) << i << ": " << reader.seen[i].stage;
        compared[static_cast<std::size_t>(launches[i]->stage)] += reader.seen[i].atomics;
    }
    for (const Stage stage : {Stage::intersect, Stage::shade, Stage::shadow, Stage::secondary})
        EXPECT_GT(compared[static_cast<std::size_t>(stage)], 0u) << profile::stage_name(stage);
}

TEST(Atomics, of_single_rays_are_the_integers_that_change) {
    ProfiledScene scene(1, 0, {}, {}, scene_with_one_lamp());
    FilmReader reader(scene, {});
    compare(scene.renderer->render({}, Detail::launches).profile, reader, scene.scene.settings.depth);
}

TEST(Atomics, of_single_camera_rays_are_the_integers_that_change_in_all_layers) {
    // Deeper rays add both their terms to one layer.
    ProfiledScene scene(1, 0, {}, all_planes(), scene_with_one_lamp());
    FilmReader reader(scene, all_planes());
    const Frame frame = scene.renderer->render({}, Detail::launches);
    compare(frame.profile, reader, 0);
    reader.look(frame.sums);
    EXPECT_GT(reader.feature_adds, 0u);
    // Of ids, the depth of each ray and the number of samples are atomic.
    EXPECT_EQ(frame.profile.total(Stage::features).traffic.atomics,
              reader.feature_adds + frame.profile.rays() + frame.rays.camera);
}

TEST(Atomics, of_camera_rays_that_have_a_pixel_each_are_those_of_counters) {
    Scene lamp = scene_with_one_lamp();
    lamp.settings.spp = 1;
    lamp.settings.depth = 0;
    ProfiledScene scene(64, 0, {}, {}, lamp);
    const Frame frame = scene.renderer->render({}, Detail::launches);
    for (const Launch& launch : frame.profile.launches) {
        const std::uint64_t shadow_rays = launch.stage == Stage::shade ? launch.items_out : launch.items_in;
        std::uint64_t counters = 0;
        if (launch.stage == Stage::shade) counters = shadow_rays > 0;
        if (launch.stage == Stage::shadow) counters = (shadow_rays > 0) + (launch.items_out < launch.items_in);
        ASSERT_EQ(launch.traffic.atomics, counters) << profile::stage_name(launch.stage);
    }
    EXPECT_GT(frame.profile.total(Stage::shadow).traffic.atomics, 0u);
}

/// One that adds light to the film, whether its channels are not zero in units of the film.
struct Adding {
    uint pixel;
    std::array<bool, 4> channels;  // the fourth counts hits of camera rays
};

std::array<bool, 4> channels(const float (&a)[3], const float (&b)[3]) {
    constexpr double units = 4294967296.0;
    std::array<bool, 4> lit{};
    for (std::size_t c = 0; c < 3; ++c)
        lit[c] =
            std::nearbyint(units * static_cast<double>(a[c])) + std::nearbyint(units * static_cast<double>(b[c])) != 0;
    return lit;
}

/// Atomic operations of a chunk's items, of which sixteen go to the film at a time, neighbours of one pixel together.
std::uint64_t adds(const std::vector<Adding>& items) {
    constexpr std::size_t lanes = 16;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < items.size();) {
        std::array<bool, 4> lit{};
        const std::size_t begin = i;
        for (; i < items.size() && i / lanes == begin / lanes && items[i].pixel == items[begin].pixel; ++i)
            for (std::size_t c = 0; c < 4; ++c) lit[c] |= items[i].channels[c];
        sum += static_cast<std::uint64_t>(std::ranges::count(lit, true));
    }
    return sum;
}

/// Counts what launches on many rays add, from their queues, where nothing casts a shadow and every surface shines.
class QueueAdds {
  public:
    explicit QueueAdds(ProfiledScene& s) : s_(s) {
        s.renderer->observe([this](const std::string& stage, const WaveView& view) {
            if (stage == "intersect") of_rays(view);
            if (stage == "shade" && view.slots.first == 0) shade_ += local_light_;
            if (stage == "shadow") shadow.push_back(of_shadow_rays(view));
        });
    }
    std::vector<std::uint64_t> intersect, shadow;
    std::uint64_t shade() const { return shade_; }

  private:
    void of_rays(const WaveView& view) {
        const std::vector<Ray> rays = view.rays.items.read(s_.device, view.rays.first, view.rays.count);
        const std::vector<Hit> hits = view.hits.read(s_.device, 0, view.rays.count);
        const glm::dvec3 background = s_.scene.settings.background;
        std::uint64_t sum = 0;
        local_light_ = 0;
        for (std::size_t first = 0; first < rays.size(); first += CHUNK) {
            std::vector<Adding> missed, found;
            for (std::size_t i = first; i < std::min(first + CHUNK, rays.size()); ++i) {
                float sky[3] = {0, 0, 0};
                for (int c = 0; c < 3; ++c) sky[c] = rays[i].throughput[c] * static_cast<float>(background[c]);
                if (hits[i].primitive == NO_INDEX) {
                    missed.push_back({rays[i].pixel, channels(sky, {0, 0, 0})});
                    continue;
                }
                found.push_back({rays[i].pixel, {true, true, true, rays[i].route == ROUTE_CAMERA}});
            }
            sum += adds(missed);
            local_light_ += adds(found);
        }
        intersect.push_back(sum);
    }
    std::uint64_t of_shadow_rays(const WaveView& view) {
        const uint chunks = Stages::chunks(view.rays.count), slots = view.slots.count;
        const std::vector<uint> counts = view.shadow_rays.counts.read(s_.device, 0, std::size_t{chunks} * slots);
        const std::vector<ShadowRay> rays = view.shadow_rays.rays.read(s_.device, 0, counts.size() * CHUNK);
        std::uint64_t sum = 0;
        for (uint chunk = 0; chunk < chunks; ++chunk) {
            bool shines = false;
            for (uint segment = chunk * slots; segment < (chunk + 1) * slots; ++segment) {
                sum += counts[segment] > 0;  // shadow_traced
                shines |= counts[segment] > 0;
                std::vector<Adding> lit;
                for (uint i = segment * CHUNK; i < segment * CHUNK + counts[segment]; ++i)
                    lit.push_back({rays[i].pixel, channels(rays[i].diffuse, rays[i].specular)});
                sum += adds(lit);
            }
            shade_ += shines;  // shadow_rays
        }
        return sum;
    }
    ProfiledScene& s_;
    std::uint64_t local_light_ = 0;  // what shade will add of the batch
    std::uint64_t shade_ = 0;
};

void compare_with_queues(std::uint64_t capacity, std::size_t work_group) {
    Scene bright = branching_scene();
    bright.settings.shadows = ShadowMode::none;
    for (SceneMaterial& material : bright.materials) material.emission = glm::vec3(0.25f);
    ProfiledScene scene(capacity, work_group, {}, {}, bright, Traversal::packet);  // a chunk a work-item
    QueueAdds adds(scene);
    const Frame frame = scene.renderer->render({}, Detail::launches);
    std::size_t intersect = 0, shadow = 0;
    for (const Launch& launch : frame.profile.launches) {
        if (launch.stage == Stage::intersect) {
            EXPECT_EQ(launch.traffic.atomics, adds.intersect.at(intersect++));
        } else if (launch.stage == Stage::shadow) {
            EXPECT_EQ(launch.traffic.atomics, adds.shadow.at(shadow++));
        }
    }
    EXPECT_EQ(intersect, adds.intersect.size());
    EXPECT_EQ(shadow, adds.shadow.size());
    EXPECT_EQ(frame.shadow_blocked, 0u);
    EXPECT_EQ(frame.profile.total(Stage::shade).traffic.atomics, adds.shade());
}

TEST(Atomics, of_many_rays_are_those_that_their_queues_ask_for) {
    compare_with_queues(1, 0);
    compare_with_queues(256, 0);
    compare_with_queues(70, 8);
}

TEST(Atomics, are_counted_only_where_a_frame_is_profiled) {
    ProfiledScene scene;
    Counters last{};
    scene.renderer->observe(
        [&](const std::string&, const WaveView& view) { last = view.film.counters.read_one(scene.device); });
    scene.renderer->render();
    for (const ulong atomics : last.atomics) EXPECT_EQ(atomics, 0u);
    EXPECT_EQ(last.missed + last.passing + last.parents, 0u);
    EXPECT_GT(last.shadow_traced, 0u);
}

}  // namespace
}  // namespace raymill
