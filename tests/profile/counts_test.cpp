// The counts of a profiled frame against what the queues themselves hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "frames.hpp"
#include "image/temporary_folder.hpp"
#include "lib/random.h"
#include "reference/reference.hpp"

namespace raymill {
namespace {

using profile::Detail;
using profile::Fates;
using profile::Stage;

bool passes_light_on(const Scene& scene, uint primitive) {
    const std::size_t triangles = scene.triangles.size(), spheres = scene.spheres.size();
    const uint material = primitive < triangles             ? scene.triangles[primitive].material
                          : primitive < triangles + spheres ? scene.spheres[primitive - triangles].material
                                                            : scene.planes[primitive - triangles - spheres].material;
    return scene.materials[material].reflection + scene.materials[material].transmission > 0;
}

/// Counts a frame's waves from their queues.
class QueueReader {
  public:
    explicit QueueReader(ProfiledScene& s) : s_(s), tracer_(s.scene) {
        s.renderer->observe([this](const std::string& stage, const WaveView& view) { see(stage, view); });
    }
    std::vector<profile::Wave> waves;

  private:
    void see(const std::string& stage, const WaveView& view) {
        if (stage == "intersect") begin(view);
        if (stage == "shade") count_shadow_rays(view);
        if (stage == "secondary") count_children(view);
    }
    void begin(const WaveView& view) {
        rays_ = view.rays.items.read(s_.device, view.rays.first, view.rays.count);
        hits_ = view.hits.read(s_.device, 0, view.rays.count);
        profile::Wave& wave = waves.emplace_back();
        wave.depth = view.batch.depth;
        wave.rays = rays_.size();
        for (const Hit& hit : hits_) {
            if (hit.primitive == NO_INDEX)
                ++wave.fates.missed;
            else if (!passes_light_on(s_.scene, hit.primitive))
                ++wave.fates.absorbed;
            else
                ++wave.fates.depth_limit;  // until its children show up
        }
    }
    void count_shadow_rays(const WaveView& view) {
        const std::size_t segments = std::size_t{Stages::chunks(view.rays.count)} * view.slots.count;
        const std::vector<uint> counts = view.shadow_rays.counts.read(s_.device, 0, segments);
        const std::vector<ShadowRay> rays = view.shadow_rays.rays.read(s_.device, 0, segments * CHUNK);
        for (std::size_t segment = 0; segment < segments; ++segment)
            for (std::size_t i = 0; i < counts[segment]; ++i) {
                const ShadowRay& ray = rays[segment * CHUNK + i];
                ++waves.back().shadow_rays;
                waves.back().shadow_blocked +=
                    tracer_.visibility(reference::to_dvec3(ray.origin), reference::to_dvec3(ray.direction),
                                       ray.t_max) == glm::dvec3(0);
            }
    }
    void count_children(const WaveView& view) {
        std::set<std::pair<uint, uint>>
            paths;  // a child's is a hash of its parent's and its branch; samples share them
        for (const Ray& child : view.children->items.read(s_.device, view.children->first, view.children->count))
            paths.emplace(child.path, child.sample);
        Fates& fates = waves.back().fates;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const Ray& ray = rays_[i];
            if (hits_[i].primitive == NO_INDEX || !passes_light_on(s_.scene, hits_[i].primitive)) continue;
            const std::size_t children =
                paths.count({path_child(ray.path, 0), ray.sample}) + paths.count({path_child(ray.path, 1), ray.sample});
            --fates.depth_limit;
            ++(children == 0 ? fates.weightless : children == 1 ? fates.one_child : fates.two_children);
        }
    }

