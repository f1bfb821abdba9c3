// The kernels' elementary functions keep the bounds that lib/math.h claims, and random numbers are the host's.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <set>

#include "kernel_rig.hpp"
#include "lib/random.h"
#include "random.hpp"

namespace raymill::test {
namespace {

constexpr double ROUNDING = 0x1p-24;
constexpr double SMALLEST_NORMAL = 0x1p-126;
enum Function : uint { EXP2, LOG2, POWER, EXP_MINUS, COS_SIN, ANGLE_OF, DISK };
using Arguments = std::vector<float>;

std::vector<uint> bits_of(const Arguments& values) {
    std::vector<uint> bits;
    for (const float value : values) bits.push_back(std::bit_cast<uint>(value));
    return bits;
}

/// The function's answers: x and y of each item.
std::vector<glm::dvec2> evaluate(Function function, const Arguments& a, const Arguments& b) {
    const auto items = static_cast<uint>(a.size());
    const std::vector<uint> words =
        run_probe("math_probe.cl", "math_probe", {bits_of(a), bits_of(b)}, items, function, 4 * a.size());
    std::vector<glm::dvec2> results;
    for (std::size_t i = 0; i < a.size(); ++i)
        results.emplace_back(std::bit_cast<float>(words[4 * i]), std::bit_cast<float>(words[4 * i + 1]));
    return results;
}
std::vector<glm::dvec2> evaluate(Function function, const Arguments& a) {
    return evaluate(function, a, a);
}

/// One unit in the last place of a float near x.
double ulp(double x) {
    return std::ldexp(1.0, std::max(std::ilogb(x), -126) - 23);
}

/// `count` floats evenly over [low, high], both ends included.
Arguments evenly(double low, double high, int count) {
    Arguments values;
    for (int i = 0; i < count; ++i) values.push_back(static_cast<float>(low + (high - low) * i / (count - 1)));
    return values;
}

TEST(Math, exp2_is_within_two_units_in_the_last_place) {
    Arguments y = evenly(-126, 127, 1000001);
    for (const float dense : evenly(-1, 1, 200001)) y.push_back(dense);
    const auto results = evaluate(EXP2, y);
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double exact = std::exp2(static_cast<double>(y[i]));
        ASSERT_LE(std::abs(results[i].x - exact), 2 * ulp(exact)) << y[i];
    }
}

TEST(Math, exp2_gives_zero_below_the_normal_numbers) {
    const Arguments y = {-126.00001f, -127, -149, -1000, -3e38f, -INFINITY};
    for (const glm::dvec2& result : evaluate(EXP2, y)) EXPECT_EQ(result.x, 0);
}

TEST(Math, log2_is_within_three_units_in_the_last_place_also_near_one) {
    Arguments x = evenly(0.5, 2, 1000001);
    for (int i = -2000; i <= 2000; ++i) x.push_back(std::bit_cast<float>(std::bit_cast<int>(1.0f) + i));
    Random random(1);
    for (int i = 0; i < 200000; ++i) x.push_back(std::exp2(random.in(-126, 127.99f)));
    const auto results = evaluate(LOG2, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double exact = std::log2(static_cast<double>(x[i]));
        if (exact == 0) {
            ASSERT_EQ(results[i].x, 0) << x[i];
        } else {
            ASSERT_LE(std::abs(results[i].x - exact), 3 * ulp(exact)) << x[i];
        }
    }
}

TEST(Math, power_keeps_its_relative_error_over_cosines_and_shininesses) {
    Random random(2);
    Arguments base, exponent;
    for (int i = 0; i < 400000; ++i) {
        base.push_back(i % 2 ? random.in(0, 1) : 1 - std::exp2(random.in(-24, 0)));
        exponent.push_back(i % 3 ? std::exp2(random.in(-10, 14)) : static_cast<float>(random.below(200)));
    }
    const auto results = evaluate(POWER, base, exponent);
    for (std::size_t i = 0; i < base.size(); ++i) {
        const double x = base[i], a = exponent[i], exact = std::pow(x, a);
        // What lib/math.h claims; the smallest normal number more where the result is flushed to zero.
        const double bound = x > 0 ? exact * (4 + 4 * std::abs(a * std::log2(x))) * ROUNDING : 0;
        ASSERT_LE(std::abs(results[i].x - exact), bound + SMALLEST_NORMAL) << x << "^" << a;
    }
}

TEST(Math, power_of_zero_exponent_is_exactly_one_and_of_zero_base_exactly_zero) {
    const auto results = evaluate(POWER, {0, 0.5f, 1, 0, 0, 1e-40f}, {0, 0, 0, 1, 0.001f, 7});
    const double exact[] = {1, 1, 1, 0, 0, 0};
    for (std::size_t i = 0; i < results.size(); ++i) EXPECT_EQ(results[i].x, exact[i]) << i;
}

TEST(Math, exp_minus_keeps_the_error_of_its_scaled_exponent) {
    Random random(3);
    Arguments x, y;
    for (int i = 0; i < 200000; ++i) {
        x.push_back(random.in(0, 90));
        y.push_back(std::exp2(random.in(-30, 0)));
    }
    const auto results = evaluate(EXP_MINUS, x, y);
    for (std::size_t i = 0; i < x.size(); ++i)
        for (int k = 0; k < 2; ++k) {
            const double argument = k == 0 ? x[i] : y[i], exact = std::exp(-argument);
            // Two roundings of the exponent (its factor and the product), two units in the last place of exp2.
            const double bound = exact * (2 * argument + 4) * ROUNDING;
            ASSERT_LE(std::abs(results[i][k] - exact), bound + SMALLEST_NORMAL) << argument;
        }
}

TEST(Math, cosine_and_sine_of_turns_are_within_2e_7) {
    const Arguments turns = evenly(0, 1, 1000001);
    const auto results = evaluate(COS_SIN, turns);
    for (std::size_t i = 0; i < turns.size(); ++i) {
        const double angle = turns[i] * glm::two_pi<double>();
        ASSERT_NEAR(results[i].x, std::cos(angle), 2e-7) << turns[i];
        ASSERT_NEAR(results[i].y, std::sin(angle), 2e-7) << turns[i];
    }
}

TEST(Math, the_angle_of_a_point_is_within_5e_7) {
    Arguments x, y;
    for (const float angle : evenly(-3.14159, 3.14159, 500001)) {
        const float scale = std::exp2(static_cast<float>(x.size() % 41) - 20);
        x.push_back(scale * std::cos(angle));
        y.push_back(scale * std::sin(angle));
    }
    for (const float axis : {1.0f, -1.0f}) {
        x.insert(x.end(), {axis, 0, axis, axis});
        y.insert(y.end(), {0, axis, axis, -axis});
    }
    const auto results = evaluate(ANGLE_OF, x, y);
    for (std::size_t i = 0; i < x.size(); ++i)
        ASSERT_NEAR(results[i].x, std::atan2(static_cast<double>(y[i]), static_cast<double>(x[i])), 5e-7) << i;
    EXPECT_EQ(evaluate(ANGLE_OF, {0}, {0}).front().x, 0);
}

TEST(Math, the_disk_map_is_the_reference_s) {
    Arguments a, b;
    for (int j = 0; j <= 500; ++j)
        for (int i = 0; i <= 500; ++i) {
            a.push_back(static_cast<float>(i) / 500);
            b.push_back(static_cast<float>(j) / 500);
        }
    const auto results = evaluate(DISK, a, b);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double x = 2.0 * a[i] - 1, y = 2.0 * b[i] - 1;
        const bool wide = std::abs(x) > std::abs(y);
        const double r = wide ? x : y, quarter = glm::pi<double>() / 4;
        const double angle = wide ? quarter * y / x : r == 0 ? 0 : 2 * quarter - quarter * x / y;
        // 2e-7 of cosine and sine, a rounding of the turn (2 pi), and one of each coordinate of the square.
        ASSERT_NEAR(results[i].x, r * std::cos(angle), 7e-7) << a[i] << " " << b[i];
        ASSERT_NEAR(results[i].y, r * std::sin(angle), 7e-7) << a[i] << " " << b[i];
    }
}

