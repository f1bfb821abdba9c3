// Files that appear whole or not at all: written beside their place, flushed to the disk, then renamed.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

#include "common/files.hpp"
#include "common/output_error.hpp"

namespace raymill {

namespace {

namespace fs = std::filesystem;

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
  public:
    explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
    ~Descriptor() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return descriptor_; }
    bool valid() const { return descriptor_ >= 0; }

  private:
    int descriptor_;
};

/// A new empty file, removed at the end of its scope unless it was renamed.
class TemporaryFile {
  public:
    /// For a write to `file`, which the error names.
    TemporaryFile(const fs::path& folder, const std::string& file) {
        std::random_device random;
        int descriptor = -1;
        do {  // a name that is taken belongs to someone else: try the next
            path_ = (folder / fmt::format(".raymill-{:08x}{:08x}.tmp", random(), random())).string();
            descriptor = ::open(path_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
        } while (descriptor < 0 && errno == EEXIST);
        if (descriptor < 0) {
            const int error_number = errno;
            path_.clear();
            if (error_number == EACCES || error_number == EPERM || error_number == EROFS)
                throw write_error(file, fmt::format("no file can be created in the folder '{}' ({}); "
                                                    "change its permissions or choose another folder",
                                                    folder.string(), std::generic_category().message(error_number)));
            throw write_error(file, error_number);
        }
        ::close(descriptor);
    }
    ~TemporaryFile() {
        if (!path_.empty()) ::unlink(path_.c_str());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& path() const { return path_; }

    /// 0, or errno.
    int rename_to(const fs::path& target) {
        if (std::rename(path_.c_str(), target.c_str()) != 0) return errno;
        path_.clear();
        return 0;
    }

  private:
    std::string path_;
};

/// Where a write to a name ends up.
struct Target {
    fs::path path;  // symbolic links followed
    bool exists = false;
    bool regular = true;     // else a device, pipe or socket, which cannot be replaced by renaming
    mode_t permissions = 0;  // of an existing file
};

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// The end of a chain of symbolic links; the last one may point to a file that does not exist yet.
fs::path follow_links(const std::string& file) {
    constexpr int longest_chain = 40;  // Linux's own limit
    fs::path path = file;
    for (int i = 0; i <= longest_chain; ++i) {
        std::error_code not_a_link;
        const fs::path next = fs::read_symlink(path, not_a_link);
        if (not_a_link) return path;
        path = folder_of(path) / next;  // an absolute link replaces the folder
    }
    throw write_error(file, ELOOP);
}

/// Finds out what stands at `file`. Throws OutputError where nothing could be written.
Target find_target(const std::string& file) {
    if (file.empty()) throw write_error(file, "the name is empty; name a file");
    Target target;
    struct stat status {};
    if (::stat(file.c_str(), &status) == 0) {
        target.exists = true;
        target.regular = S_ISREG(status.st_mode);
        target.permissions = status.st_mode & 07777;
        if (S_ISDIR(status.st_mode)) throw write_error(file, "it is a folder; name a file in it");
        if (::faccessat(AT_FDCWD, file.c_str(), W_OK, AT_EACCESS) != 0) throw write_error(file, errno);
    } else if (errno != ENOENT) {
        throw write_error(file, errno);
    }
    target.path = target.regular ? follow_links(file) : fs::path(file);
    const fs::path folder = folder_of(target.path);
    if (!target.exists && ::stat(folder.c_str(), &status) != 0 && errno == ENOENT)
        throw write_error(file,
                          fmt::format("the folder '{}' does not exist; create it or choose another", folder.string()));
    if (!target.path.has_filename()) throw write_error(file, "it names a folder; name a file in it");
    return target;
}

/// Waits until the file's bytes are on the disk.
void flush_to_disk(const std::string& path, const std::string& file) {
    const Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!descriptor.valid()) throw write_error(file, errno);
    if (::fsync(descriptor.get()) != 0 && errno != EINVAL)  // EINVAL: this file system has no such thing
        throw write_error(file, errno);
}

/// Copies the bytes of `source` to a device or pipe.
void copy_bytes(const std::string& source, const std::string& file) {
    const Descriptor in(::open(source.c_str(), O_RDONLY | O_CLOEXEC));
    const Descriptor out(::open(file.c_str(), O_WRONLY | O_CLOEXEC));
    if (!in.valid() || !out.valid()) throw write_error(file, errno);
    char buffer[1 << 16];
    for (;;) {
        const ssize_t count = ::read(in.get(), buffer, sizeof buffer);
        if (count < 0) throw write_error(file, errno);
        if (count == 0) return;
        for (ssize_t done = 0; done < count;) {
            const ssize_t written = ::write(out.get(), buffer + done, static_cast<std::size_t>(count - done));
            if (written < 0 && errno != EINTR) throw write_error(file, errno);
            done += std::max<ssize_t>(written, 0);
        }
    }
}

}  // namespace

void write_atomically(const std::string& file, const std::function<void(const std::string& temporary)>& write) {
    const Target target = find_target(file);
    if (!target.regular) {
        std::error_code missing;
        const fs::path folder = fs::temp_directory_path(missing);
        if (missing) throw write_error(file, "there is no temporary folder; set TMPDIR to one");
        const TemporaryFile temporary(folder, file);
        write(temporary.path());
        copy_bytes(temporary.path(), file);
        return;
    }
    TemporaryFile temporary(folder_of(target.path), file);
    write(temporary.path());
    flush_to_disk(temporary.path(), file);
    if (target.exists && ::chmod(temporary.path().c_str(), target.permissions) != 0) throw write_error(file, errno);
    if (const int error_number = temporary.rename_to(target.path)) throw write_error(file, error_number);
}

void write_text_atomically(const std::string& file, const std::function<void(std::ostream& out)>& write) {
    write_atomically(file, [&](const std::string& temporary) {
        errno = 0;  // a stream says that a write failed, the system why
        std::ofstream out(temporary, std::ios::binary);
        write(out);
        out.close();
        if (!out) throw write_error(file, errno);
    });
}

void check_writable(const std::string& file) {
    const Target target = find_target(file);
    // Permissions do not tell of read-only or full file systems: only creating a file does.
    if (target.regular) const TemporaryFile probe(folder_of(target.path), file);
}

}  // namespace raymill
