// The scheduler on its own: rays branch at random, and not one is lost.
#include "wavefront/waves.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

namespace raymill {
namespace {

/// Rays that the simulated device has generated and traced, by depth.
struct Tally {
    std::vector<std::uint64_t> pushed, traced;
    explicit Tally(int max_depth) : pushed(max_depth + 1, 0), traced(max_depth + 1, 0) {}
};

/// Runs the renderer's loop with `children` in place of the kernels: how many a batch spawns, at most two a ray.
template <class Children>
Tally simulate(uint capacity, int max_depth, std::uint64_t camera_rays, Children children) {
    Waves waves(capacity, max_depth);
    Tally tally(max_depth);
    for (;;) {
        const std::uint64_t to_come = camera_rays - tally.pushed[0];
        std::optional<Batch> batch = waves.next(to_come);
        if (!batch) {
            if (to_come == 0) return tally;
            const uint count = waves.camera_batch(to_come);
            RC_ASSERT(count >= 1 && count <= to_come);
            waves.push(0, count);
            tally.pushed[0] += count;
            batch = waves.next(to_come - count);
            RC_ASSERT(batch && batch->depth == 0 && batch->first == 0 && batch->count == count);
        }
        RC_ASSERT(batch && batch->count >= 1 && batch->count <= capacity);
        RC_ASSERT(std::uint64_t{batch->first} + batch->count <= waves.queue_size(batch->depth));
        tally.traced[batch->depth] += batch->count;
        if (batch->depth == max_depth) continue;
        const std::uint64_t spawned = children(batch->count);
        waves.push(batch->depth + 1, spawned);
        tally.pushed[batch->depth + 1] += spawned;
    }
}

RC_GTEST_PROP(waves, trace_every_ray_once_however_they_branch, ()) {
    const auto capacity = *rc::gen::inRange<uint>(1, 300);
    const auto max_depth = *rc::gen::inRange(0, 6);
    const auto camera_rays = *rc::gen::inRange<std::uint64_t>(0, 1000);
    const Tally tally = simulate(capacity, max_depth, camera_rays, [](uint count) {
        return *rc::gen::inRange<std::uint64_t>(0, 2 * std::uint64_t{count} + 1);
    });
    RC_ASSERT(tally.pushed[0] == camera_rays);
    RC_ASSERT(tally.traced == tally.pushed);
}

RC_GTEST_PROP(waves, hold_two_children_of_every_ray, ()) {
    const auto capacity = *rc::gen::inRange<uint>(1, 200);
    const auto max_depth = *rc::gen::inRange(0, 6);
    const auto camera_rays = *rc::gen::inRange<std::uint64_t>(0, 400);
    const Tally tally = simulate(capacity, max_depth, camera_rays, [](uint count) { return 2 * std::uint64_t{count}; });
    for (int depth = 0; depth <= max_depth; ++depth) RC_ASSERT(tally.traced[depth] == camera_rays << depth);
}

TEST(waves, take_the_deepest_half_batch_first) {
    Waves waves(10, 2);
    waves.push(0, 10);
    EXPECT_EQ(waves.next(100)->depth, 0);
    waves.push(1, 15);
    const auto first = waves.next(100);
    EXPECT_EQ(first->depth, 1);
    EXPECT_EQ(first->first, 5u);
    EXPECT_EQ(first->count, 10u);
    waves.push(2, 6);
    EXPECT_EQ(waves.next(100)->depth, 2);
    EXPECT_EQ(waves.next(100)->count, 5u);
    EXPECT_FALSE(waves.next(0));
}

TEST(waves, let_fewer_rays_wait_for_more) {
    Waves waves(10, 2);
    waves.push(0, 10);
    waves.next(100);
    waves.push(1, 4);
    EXPECT_FALSE(waves.next(100)) << "camera rays are to come";
    waves.push(0, waves.camera_batch(100));
    EXPECT_EQ(waves.next(92)->count, 8u) << "sixteen children fit beside the four";
    waves.push(1, 16);
    EXPECT_EQ(waves.next(92)->first, 10u);
}

TEST(waves, empty_the_shallowest_first_when_no_camera_rays_are_to_come) {
    Waves waves(10, 2);
    waves.push(1, 2);
    waves.push(2, 3);
    EXPECT_EQ(waves.next(0)->depth, 1);
    waves.push(2, 1);
    const auto last = waves.next(0);
    EXPECT_EQ(last->depth, 2);
    EXPECT_EQ(last->count, 4u);
    EXPECT_FALSE(waves.next(0));
}

TEST(waves, begin_camera_batches_at_whole_chunks) {
    Waves waves(1000, 1);
    waves.push(1, 300);
    EXPECT_EQ(waves.camera_batch(5000), 832u) << "13 chunks of at most 850 rays";
    EXPECT_EQ(waves.camera_batch(831), 831u) << "the last ones";
    EXPECT_EQ(Waves(50, 0).camera_batch(5000), 50u) << "less than a chunk";
}

TEST(waves, refuse_more_children_than_two_a_ray) {
    Waves waves(10, 1);
    EXPECT_THROW(waves.push(1, 21), QueueOverflow);
    EXPECT_THROW(waves.push(0, 11), QueueOverflow);
    EXPECT_NO_THROW(waves.push(1, 15));
    EXPECT_THROW(waves.push(1, 6), QueueOverflow);
}

}  // namespace
}  // namespace raymill