    ProfiledScene& s_;
    reference::Tracer tracer_;
    std::vector<Ray> rays_;
    std::vector<Hit> hits_;
};

class Counts : public testing::TestWithParam<std::pair<std::uint64_t, std::size_t>> {
  protected:
    ProfiledScene scene_{GetParam().first, GetParam().second};
};

TEST_P(Counts, of_every_wave_are_those_of_its_queues) {
    QueueReader reader(scene_);
    const Frame frame = scene_.renderer->render({}, Detail::launches);
    ASSERT_EQ(frame.profile.waves.size(), reader.waves.size());
    std::int64_t grazing = 0;
    for (std::size_t i = 0; i < reader.waves.size(); ++i) {
        const profile::Wave& counted = frame.profile.waves[i];
        const profile::Wave& expected = reader.waves[i];
        ASSERT_EQ(counted.depth, expected.depth);
        ASSERT_EQ(counted.rays, expected.rays);
        ASSERT_EQ(counted.fates, expected.fates) << "wave " << i << " of depth " << counted.depth;
        ASSERT_EQ(counted.shadow_rays, expected.shadow_rays);
        grazing += std::abs(static_cast<std::int64_t>(counted.shadow_blocked - expected.shadow_blocked));
    }
    // The reference is in double precision: a shadow ray that grazes an edge may fall to either side.
    EXPECT_LE(grazing, static_cast<std::int64_t>(frame.rays.shadow / 500));
}

TEST_P(Counts, of_depths_add_up_and_every_kind_occurs) {
    const Frame frame = scene_.renderer->render({}, Detail::totals);
    const profile::FrameProfile& p = frame.profile;
    const Fates fates = p.fates();
    EXPECT_TRUE(p.waves.empty() && p.launches.empty());
    EXPECT_EQ(p.rays(), frame.rays.camera + frame.rays.secondary);
    EXPECT_EQ(fates.rays(), p.rays());
    EXPECT_EQ(p.shadow_rays(), frame.rays.shadow);
    EXPECT_EQ(p.shadow_blocked(), frame.shadow_blocked);
    for (const std::uint64_t kind :
         {fates.missed, fates.depth_limit, fates.weightless, fates.one_child, fates.two_children})
        EXPECT_GT(kind, 0u);
    for (std::size_t d = 0; d < p.depths.size(); ++d) {
        const profile::DepthTotal& depth = p.depths[d];
        EXPECT_EQ(depth.pushed, depth.popped);
        EXPECT_EQ(depth.fates.rays(), depth.popped);
        EXPECT_EQ(depth.pushed, d == 0 ? frame.rays.camera : p.depths[d - 1].fates.children());
        EXPECT_LE(depth.high_water, depth.capacity);
        EXPECT_EQ(depth.capacity, GetParam().first * (d == 0 ? 1 : 2));
    }
}

TEST_P(Counts, of_stages_follow_from_those_of_rays) {
    const Frame frame = scene_.renderer->render({}, Detail::launches);
    const profile::FrameProfile& p = frame.profile;
    const Fates fates = p.fates();
    EXPECT_EQ(p.total(Stage::generate).items_out, frame.rays.camera);
    EXPECT_EQ(p.total(Stage::intersect).items_in, fates.rays());
    EXPECT_EQ(p.total(Stage::intersect).items_out, fates.hits());
    EXPECT_EQ(p.total(Stage::shade).items_in, 2 * fates.rays()) << "two passes";
    EXPECT_EQ(p.total(Stage::shade).items_out, frame.rays.shadow);
    EXPECT_EQ(p.total(Stage::shadow).items_in, frame.rays.shadow);
    EXPECT_EQ(p.total(Stage::shadow).items_out, frame.rays.shadow - frame.shadow_blocked);
    EXPECT_EQ(p.total(Stage::secondary).items_out, frame.rays.secondary);
    for (const profile::Launch& launch : p.launches) {
        ASSERT_LE(launch.items_in, launch.places);
        ASSERT_LE(launch.items_out, p.total(launch.stage).high_water);
        ASSERT_GE(launch.places, launch.work_items);
    }
    for (const Stage stage : {Stage::generate, Stage::intersect, Stage::shade, Stage::secondary})
        EXPECT_LE(p.total(stage).high_water, p.total(stage).capacity) << profile::stage_name(stage);
}

TEST_P(Counts, cost_no_bit_of_the_picture) {
    const std::uint64_t plain = scene_.renderer->render().hash();
    EXPECT_EQ(scene_.renderer->render({}, Detail::launches).hash(), plain);
    EXPECT_TRUE(scene_.renderer->render().profile.stages.empty());
}

INSTANTIATE_TEST_SUITE_P(Profile, Counts,
                         testing::Values(std::pair<std::uint64_t, std::size_t>{256, 0},
                                         std::pair<std::uint64_t, std::size_t>{70, 8}),
                         [](const auto& info) { return "capacity_" + std::to_string(info.param.first); });

TEST(Counts, of_bytes_do_not_depend_on_how_rays_are_traced) {
    const ProfiledScene scene;
    RenderOptions options;
    options.memory.queue_capacity = 256;
    const auto frame_of = [&](Traversal traversal) {
        options.traversal = traversal;
        return Renderer(scene.device, scene.scene, scene.bvh, options).render({}, Detail::totals).profile;
    };
    const profile::FrameProfile packet = frame_of(Traversal::packet), single = frame_of(Traversal::single);
    for (std::size_t i = 0; i < profile::stage_count; ++i) {
        const auto stage = static_cast<Stage>(i);
        EXPECT_EQ(single.total(stage).traffic.bytes_read, packet.total(stage).traffic.bytes_read) << i;
        EXPECT_EQ(single.total(stage).traffic.bytes_written, packet.total(stage).traffic.bytes_written) << i;
    }
}

/// A copy of the kernels in which `right` reads `wrong`.
void falsify(const std::filesystem::path& folder, const std::string& file, const std::string& right,
             const std::string& wrong) {
    std::filesystem::copy(RAYMILL_SOURCE_DIR "/kernels", folder, std::filesystem::copy_options::recursive);
    std::string text = read_bytes((folder / file).string());
    const std::size_t place = text.find(right);
    ASSERT_NE(place, std::string::npos) << file << " no longer contains: " << right;
    write_text((folder / file).string(), text.replace(place, right.size(), wrong));
}

TEST(FalsifiedCounts, of_shadow_rays_fail_every_frame) {
    const TemporaryFolder folder;
    falsify(folder.path() / "kernels", "shadow.cl", "&counters->shadow_traced, count)",
            "&counters->shadow_traced, count - 1)");
    ProfiledScene scene(256, 0, folder.file("kernels"));
    EXPECT_THROW(scene.renderer->render(), QueueMismatch);
}

TEST(FalsifiedCounts, of_parents_fail_a_profiled_frame) {
    const TemporaryFolder folder;
    falsify(folder.path() / "kernels", "secondary.cl", "counters->parents, (ulong)parents",
            "counters->parents, (ulong)3 * parents");
    ProfiledScene scene(256, 0, folder.file("kernels"));
    EXPECT_THROW(scene.renderer->render({}, Detail::totals), QueueMismatch);
}

TEST(FalsifiedCounts, of_popped_rays_are_noticed) {
    Waves waves(8, 1);
    waves.push(0, 5);
    EXPECT_THROW(waves.check_drained(), QueueMismatch);
    waves.next(0);
    EXPECT_NO_THROW(waves.check_drained());
    EXPECT_EQ(waves.counts(0).high_water, 5u);
}

}  // namespace
}  // namespace raymill
