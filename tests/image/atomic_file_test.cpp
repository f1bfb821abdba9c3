// Output files appear whole or not at all, whatever goes wrong.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <functional>

#include "common/files.hpp"
#include "image/image.hpp"
#include "temporary_folder.hpp"

namespace raymill {
namespace {

namespace fs = std::filesystem;

std::function<void(const std::string&)> writer_of(const std::string& text) {
    return [text](const std::string& temporary) { write_text(temporary, text); };
}

/// The message of the OutputError that `action` throws.
std::string output_error(const std::function<void()>& action) {
    try {
        action();
    } catch (const OutputError& error) {
        return error.what();
    }
    ADD_FAILURE() << "no OutputError was thrown";
    return {};
}

/// Both ways to ask for `file` must fail, with a message that contains `words`.
void expect_unwritable(const std::string& file, const std::string& words) {
    bool called = false;
    const std::string written =
        output_error([&] { write_atomically(file, [&](const std::string&) { called = true; }); });
    EXPECT_FALSE(called) << "the writer ran although nothing could be written";
    for (const std::string& message : {written, output_error([&] { check_writable(file); })}) {
        EXPECT_EQ(message.rfind("Cannot write '" + file + "': ", 0), 0u) << message;
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.back(), '.');
    }
}

/// For tests of permissions, which the superuser does not feel.
class WithoutPrivileges {
  public:
    WithoutPrivileges() : user_(::geteuid()) {
        constexpr uid_t nobody = 65534;
        if (user_ == 0 && ::seteuid(nobody) != 0) throw std::system_error(errno, std::generic_category(), "seteuid");
    }
    ~WithoutPrivileges() { static_cast<void>(::seteuid(user_) == 0); }

  private:
    uid_t user_;
};

/// No file grows beyond `bytes`: what a full disk does to a writer, at a place of our choice.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit before_{};
    void (*handler_)(int);
};

/// Values that do not compress, so that a file of this picture is larger than any buffer.
Image noise(int width, int height) {
    Image image{width, height, {}};
    std::uint32_t state = 1;
    for (int i = 0; i < 4 * width * height; ++i) {
        state = state * 1664525u + 1013904223u;
        image.rgba.push_back(static_cast<float>(state >> 8) / 16777216.0f);
    }
    return image;
}

ImageMetadata metadata_of(const Image& image) {
    ImageMetadata metadata;
    metadata.full_width = image.width;
    metadata.full_height = image.height;
    return metadata;
}

