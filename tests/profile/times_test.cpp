// Times of a profiled frame: in order, apart from each other, and adding up.
#include <gtest/gtest.h>

#include "frames.hpp"
#include "profile/timeline.hpp"

namespace raymill {
namespace {

using profile::Detail;

TEST(Times, of_launches_are_in_order_and_within_the_frame) {
    ProfiledScene scene;
    const std::int64_t begin = profile::now();
    const Frame frame = scene.renderer->render({}, Detail::launches);
    const std::int64_t end = profile::now();
    constexpr std::int64_t comparison = 100'000;  // ns; two clocks are compared through calls that take microseconds
    ASSERT_FALSE(frame.profile.launches.empty());
    std::int64_t last = begin - comparison;
    for (const profile::Launch& launch : frame.profile.launches) {
        ASSERT_LE(launch.queued, launch.submitted);
        ASSERT_LE(launch.submitted, launch.started);
        ASSERT_LE(launch.started, launch.ended);
        ASSERT_GE(launch.started, last) << "one kernel after the other";
        last = launch.ended;
    }
    EXPECT_LE(last, end + comparison);
}

TEST(Times, of_a_frame_add_up_to_its_wall_clock) {
    ProfiledScene scene;
    const Frame frame = scene.renderer->render({}, Detail::totals);
    const profile::FrameTimes& times = frame.profile.times;
    EXPECT_NEAR(times.sum(), times.seconds, 0.05 * times.seconds);  // parts are measured one by one; what we promise
    EXPECT_LE(times.seconds, frame.seconds);
    double kernels = 0;
    for (const profile::StageTotal& total : frame.profile.stages) {
        EXPECT_LE(total.shortest, total.longest);
        EXPECT_LE(total.longest, total.seconds * (1 + 1e-9));  // a sum of doubles
        kernels += total.seconds;
    }
    EXPECT_NEAR(kernels, times.kernels, 1e-9 * kernels);  // the same nanoseconds, summed in another order
}

TEST(Times, of_the_setup_are_named_and_do_not_overlap) {
    const std::int64_t begin = profile::now();
    const ProfiledScene scene;
    const std::vector<profile::Span>& spans = scene.renderer->setup();
    ASSERT_EQ(spans.size(), 4u);
    EXPECT_EQ(spans[0].name, profile::kernels_span);
    std::int64_t last = begin;
    for (const profile::Span& span : spans) {
        EXPECT_GE(span.start, last);
        EXPECT_GE(span.end, span.start);
        last = span.end;
    }
}

TEST(Timeline, keeps_the_span_of_work_that_throws) {
    profile::Timeline timeline;
    EXPECT_THROW(timeline.measure("fails", [] { throw std::runtime_error("no"); }), std::runtime_error);
    EXPECT_EQ(timeline.measure("answers", [] { return 42; }), 42);
    ASSERT_EQ(timeline.spans().size(), 2u);
    EXPECT_EQ(timeline.spans()[0].name, "fails");
}

}  // namespace
}  // namespace raymill