TEST(Math, tangents_make_a_right_handed_orthonormal_basis) {
    Random random(4);
    std::vector<glm::vec3> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1e-4f, 0, -1}, {0, 1e-5f, -1}};
    for (int i = 0; i < 100000; ++i) normals.push_back(random.direction());
    Arguments axis[3];
    for (const glm::vec3& n : normals)
        for (int k = 0; k < 3; ++k) axis[k].push_back(n[k]);
    const auto words =
        run_probe("math_probe.cl", "tangents_probe", {bits_of(axis[0]), bits_of(axis[1]), bits_of(axis[2])},
                  static_cast<uint>(normals.size()), 0, 8 * normals.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
        glm::dvec3 t, u;
        for (int k = 0; k < 3; ++k) {
            t[k] = std::bit_cast<float>(words[8 * i + static_cast<std::size_t>(k)]);
            u[k] = std::bit_cast<float>(words[8 * i + 4 + static_cast<std::size_t>(k)]);
        }
        // The normal's length errs by 2 roundings, each component by 4 more; 1 / (1 + |z|) at most doubles nothing.
        const double bound = 16 * ROUNDING;
        const glm::dvec3 handed = glm::cross(t, u) - glm::dvec3(normals[i]);
        ASSERT_NEAR(glm::length(t), 1, bound) << i;
        ASSERT_NEAR(glm::length(u), 1, bound) << i;
        ASSERT_LE(glm::length(handed), 2 * bound) << i;
    }
}

TEST(RandomNumbers, stratified_points_are_bit_for_bit_those_of_the_host) {
    Random random(5);
    std::vector<uint> index, key;
    for (int i = 0; i < 100000; ++i) {
        index.push_back(random.bits() >> random.below(32));
        key.push_back(random.bits());
    }
    const auto words = run_probe("math_probe.cl", "stratified_probe", {index, key}, static_cast<uint>(index.size()), 0,
                                 2 * index.size());
    for (std::size_t i = 0; i < index.size(); ++i) {
        uint x = 0, y = 0;
        stratified_point(index[i], key[i], &x, &y);
        ASSERT_EQ(words[2 * i], x) << i;
        ASSERT_EQ(words[2 * i + 1], y) << i;
        ASSERT_LT(x, 1u << 24);
        ASSERT_LT(y, 1u << 24);
    }
}

TEST(RandomNumbers, every_stratum_holds_exactly_one_point) {
    for (const uint bits : {0u, 1u, 2u, 3u, 5u, 8u})
        for (const uint first : {0u, 1u << bits, 5u << bits}) {
            const uint count = 1u << bits;
            std::vector<uint> index, keys(count, 77 * count + first);
            for (uint i = 0; i < count; ++i) index.push_back(first + i);
            const auto words = run_probe("math_probe.cl", "stratified_probe", {index, keys}, count, 0, 2 * count);
            for (uint columns = 0; columns <= bits; ++columns) {  // 2^columns by 2^(bits - columns) cells
                std::set<std::pair<uint, uint>> cells;
                for (uint i = 0; i < count; ++i)
                    cells.emplace(words[2 * i] >> (24 - columns), words[2 * i + 1] >> (24 - (bits - columns)));
                EXPECT_EQ(cells.size(), count) << "of " << (1u << columns) << " columns";
            }
        }
}

}  // namespace
}  // namespace raymill::test
