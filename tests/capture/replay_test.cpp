// A captured launch writes again what it wrote in its frame, however it is run.
#include "capture/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "capture/capture_file.hpp"
#include "captured.hpp"
#include "support/changed_kernels.hpp"
#include "verify/capture_check.hpp"
#include "wavefront/records.hpp"

namespace raymill::capture {
namespace {

/// Children come in the order in which work-items ran.
std::vector<std::string> sorted(std::vector<std::string> items) {
    std::ranges::sort(items);
    return items;
}

/// Whatever runs a capture, on a device scene of its own.
struct Bench {
    Bench(const Capture& capture, const Scene& scene, unsigned threads = 0, std::size_t work_group = 0,
          Traversal traversal = Traversal::automatic, std::uint64_t capacity = 0, const std::string& kernel_dir = {})
        : device(open_device("", threads)),
          bvh(build_bvh(scene.vertices, scene.triangles, scene.spheres)),
          stages(device, work_group, kernel_dir, traversal),
          on_device(device, scene, bvh, capture.frame.planes),
          replay(device, stages, on_device, capture, film_pixels(scene), capacity) {}

    Outcome run() {
        replay.clear();
        replay.run();
        return replay.read();
    }

    Device device;
    Bvh bvh;
    Stages stages;
    DeviceScene on_device;
    Replay replay;
};

using Case = std::tuple<Stage, std::uint64_t>;  // capacity of the frame

class Captured : public testing::TestWithParam<Case> {
  protected:
    const Stage stage_ = std::get<0>(GetParam());
    const int depth_ = stage_ == Stage::generate ? 0 : 1;
    TestFrame frame_{branching_scene(), {}, std::get<1>(GetParam())};
};

TEST_P(Captured, launch_writes_the_very_items_that_it_wrote_in_the_frame) {
    Written written;
    const Capture capture = capture_of(frame_, stage_, depth_, {}, &written);
    Bench bench(capture, frame_.scene);
    const Outcome outcome = bench.run();
    EXPECT_EQ(outcome.digest, capture.digest);
    const Written again = read_written(bench.device, stage_, bench.replay.view());
    EXPECT_EQ(bytes_of(again.hits), bytes_of(written.hits));
    EXPECT_EQ(again.shadow_counts, written.shadow_counts);
    EXPECT_EQ(bytes_of(again.shadow_rays), bytes_of(written.shadow_rays));
    EXPECT_EQ(sorted(bytes_of(again.rays)), sorted(bytes_of(written.rays)));
    const auto hits = std::ranges::count_if(written.hits, [](const Hit& hit) { return hit.primitive != NO_INDEX; });
    if (stage_ != Stage::shadow) {
        // A stage writes one of these three.
        EXPECT_EQ(outcome.items_out, written.rays.size() + written.shadow_rays.size() + static_cast<std::size_t>(hits));
    }
    EXPECT_GT(outcome.items_out, 0u);
}

TEST_P(Captured, launch_writes_the_same_each_time) {
    const Capture capture = capture_of(frame_, stage_, depth_);
    Bench bench(capture, frame_.scene);
    for (int repeat = 0; repeat < 3; ++repeat) EXPECT_EQ(bench.run().digest, capture.digest) << repeat;
}

TEST_P(Captured, launch_comes_back_from_its_file) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "queue.wave";
    const Capture capture = capture_of(frame_, stage_, depth_);
    write_capture(file, capture);
    const LoadedCapture loaded = load_capture(file, "", "--scene");
    EXPECT_EQ(loaded.capture.items(), capture.items());
    Bench bench(loaded.capture, loaded.scene);
    EXPECT_EQ(bench.run().digest, capture.digest);
}

TEST_P(Captured, launch_is_within_the_bounds_of_the_reference_item_by_item) {
    const Capture capture = capture_of(frame_, stage_, depth_);
    Bench bench(capture, frame_.scene);
    const verify::StageReport report =
        verify::verify_capture(bench.device, frame_.scene, bench.stages, bench.on_device, capture, {});
    EXPECT_EQ(report.failures(), 0u) << report.first_failure();
    EXPECT_EQ(report.stage(), name_of(stage_));
    EXPECT_GT(report.items(), 0u);
    EXPECT_EQ(report.compared(), report.items());
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
    return name_of(std::get<0>(info.param)) + "_of_frame_with_queues_of_" + std::to_string(std::get<1>(info.param));
}

// Queues of less than a chunk, of no whole number of chunks, and of all that the frame has.
INSTANTIATE_TEST_SUITE_P(Launches, Captured, testing::Combine(testing::ValuesIn(stages), testing::Values(7, 100, 4096)),
                         case_name);

class Replayed : public testing::TestWithParam<Stage> {};

TEST_P(Replayed, output_does_not_depend_on_how_it_is_run) {
    TestFrame frame(branching_scene(), {}, 1000);
    const Capture capture = capture_of(frame, GetParam(), GetParam() == Stage::generate ? 0 : 1);
    for (const std::uint64_t capacity : {1, 50, 64, 128})
        EXPECT_EQ(Bench(capture, frame.scene, 0, 0, Traversal::automatic, capacity).run().digest, capture.digest)
            << capacity;
    for (const std::size_t work_group : {1, 16})
        EXPECT_EQ(Bench(capture, frame.scene, 0, work_group).run().digest, capture.digest) << work_group;
    for (const Traversal traversal : {Traversal::packet, Traversal::single})
        EXPECT_EQ(Bench(capture, frame.scene, 1, 0, traversal).run().digest, capture.digest);
}

INSTANTIATE_TEST_SUITE_P(Stages, Replayed, testing::ValuesIn(stages),
                         [](const auto& info) { return name_of(info.param); });

TEST(Replay, of_a_later_pass_over_the_light_samples_is_verified_without_ambient_light) {
    TestFrame frame(branching_scene());
    const Capture capture = capture_of(frame, Stage::shade, 0, 1);
    ASSERT_GT(capture.slots.first, 0u);
    Bench bench(capture, frame.scene);
    const verify::StageReport report =
        verify::verify_capture(bench.device, frame.scene, bench.stages, bench.on_device, capture, {});
    EXPECT_EQ(report.failures(), 0u) << report.first_failure();
    const auto hits = std::ranges::count_if(capture.hits, [](const Hit& hit) { return hit.primitive != NO_INDEX; });
    EXPECT_EQ(report.items(), static_cast<std::uint64_t>(hits));  // one light sample each
}

TEST(Replay, with_the_film_of_a_frame_that_keeps_features_writes_the_same) {
    RenderOptions options;
    options.planes.keep(FILM_SHADOW);
    options.planes.keep(FILM_IDS);
    TestFrame frame(branching_scene());
    Renderer renderer(frame.device, frame.scene, frame.bvh, options);
    Recorder recorder(frame.device, {Stage::shadow, 0, {}, ""});
    renderer.observe([&](const char* stage, const WaveView& view) { recorder.see(stage, view); });
    renderer.render();
    const auto capture = recorder.finish(frame.scene, renderer, options.planes);
    ASSERT_TRUE(capture.has_value());
    EXPECT_EQ(Bench(*capture, frame.scene).run().digest, capture->digest);
}

TEST(Replay, by_kernels_with_a_mistake_writes_something_else_and_is_out_of_bounds) {
    const TemporaryFolder folder;
    change_kernels(folder.path() / "kernels", "lib/light.h", "attenuation = 1.0f / fma(",
                   "attenuation = 1.00001f / fma(");
    if (HasFatalFailure()) return;
    TestFrame frame(branching_scene());
    const Capture capture = capture_of(frame, Stage::shade, 0, 0);
    Bench bench(capture, frame.scene, 0, 0, Traversal::automatic, 0, folder.path() / "kernels");
    EXPECT_NE(bench.run().digest.queue, capture.digest.queue);
    const verify::StageReport report =
        verify::verify_capture(bench.device, frame.scene, bench.stages, bench.on_device, capture, {});
    EXPECT_GT(report.failures(), 0u);
}

TEST(Replay, moves_each_item_of_its_queues_once) {
    TestFrame frame(branching_scene());
    const auto traffic_of = [&](Stage stage) {
        const Capture capture = capture_of(frame, stage, 0, 0);
        Bench bench(capture, frame.scene);
        return std::pair(capture, bench.replay.traffic(bench.run()));
    };
    const auto [rays, intersect] = traffic_of(Stage::intersect);
    EXPECT_EQ(intersect.bytes_read, rays.count * sizeof(Ray));
    EXPECT_EQ(intersect.bytes_written, rays.count * sizeof(Hit));
    const auto [segments, shadow] = traffic_of(Stage::shadow);
    EXPECT_EQ(shadow.bytes_read,
              segments.shadow_rays.size() * sizeof(ShadowRay) + segments.shadow_counts.size() * sizeof(uint));
    const auto [hits, shade] = traffic_of(Stage::shade);
    const auto met = static_cast<std::size_t>(
        std::ranges::count_if(hits.hits, [](const Hit& hit) { return hit.primitive != NO_INDEX; }));
    EXPECT_EQ(shade.bytes_read, hits.count * sizeof(Hit) + met * sizeof(Ray));
    EXPECT_EQ(shade.bytes_written,
              segments.shadow_rays.size() * sizeof(ShadowRay) + segments.shadow_counts.size() * sizeof(uint));
}

}  // namespace
}  // namespace raymill::capture
