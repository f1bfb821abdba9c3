// Which kernels of a memory map are compiled kernels, and which of them are new.
#include "device/kernel_cache.hpp"

#include <gtest/gtest.h>

#include "image/temporary_folder.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

TEST(KernelCache, tells_kernels_that_are_older_than_the_run_from_those_it_built) {
    const TemporaryFolder folder;
    const fs::file_time_type now = fs::file_time_type::clock::now();
    std::string map = "7f00 r-xp 00000000 08:01 1    /usr/lib/libc.so.6\n7f01 rw-p 00000000 00:00 0 \n";
    for (const char* name : {"shade", "shadow"}) {
        fs::create_directories(folder.path() / name / "64-1-1");
        const fs::path file = folder.path() / name / "64-1-1" / (std::string(name) + ".so");
        write_text(file.string(), "");
        map += "7f02 r-xp 00000000 08:01 2    " + file.string() + "\n7f03 r--p 00001000 08:01 2    " + file.string() +
               "\n";
    }
    fs::last_write_time(folder.path() / "shade/64-1-1/shade.so", now - std::chrono::hours(1));
    fs::last_write_time(folder.path() / "shadow/64-1-1/shadow.so", now + std::chrono::seconds(1));
    const std::vector<LoadedKernel> kernels = loaded_kernels(map, now);
    ASSERT_EQ(kernels.size(), 2u) << "a kernel has several lines";
    EXPECT_EQ(kernels[0].name, "shade");
    EXPECT_FALSE(kernels[0].built);
    EXPECT_EQ(kernels[1].name, "shadow");
    EXPECT_TRUE(kernels[1].built);
}

TEST(KernelCache, knows_nothing_of_a_map_without_kernels) {
    EXPECT_TRUE(loaded_kernels("", fs::file_time_type::clock::now()).empty());
    EXPECT_TRUE(loaded_kernels("7f00 r-xp 0 08:01 1 /lib/plugin.so\n", fs::file_time_type::clock::now()).empty());
}

}  // namespace
}  // namespace raymill
