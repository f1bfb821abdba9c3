// Stopping after a wave is launched: what was begun is finished, and nothing else is.
#include <gtest/gtest.h>

#include <algorithm>

#include "rendering.hpp"

namespace raymill {
namespace {

/// A bright mirror that fills the picture.
Scene mirror_scene() {
    return scene_of(R"(
[render]
size = [32, 24]
depth = 2
background = 0.25
[camera]
eye = [0, 2, 3]
look_at = [0, 0, 0]
fov = 30
[[material]]
name = "mirror"
diffuse = 0.4
reflection = 0.5
[[light]]
type = "directional"
direction = [-1, -2, -1]
[[object]]
shape = "plane"
material = "mirror"
point = [0, 0, 0]
normal = [0, 1, 0]
)");
}

class Interrupted : public testing::Test {
  protected:
    const Scene scene_ = mirror_scene();
    const Bvh bvh_ = bvh_of(scene_);
    Renderer renderer_{test_device(), scene_, bvh_, options_with(64)};
    const Frame whole_ = render(scene_);

    Frame stop_after(double share) {
        return renderer_.render([share](double done) { return done < share; });
    }
};

TEST_F(Interrupted, frame_has_whole_pixels_or_none) {
    const Frame frame = stop_after(0.4);
    EXPECT_GE(frame.finished, 0.4);
    EXPECT_LT(frame.finished, 0.6);
    EXPECT_EQ(frame.rays.camera, static_cast<std::uint64_t>(frame.finished * 32 * 24 + 0.5));
    EXPECT_EQ(frame.rays.secondary, frame.rays.camera);  // the mirror image of each is the sky
    std::uint64_t there = 0;
    for (std::size_t i = 0; i < frame.sums.size(); i += FILM_CHANNELS) {
        const bool empty =
            std::all_of(&frame.sums[i], &frame.sums[i] + FILM_CHANNELS, [](cl_long v) { return v == 0; });
        there += !empty;
        for (std::size_t channel = i; !empty && channel < i + FILM_CHANNELS; ++channel)
            ASSERT_EQ(frame.sums[channel], whole_.sums[channel]) << "pixel " << i / FILM_CHANNELS;
    }
    EXPECT_EQ(there, frame.rays.camera);
}

TEST_F(Interrupted, renderer_renders_the_whole_frame_next_time) {
    stop_after(0.1);
    const Frame frame = renderer_.render();
    EXPECT_EQ(frame.finished, 1);
    EXPECT_EQ(frame.hash(), whole_.hash());
    EXPECT_EQ(frame.rays.total(), whole_.rays.total());
}

TEST_F(Interrupted, frame_that_was_already_done_is_whole) {
    const Frame frame = stop_after(1);
    EXPECT_EQ(frame.finished, 1);
    EXPECT_EQ(frame.hash(), whole_.hash());
}

TEST_F(Interrupted, or_not_progress_only_grows_and_ends_with_all) {
    std::vector<double> shares;
    renderer_.render([&](double share) {
        shares.push_back(share);
        return true;
    });
    EXPECT_TRUE(std::ranges::is_sorted(shares));
    EXPECT_EQ(shares.back(), 1);
    EXPECT_GE(shares.size(), 24u);  // 12 batches of camera rays, and their reflections
}

}  // namespace
}  // namespace raymill