TEST(write_atomically, leaves_the_new_file_and_nothing_else) {
    const TemporaryFolder folder;
    write_atomically(folder.file("out"), writer_of("new"));
    EXPECT_EQ(read_bytes(folder.file("out")), "new");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(write_atomically, replaces_an_old_file_only_when_the_new_one_is_complete) {
    const TemporaryFolder folder;
    write_text(folder.file("out"), "old");
    write_atomically(folder.file("out"), [&](const std::string& temporary) {
        EXPECT_EQ(fs::path(temporary).parent_path(), folder.path());
        EXPECT_EQ(read_bytes(temporary), "");
        write_text(temporary, "new");
        EXPECT_EQ(read_bytes(folder.file("out")), "old");
    });
    EXPECT_EQ(read_bytes(folder.file("out")), "new");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(write_atomically, a_writer_that_throws_leaves_the_old_file_and_no_temporary) {
    const TemporaryFolder folder;
    write_text(folder.file("out"), "old");
    EXPECT_THROW(write_atomically(folder.file("out"),
                                  [](const std::string& temporary) {
                                      write_text(temporary, "half of the new");
                                      throw std::domain_error("the writer's own exception");
                                  }),
                 std::domain_error);
    EXPECT_EQ(read_bytes(folder.file("out")), "old");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(write_atomically, a_writer_that_throws_leaves_an_empty_folder_empty) {
    const TemporaryFolder folder;
    EXPECT_THROW(write_atomically(folder.file("out"), [](const std::string&) { throw std::domain_error(""); }),
                 std::domain_error);
    EXPECT_EQ(folder.entries(), 0);
}

TEST(write_atomically, a_writer_that_removes_its_file_is_an_error) {
    const TemporaryFolder folder;
    const std::string message = output_error(
        [&] { write_atomically(folder.file("out"), [](const std::string& temporary) { fs::remove(temporary); }); });
    EXPECT_NE(message.find("No such file"), std::string::npos) << message;
    EXPECT_EQ(folder.entries(), 0);
}

TEST(write_atomically, writes_that_nest_do_not_disturb_each_other) {
    const TemporaryFolder folder;
    write_atomically(folder.file("a"), [&](const std::string& temporary) {
        write_atomically(folder.file("b"), writer_of("b"));
        write_atomically(temporary, writer_of("a"));
    });
    EXPECT_EQ(read_bytes(folder.file("a")), "a");
    EXPECT_EQ(read_bytes(folder.file("b")), "b");
    EXPECT_EQ(folder.entries(), 2);
}

TEST(write_atomically, a_new_file_gets_the_permissions_that_the_user_asks_of_new_files) {
    const TemporaryFolder folder;
    const mode_t before = ::umask(027);
    write_atomically(folder.file("out"), writer_of("new"));
    ::umask(before);
    EXPECT_EQ(fs::status(folder.file("out")).permissions(), fs::perms(0640));
}

TEST(write_atomically, an_existing_file_keeps_its_permissions) {
    const TemporaryFolder folder;
    write_text(folder.file("out"), "old");
    fs::permissions(folder.file("out"), fs::perms(0604));
    write_atomically(folder.file("out"), writer_of("new"));
    EXPECT_EQ(fs::status(folder.file("out")).permissions(), fs::perms(0604));
}

TEST(write_atomically, follows_a_chain_of_symbolic_links_to_the_file) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "real");
    write_text(folder.file("real/out"), "old");
    fs::create_symlink("real/out", folder.path() / "link");
    fs::create_symlink(folder.path() / "link", folder.path() / "link to link");
    write_atomically(folder.file("link to link"), writer_of("new"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link to link"));
    EXPECT_EQ(read_bytes(folder.file("real/out")), "new");
    EXPECT_EQ(folder.entries(), 3);
}

TEST(write_atomically, creates_the_file_that_a_dangling_link_points_to) {
    const TemporaryFolder folder;
    fs::create_symlink("out", folder.path() / "link");
    write_atomically(folder.file("link"), writer_of("new"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    EXPECT_FALSE(fs::is_symlink(folder.path() / "out"));
    EXPECT_EQ(read_bytes(folder.file("out")), "new");
}

TEST(write_atomically, a_pipe_receives_the_bytes) {
    const TemporaryFolder folder;
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    write_atomically("/proc/self/fd/" + std::to_string(ends[1]), writer_of("new"));
    ::close(ends[1]);
    char text[8] = {};
    EXPECT_EQ(::read(ends[0], text, sizeof text), 3);
    EXPECT_STREQ(text, "new");
    ::close(ends[0]);
}

TEST(write_atomically, a_device_that_is_full_is_an_error_and_stays_a_device) {
    if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    const std::string message = output_error([] { write_atomically("/dev/full", writer_of("new")); });
    EXPECT_NE(message.find("No space left on device"), std::string::npos) << message;
    EXPECT_NE(message.find("free some space"), std::string::npos) << message;
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(write_atomically, refuses_a_folder) {
    const TemporaryFolder folder;
    expect_unwritable(folder.path().string(), "it is a folder; name a file in it");
    expect_unwritable(folder.path().string() + "/", "it is a folder; name a file in it");
    EXPECT_EQ(folder.entries(), 0);
}

TEST(write_atomically, names_the_folder_that_is_missing) {
    const TemporaryFolder folder;
    expect_unwritable(folder.file("no/out.exr"), "the folder '" + folder.file("no") + "' does not exist; create it");
    EXPECT_EQ(folder.entries(), 0);
}

TEST(write_atomically, refuses_a_file_in_the_place_of_a_folder) {
    const TemporaryFolder folder;
    write_text(folder.file("a"), "a");
    expect_unwritable(folder.file("a/out.exr"), "Not a directory");
}

TEST(write_atomically, refuses_links_that_go_in_circles) {
    const TemporaryFolder folder;
    fs::create_symlink("b", folder.path() / "a");
    fs::create_symlink("a", folder.path() / "b");
    expect_unwritable(folder.file("a"), "symbolic links");
}

TEST(write_atomically, refuses_an_empty_name) {
    expect_unwritable("", "the name is empty");
}

TEST(write_atomically, refuses_a_name_that_is_too_long) {
    const TemporaryFolder folder;
    expect_unwritable(folder.file(std::string(300, 'x')), "File name too long");
    EXPECT_EQ(folder.entries(), 0);
}

TEST(write_atomically, accepts_the_longest_name) {
    const TemporaryFolder folder;
    const std::string file = folder.file(std::string(255, 'x'));
    write_atomically(file, writer_of("new"));
    EXPECT_EQ(read_bytes(file), "new");
}

TEST(write_atomically, refuses_a_folder_without_write_permission) {
    const TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms(0555));
    {
        const WithoutPrivileges ordinary_user;
        expect_unwritable(folder.file("out.exr"), "change its permissions or choose another folder");
    }
    fs::permissions(folder.path(), fs::perms(0755));
    EXPECT_EQ(folder.entries(), 0);
}

TEST(write_atomically, refuses_to_replace_a_write_protected_file) {
    const TemporaryFolder folder;
    write_text(folder.file("out.exr"), "precious");
    fs::permissions(folder.file("out.exr"), fs::perms(0444));
    fs::permissions(folder.path(), fs::perms(0777));
    {
        const WithoutPrivileges ordinary_user;
        expect_unwritable(folder.file("out.exr"), "Permission denied; change the permissions");
    }
    EXPECT_EQ(read_bytes(folder.file("out.exr")), "precious");
}

TEST(check_writable, accepts_and_changes_nothing) {
    const TemporaryFolder folder;
    check_writable(folder.file("out.exr"));
    EXPECT_EQ(folder.entries(), 0);

    write_text(folder.file("out.exr"), "old");
    const fs::file_time_type before = fs::last_write_time(folder.file("out.exr"));
    check_writable(folder.file("out.exr"));
    EXPECT_EQ(read_bytes(folder.file("out.exr")), "old");
    EXPECT_EQ(fs::last_write_time(folder.file("out.exr")), before);
    EXPECT_EQ(folder.entries(), 1);
}

TEST(check_writable, accepts_a_file_in_the_current_folder) {
    const TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    EXPECT_NO_THROW(check_writable("out.exr"));
    write_atomically("out.exr", writer_of("new"));
    fs::current_path(before);
    EXPECT_EQ(read_bytes(folder.file("out.exr")), "new");
}

// The limits cut the files in the header, in the pixels, and where only the last buffer is missing.
TEST(full_disk, an_exr_that_does_not_fit_leaves_the_old_file_and_no_temporary) {
    const Image image = noise(64, 64);
    const TemporaryFolder folder;
    const std::string file = folder.file("out.exr");
    write_exr(file, image, {}, metadata_of(image), ExrPixels::float32);
    const auto size = static_cast<rlim_t>(fs::file_size(file));
    write_text(file, "old");
    for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, size / 2, size - 1}) {
        const std::string message = output_error([&] {
            const FileSizeLimit full(limit);
            write_exr(file, image, {}, metadata_of(image), ExrPixels::float32);
        });
        EXPECT_NE(message.find("free some space"), std::string::npos) << message;
        EXPECT_EQ(read_bytes(file), "old") << limit;
        EXPECT_EQ(folder.entries(), 1) << limit;
    }
}

TEST(full_disk, a_png_that_does_not_fit_leaves_the_old_file_and_no_temporary) {
    const Image image = noise(64, 64);
    const TemporaryFolder folder;
    const std::string file = folder.file("out.png");
    write_png(file, image, 0);
    const auto size = static_cast<rlim_t>(fs::file_size(file));
    write_text(file, "old");
    for (const rlim_t limit : {rlim_t{0}, rlim_t{20}, size / 2, size - 1}) {
        const std::string message = output_error([&] {
            const FileSizeLimit full(limit);
            write_png(file, image, 0);
        });
        EXPECT_NE(message.find("free some space"), std::string::npos) << message;
        EXPECT_EQ(read_bytes(file), "old") << limit;
        EXPECT_EQ(folder.entries(), 1) << limit;
    }
}

TEST(image_format, follows_the_extension_in_any_case) {
    EXPECT_EQ(image_format("a.exr"), ImageFormat::exr);
    EXPECT_EQ(image_format("a.b/c.d.EXR"), ImageFormat::exr);
    EXPECT_EQ(image_format("a.Png"), ImageFormat::png);
}

TEST(image_format, refuses_what_it_does_not_know) {
    for (const char* file : {"a.jpg", "a", "", ".exr", "exr", "a.exr/", "a.exr.gz", "a.exr/b"})
        EXPECT_THROW(image_format(file), UsageError) << file;
}

}  // namespace
}  // namespace raymill
