// SPDX-License-Identifier: Apache-2.0
#include "io/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "relume/error.h"

namespace relume::io {

namespace {

constexpr std::size_t kLongestName = 180;  // of the destination's, within the temporary name: file systems allow 255

std::filesystem::path temporary_name(const std::filesystem::path& target) {
    static std::atomic<unsigned> counter{0};
    const std::string name = "." + std::to_string(::getpid()) + "-" + std::to_string(counter++) + "." +
                             target.filename().string().substr(0, kLongestName) + ".part";
    return target.parent_path() / name;
}

// A rename would replace a symbolic link rather than the file that it leads to.
std::filesystem::path follow_links(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_symlink(path, error)) {
        return path;
    }
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(path, error);
    return error ? path : resolved;
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& path) : path_(path), target_(follow_links(path)) {
    if (!target_.has_filename()) {
        throw Error(ErrorKind::file, path_.string() + ": cannot write: this is no file name");
    }
    struct stat status {};
    if (::stat(target_.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) {
        throw Error(ErrorKind::file,
                    path_.string() + (S_ISDIR(status.st_mode) ? ": cannot write: is a folder"
                                                              : ": cannot write: is not a regular file"));
    }
    do {
        temporary_ = temporary_name(target_);
        // 0666: the umask decides, as for any file that a program creates.
        descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EEXIST);
    if (descriptor_ < 0) {
        const int code = errno;
        const std::filesystem::path folder = target_.parent_path().empty() ? "." : target_.parent_path();
        throw Error(ErrorKind::file,
                    path_.string() + ": cannot write into the folder " + folder.string() + ": " + std::strerror(code));
    }
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) {
        ::close(descriptor_);
    }
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
    }
}

void OutputFile::fail(const char* what) const {
    const int code = errno;
    throw Error(ErrorKind::file, path_.string() + ": " + what + ": " + std::strerror(code) +
                                     "; what was under this name before is untouched");
}

void OutputFile::write(std::span<const std::byte> first, std::span<const std::byte> second, std::uint64_t offset) {
    while (!first.empty() || !second.empty()) {
        std::array<iovec, 2> parts{{{const_cast<std::byte*>(first.data()), first.size()},
                                    {const_cast<std::byte*>(second.data()), second.size()}}};
        const ssize_t wrote = ::pwritev(descriptor_, parts.data(), 2, static_cast<off_t>(offset));
        if (wrote < 0) {
            if (errno == EINTR) {
                continue;
            }
            fail("cannot write");
        }
        const auto done = static_cast<std::size_t>(wrote);
        const std::size_t from_first = std::min(done, first.size());
        first = first.subspan(from_first);
        second = second.subspan(done - from_first);
        offset += done;
    }
}

void OutputFile::commit() {
    if (::fsync(descriptor_) != 0 && errno != EINVAL) {  // EINVAL: the file system has nothing to flush
        fail("cannot flush to the disk");
    }
    const int descriptor = descriptor_;
    descriptor_ = -1;
    // Network file systems may report a full disk no earlier than here.
    if (::close(descriptor) != 0 && errno != EINTR) {
        fail("cannot close");
    }
    if (std::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail("cannot rename");
    }
    temporary_.clear();
}

}  // namespace relume::io
