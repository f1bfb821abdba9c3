// What changes a digest, and what does not.
#include "capture/digest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "capture/capture_file.hpp"
#include "support/queues.hpp"

namespace raymill::capture {
namespace {

std::vector<Ray> some_rays() {
    std::vector<Ray> rays;
    for (uint i = 0; i < 5; ++i) rays.push_back(test::make_ray({1, 2, 3}, {0, 0, 1}, i));
    return rays;
}

std::uint64_t digest(const std::vector<Ray>& rays) {
    return digest_of(std::span<const Ray>(rays));
}

TEST(Digest, of_rays_does_not_depend_on_their_order) {
    std::vector<Ray> rays = some_rays();
    const std::uint64_t before = digest(rays);
    std::ranges::reverse(rays);
    EXPECT_EQ(digest(rays), before);
}

TEST(Digest, changes_with_every_bit_of_a_ray) {
    std::set<std::uint64_t> seen = {digest(some_rays())};
    for (std::size_t bit = 0; bit < 8 * sizeof(Ray); ++bit) {
        std::vector<Ray> rays = some_rays();
        unsigned char bytes[sizeof(Ray)];
        std::memcpy(bytes, &rays[2], sizeof(Ray));
        bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8);
        std::memcpy(&rays[2], bytes, sizeof(Ray));
        EXPECT_TRUE(seen.insert(digest(rays)).second) << "bit " << bit;
    }
}

TEST(Digest, tells_a_ray_that_came_twice) {
    std::vector<Ray> rays = some_rays();
    const std::uint64_t once = digest(rays);
    rays.push_back(rays.front());
    EXPECT_NE(digest(rays), once);
    rays.push_back(rays.front());
    rays.push_back(rays.front());
    EXPECT_NE(digest(rays), once);  // unlike with exclusive or
}

TEST(Digest, of_hits_depends_on_their_order_and_adds_up_from_parts) {
    const std::vector<Hit> hits = {{1, 0, 0, 7}, {2, 0, 0, 7}, {3, 0.5f, 0, 8}};
    const std::vector<Hit> swapped = {hits[1], hits[0], hits[2]};
    const std::uint64_t whole = digest_of(std::span<const Hit>(hits));
    EXPECT_NE(digest_of(std::span<const Hit>(swapped)), whole);
    EXPECT_EQ(digest_of(std::span(hits).first(2)) + digest_of(std::span(hits).subspan(2), 2), whole);
}

TEST(Digest, of_the_film_depends_on_places_sums_and_counters) {
    const std::vector<cl_long> sums = {0, 5, -3, 0}, moved = {5, 0, -3, 0}, other = {0, 5, 3, 0};
    const Counters none{};
    Counters blocked{};
    blocked.shadow_blocked = 1;
    const auto of = [](const std::vector<cl_long>& s, const Counters& c) {
        return digest_of(std::span<const cl_long>(s), c);
    };
    const std::set<std::uint64_t> digests = {of(sums, none), of(moved, none), of(other, none), of(sums, blocked)};
    EXPECT_EQ(digests.size(), 4u);
}

TEST(LayoutHash, changes_with_declarations_but_not_with_comments_and_spaces) {
    const std::uint64_t hash = layout_hash("typedef struct {\n    float t;  // distance\n} Hit;\n");
    EXPECT_EQ(layout_hash("// A hit.\ntypedef struct { float t; } Hit; // end"), hash);
    EXPECT_NE(layout_hash("typedef struct {\n    float t;\n    float u;\n} Hit;\n"), hash);
    EXPECT_NE(layout_hash("typedef struct {\n    uint t;\n} Hit;\n"), hash);
}

}  // namespace
}  // namespace raymill::capture
