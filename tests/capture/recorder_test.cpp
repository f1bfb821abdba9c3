// Which launch is taken out of a frame, and how it is asked for.
#include "capture/recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "captured.hpp"
#include "common/error.hpp"

namespace raymill::capture {
namespace {

TEST(Request, names_depth_stage_and_file) {
    const Request request = parse_request("2,shade,folder/a,b.wave");
    EXPECT_EQ(request.depth, 2);
    EXPECT_EQ(request.stage, Stage::shade);
    EXPECT_FALSE(request.launch.has_value());
    EXPECT_EQ(request.file, "folder/a,b.wave");
    EXPECT_EQ(parse_request("0:13,generate,x").launch, 13u);
}

TEST(Request, that_makes_no_sense_is_refused_with_its_own_words) {
    for (const char* text : {"", "1", "1,shade", "1,shade,", ",shade,f", "x,shade,f", "-1,shade,f", "1:,shade,f",
                             "1:-2,shade,f", "1:2:3,shade,f", "1.5,shade,f", "1,resolve,f", "1,features,f", "1,,f",
                             "1,generate,f", "99999999999,shade,f"}) {
        try {
            parse_request(text);
            ADD_FAILURE() << text << " was taken";
        } catch (const UsageError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with(std::string("--capture ") + text + ": ")) << error.what();
        }
    }
}

/// Items out and in of each launch of intersect at a depth.
std::vector<std::pair<std::ptrdiff_t, std::size_t>> launches_of(TestFrame& frame, int depth = 1) {
    std::vector<std::pair<std::ptrdiff_t, std::size_t>> sizes;
    frame.renderer.observe([&](const char* stage, const WaveView& view) {
        if (stage != std::string("intersect") || view.batch.depth != depth) return;
        const auto hits = view.hits.read(frame.device, 0, view.rays.count);
        sizes.emplace_back(std::ranges::count_if(hits, [](const Hit& hit) { return hit.primitive != NO_INDEX; }),
                           view.rays.count);
    });
    frame.renderer.render();
    frame.renderer.observe({});
    return sizes;
}

TEST(Recorder, takes_the_fullest_launch_and_of_equal_ones_the_first) {
    TestFrame frame(branching_scene(), {}, 64);
    const auto sizes = launches_of(frame);
    ASSERT_GT(sizes.size(), 2u);
    const auto fullest = std::ranges::max_element(sizes);  // the first of several
    const Capture capture = capture_of(frame, Stage::intersect, 1);
    EXPECT_EQ(capture.launch, static_cast<std::uint64_t>(fullest - sizes.begin()));
    EXPECT_EQ(capture.count, fullest->second);
}

TEST(Recorder, takes_a_launch_with_more_hits_before_one_with_more_rays) {
    Scene sky_above = branching_scene();
    sky_above.camera.look_at.y += 2.2;
    TestFrame frame(std::move(sky_above), {}, 640);
    const auto sizes = launches_of(frame, 0);
    const auto fullest = std::ranges::max_element(sizes);
    const auto most_rays = std::ranges::max_element(sizes, {}, [](const auto& size) { return size.second; });
    ASSERT_LT(fullest->second, most_rays->second);
    EXPECT_EQ(capture_of(frame, Stage::intersect, 0).launch, static_cast<std::uint64_t>(fullest - sizes.begin()));
}

TEST(Recorder, takes_the_launch_that_is_named) {
    TestFrame frame(branching_scene(), {}, 64);
    const auto sizes = launches_of(frame);
    for (std::uint64_t launch = 0; launch < sizes.size(); ++launch) {
        const Capture capture = capture_of(frame, Stage::intersect, 1, launch);
        EXPECT_EQ(capture.launch, launch);
        EXPECT_EQ(capture.count, sizes[launch].second);
    }
}

TEST(Recorder, counts_a_launch_for_each_pass_over_the_light_samples) {
    TestFrame frame(branching_scene());  // five light samples: two passes
    const Capture first = capture_of(frame, Stage::shade, 0, 0), second = capture_of(frame, Stage::shade, 0, 1);
    EXPECT_EQ(first.slots.first, 0u);
    EXPECT_EQ(first.slots.count, uint{SHADOW_SAMPLES});
    EXPECT_EQ(second.slots.first, uint{SHADOW_SAMPLES});
    EXPECT_EQ(second.slots.count, 1u);
    EXPECT_EQ(bytes_of(first.rays), bytes_of(second.rays));
}

TEST(Recorder, has_nothing_where_there_was_no_such_launch) {
    TestFrame frame(branching_scene());
    Recorder recorder(frame.device, {Stage::intersect, 0, 1000, ""});
    frame.renderer.observe([&](const char* stage, const WaveView& view) { recorder.see(stage, view); });
    const Frame rendered = frame.renderer.render();
    frame.renderer.observe({});
    EXPECT_FALSE(recorder.finish(frame.scene, frame.renderer, rendered.planes).has_value());
    EXPECT_EQ(recorder.launches(), 4u);  // 24 * 18 * 2 samples in waves of 256
}

TEST(Recorder, leaves_the_frame_as_it_is) {
    TestFrame frame(branching_scene());
    const std::uint64_t plain = frame.renderer.render().hash();
    Recorder recorder(frame.device, {Stage::secondary, 0, {}, ""});
    frame.renderer.observe([&](const char* stage, const WaveView& view) { recorder.see(stage, view); });
    EXPECT_EQ(frame.renderer.render().hash(), plain);
    frame.renderer.observe({});
}

}  // namespace
}  // namespace raymill::capture
