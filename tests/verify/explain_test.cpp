// The ray tree of a pixel, and what is told of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "frame.hpp"
#include "verify/explanation.hpp"

namespace raymill::verify {
namespace {

struct Pixel {
    int x, y;
};
// On the glass ball, the prism, the mirror ball, the post, the floor and the background.
const Pixel pixels[] = {{15, 10}, {11, 12}, {6, 8}, {18, 8}, {3, 16}, {12, 0}};

RayTree tree_of(Scene scene, Pixel pixel) {
    crop_to_pixel(scene.settings, pixel.x, pixel.y);
    TestFrame frame(std::move(scene));
    return trace_pixel(frame.device, frame.renderer);
}

std::string text_of(const Scene& scene, const RayTree& tree, std::optional<std::uint32_t> sample = {}) {
    const reference::Tracer tracer(scene);
    return explanation_text({scene, tracer}, tree, sample);
}

std::size_t count_of(const std::string& text, const std::string& word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
}

TEST(Explain, what_the_rays_add_is_the_pixel_of_the_whole_picture_to_the_last_integer) {
    TestFrame whole(branching_scene());
    const Frame frame = whole.renderer.render();
    for (const Pixel& pixel : pixels) {
        const RayTree tree = tree_of(whole.scene, pixel);
        EXPECT_TRUE(tree.sums_agree());
        const auto beauty = frame.plane(FILM_BEAUTY);
        const std::size_t first = static_cast<std::size_t>(pixel.y * 24 + pixel.x) * FILM_CHANNELS;
        for (std::size_t c = 0; c < FILM_CHANNELS; ++c)
            EXPECT_EQ(tree.booked[c], beauty[first + c]) << pixel.x << "," << pixel.y << " channel " << c;
    }
}

TEST(Explain, every_ray_but_the_camera_s_is_a_child_of_one_hit) {
    const RayTree tree = tree_of(branching_scene(), pixels[0]);
    EXPECT_EQ(tree.roots.size(), 2u);
    EXPECT_GT(tree.nodes.size(), 8u);
    std::vector<int> parents(tree.nodes.size(), 0);
    for (const RayNode& node : tree.nodes)
        for (const auto& child : {node.reflected, node.refracted})
            if (child) {
                ++parents[*child];
                EXPECT_EQ(tree.nodes[*child].depth, node.depth + 1);
                EXPECT_EQ(tree.nodes[*child].ray.sample, node.ray.sample);
            }
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
        EXPECT_EQ(parents[i], std::ranges::count(tree.roots, i) > 0 ? 0 : 1) << i;
}

TEST(Explain, the_tree_does_not_depend_on_the_queue_s_capacity) {
    Scene scene = branching_scene();
    crop_to_pixel(scene.settings, pixels[0].x, pixels[0].y);
    TestFrame wide(scene, {}, 256), narrow(scene, {}, 1);
    const RayTree a = trace_pixel(wide.device, wide.renderer), b = trace_pixel(narrow.device, narrow.renderer);
    EXPECT_EQ(text_of(scene, a), text_of(scene, b));
}

TEST(Explain, the_text_says_how_the_sum_compares_and_how_branches_end) {
    const Scene scene = branching_scene();
    const std::string text = text_of(scene, tree_of(scene, pixels[0]));
    EXPECT_EQ(count_of(text, "): equal\n"), 1u);
    EXPECT_GE(count_of(text, "refracted ray, depth 1"), 1u);
    EXPECT_GE(count_of(text, "ends: the recursion limit is 3"), 1u);
    EXPECT_GE(count_of(text, "n1 1, n2 1.5, theta1"), 1u);
    EXPECT_GE(count_of(text, "sphere \"ball of glass\", material \"glass\""), 1u);
}

TEST(Explain, a_pixel_of_the_background_ends_at_once) {
    const Scene scene = branching_scene();
    const std::string text = text_of(scene, tree_of(scene, {0, 0}));
    EXPECT_EQ(count_of(text, "hits nothing; the background adds (0.1, 0.2, 0.4)"), 2u);
}

TEST(Explain, lights_are_counted_from_1_as_the_scene_file_s_errors_do) {
    const Scene scene = branching_scene();  // the first of its five lights is ambient, the last directional
    const std::string text = text_of(scene, tree_of(scene, pixels[4]));
    EXPECT_EQ(count_of(text, "light 0,"), 0u);
    EXPECT_EQ(count_of(text, "light 1,"), 0u);
    EXPECT_GE(count_of(text, "light 2, point"), 1u);
    EXPECT_GE(count_of(text, "light 5, directional"), 1u);
}

TEST(Explain, lines_fit_a_terminal) {
    const Scene scene = branching_scene();
    for (const Pixel& pixel : pixels) {
        std::istringstream lines(text_of(scene, tree_of(scene, pixel)));
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 110u) << line;
    }
}

TEST(Explain, one_sample_leaves_the_others_out_but_not_out_of_the_sum) {
    const Scene scene = branching_scene();
    const RayTree tree = tree_of(scene, pixels[0]);
    const std::string text = text_of(scene, tree, 1);
    EXPECT_EQ(count_of(text, "sample 1\n"), 1u);
    EXPECT_EQ(count_of(text, "sample 0\n"), 0u);
    EXPECT_EQ(count_of(text, "): equal\n"), 1u);
}

TEST(Explain, each_ray_and_shadow_ray_is_a_line_of_the_obj_file) {
    const Scene scene = branching_scene();
    const RayTree tree = tree_of(scene, pixels[0]);
    const reference::Tracer tracer(scene);
    const std::string lines = ray_lines({scene, tracer}, tree, {}, 10);
    std::size_t rays = tree.nodes.size();
    for (const RayNode& node : tree.nodes) rays += node.shadow_rays.size();
    EXPECT_EQ(count_of(lines, "\nl -2 -1\n"), rays);
    EXPECT_EQ(count_of(lines, "# sample "), rays);
    EXPECT_EQ(count_of("\n" + lines, "\nv "), 2 * rays);
}

TEST(Explain, what_blocks_a_shadow_ray_is_the_first_opaque_thing_behind_the_filters) {
    const Scene scene = branching_scene();
    const reference::Tracer tracer(scene);
    // From in front of the glass ball straight through it, towards the mirror ball's height behind.
    ShadowRay ray{};
    ray.origin[0] = 0.8f;
    ray.origin[1] = 0.7f;
    ray.origin[2] = 3;
    ray.direction[2] = -1;
    ray.t_max = 100;
    const Passage through = passage_of({scene, tracer}, ray);
    EXPECT_EQ(through.filters.size(), 2u);  // into the ball and out of it
    EXPECT_FALSE(through.blocker);
    ray.origin[0] = -1.1f;
    const Passage stopped = passage_of({scene, tracer}, ray);
    ASSERT_TRUE(stopped.blocker);
    EXPECT_NEAR(stopped.blocker->t, 3 + 0.4 - std::sqrt(0.64 - 0.01), 1e-6);  // the coordinates are floats
}

TEST(Explain, snell_s_angles_obey_the_law) {
    const Scene scene = branching_scene();
    const reference::Tracer tracer(scene);
    const RayTree tree = tree_of(scene, pixels[0]);
    int refractions = 0;
    for (const RayNode& node : tree.nodes) {
        if (node.hit.primitive == NO_INDEX || !node.refracted) continue;
        const Truth truth{scene, tracer};
        const Snell snell = snell_at(truth, hit_context(truth, node.ray, node.hit));
        ASSERT_TRUE(snell.refracted);
        ++refractions;
        // Directions of the queue are unit to single precision.
        EXPECT_NEAR(snell.n1 * std::sin(glm::radians(snell.incident)),
                    snell.n2 * std::sin(glm::radians(*snell.refracted)), 1e-6);
    }
    EXPECT_GE(refractions, 2);
}

}  // namespace
}  // namespace raymill::verify
