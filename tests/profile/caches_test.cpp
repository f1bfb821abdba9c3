// The processor's caches, as Linux lists them.
#include "device/caches.hpp"

#include <gtest/gtest.h>

#include "image/temporary_folder.hpp"

namespace raymill {
namespace {

void add_cache(const TemporaryFolder& folder, int index, const std::vector<std::string>& values) {
    const std::filesystem::path place = folder.path() / ("index" + std::to_string(index));
    std::filesystem::create_directory(place);
    const char* names[] = {"level", "type", "size", "shared_cpu_list"};
    for (std::size_t i = 0; i < 4; ++i) write_text((place / names[i]).string(), values[i] + "\n");
}

TEST(Caches, are_those_that_hold_data_from_small_to_large) {
    const TemporaryFolder folder;
    add_cache(folder, 0, {"3", "Unified", "36M", "0-7,16-23"});
    add_cache(folder, 1, {"1", "Data", "48K", "0,16"});
    add_cache(folder, 2, {"1", "Instruction", "32K", "0,16"});
    add_cache(folder, 3, {"2", "Unified", "2048K", "0,16"});
    const std::vector<ProcessorCache> caches = processor_caches(folder.path().string());
    ASSERT_EQ(caches.size(), 3u);
    EXPECT_EQ(caches[0].name, "L1d");
    EXPECT_EQ(caches[0].bytes, 48u << 10);
    EXPECT_EQ(caches[0].sharers, 2u);
    EXPECT_EQ(caches[1].name, "L2");
    EXPECT_EQ(caches[1].bytes, 2u << 20);
    EXPECT_EQ(caches[2].name, "L3");
    EXPECT_EQ(caches[2].bytes, 36u << 20);
    EXPECT_EQ(caches[2].sharers, 16u);
}

TEST(Caches, are_none_where_the_system_does_not_tell) {
    const TemporaryFolder folder;
    EXPECT_TRUE(processor_caches(folder.path().string()).empty());
}

TEST(Caches, that_name_no_thread_belong_to_one) {
    EXPECT_EQ(count_threads(""), 1u);
    EXPECT_EQ(count_threads("5"), 1u);
    EXPECT_EQ(count_threads("0-3,8"), 5u);
}

}  // namespace
}  // namespace raymill
