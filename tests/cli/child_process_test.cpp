// Programs beside this one.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/child_process.hpp"
#include "image/temporary_folder.hpp"

namespace raymill {
namespace {

TEST(ChildProcess, has_ended_when_it_is_gone) {
    const TemporaryFolder folder;
    const std::string file = folder.file("made");
    { const ChildProcess child({"/bin/sh", "-c", "sleep 0.1; printf done > \"$0\"", file}); }
    EXPECT_EQ(read_bytes(file), "done");
}

TEST(ChildProcess, that_does_not_exist_is_done_without) {
    const TemporaryFolder folder;
    { const ChildProcess child({folder.file("nothing")}); }
    EXPECT_EQ(folder.entries(), 0);
}

TEST(ChildProcess, can_be_this_program) {
    EXPECT_TRUE(std::filesystem::exists(this_program()));
}

}  // namespace
}  // namespace raymill
