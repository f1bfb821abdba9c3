// The structs of layout.h have the same bytes on both sides of the border.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "kernel_rig.hpp"

namespace raymill::test {
namespace {

struct Expected {
    std::string what;
    std::size_t value;
};

struct Layout {
    std::vector<Expected> words;                      // in the order of the probe
    std::vector<std::pair<std::string, long>> holes;  // bytes of a struct that no listed member covers
};

Layout host_layout() {
    Layout layout;
#define STRUCT(type)                                          \
    layout.words.push_back({"size of " #type, sizeof(type)}); \
    layout.holes.emplace_back(#type, static_cast<long>(sizeof(type)));
#define MEMBER(type, member)                                                          \
    layout.words.push_back({"offset of " #type "." #member, offsetof(type, member)}); \
    layout.words.push_back({"size of " #type "." #member, sizeof(type::member)});     \
    layout.holes.back().second -= static_cast<long>(sizeof(type::member));
#include "layout_members.h"
#undef STRUCT
#undef MEMBER
    return layout;
}

TEST(Layout, the_device_lays_out_every_member_like_the_host) {
    const Layout host = host_layout();
    const std::vector<uint> device = run_probe("layout_probe.cl", "layout_probe", {}, 1, 0, host.words.size());
    for (std::size_t i = 0; i < host.words.size(); ++i) EXPECT_EQ(device[i], host.words[i].value) << host.words[i].what;
    EXPECT_TRUE(is_untouched(device[host.words.size()])) << "the probe knows more members";
}

TEST(Layout, the_list_of_members_leaves_no_byte_of_a_struct_out) {
    const Layout host = host_layout();
    ASSERT_EQ(host.holes.size(), 17u);  // structs in layout.h
    for (const auto& [name, bytes] : host.holes) EXPECT_EQ(bytes, 0) << name;
}

}  // namespace
}  // namespace raymill::test
