// SPDX-License-Identifier: Apache-2.0
#include "io/exr_core.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#ifdef RELUME_OPENEXR_BUNDLED
namespace ojph {  // inside of the bundled archive, which brings no header of it
void set_warning_stream(std::FILE* stream);
void set_error_stream(std::FILE* stream);
}  // namespace ojph
#endif

namespace relume::io {

namespace {

// Core reports the cause first and what it made of it afterwards, so the first message is the one to show. A fixed
// buffer, because the handler is called from C and may not throw.
thread_local std::array<char, 512> first_message{};

void keep_first_message(exr_const_context_t, exr_result_t, const char* message) {
    if (first_message[0] == '\0' && message != nullptr) {
        std::strncpy(first_message.data(), message, first_message.size() - 1);
    }
}

std::int64_t stream_read(exr_const_context_t, void* user, void* buffer, std::uint64_t count, std::uint64_t offset,
                         exr_stream_error_func_ptr_t) {
    return static_cast<const InputFile*>(user)->read(buffer, count, offset);
}

std::int64_t nanoseconds(const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + std::int64_t{time.tv_nsec};
}

std::int64_t stream_size(exr_const_context_t, void* user) { return static_cast<const InputFile*>(user)->size(); }

}  // namespace

bool InputFile::changed() const {
    struct stat status {};
    return ::fstat(descriptor_, &status) == 0 && (status.st_size != size_ || nanoseconds(status.st_mtim) != written_);
}

InputFile::InputFile(const std::filesystem::path& path) {
    const std::string name = path.string();
    descriptor_ = ::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (descriptor_ < 0) {
        throw Error(ErrorKind::file, name + ": cannot open: " + std::strerror(errno));
    }
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(descriptor_);
        throw Error(ErrorKind::file, name + (S_ISDIR(status.st_mode) ? ": is a folder" : ": is not a regular file"));
    }
    size_ = status.st_size;
    written_ = nanoseconds(status.st_mtim);
}

InputFile::~InputFile() { ::close(descriptor_); }

std::int64_t InputFile::read(void* buffer, std::uint64_t count, std::uint64_t offset) const {
    // Offsets come from the file: one that is no file offset at all reads like one behind the end.
    if (offset > static_cast<std::uint64_t>(size_)) {
        return 0;
    }
    auto* out = static_cast<char*>(buffer);
    std::int64_t done = 0;
    while (static_cast<std::uint64_t>(done) < count) {
        const auto step = static_cast<std::size_t>(count) - static_cast<std::size_t>(done);
        const ssize_t got = ::pread(descriptor_, out + done, step, static_cast<off_t>(offset) + done);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            error_ = errno;
            return -1;
        }
        if (got == 0) {
            break;
        }
        done += got;
    }
    return done;
}

CoreContext::~CoreContext() {
    if (handle_ != nullptr) {
        exr_finish(&handle_);
    }
}

CoreContext& CoreContext::operator=(CoreContext&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
}

exr_context_initializer_t core_initializer() {
#ifdef RELUME_OPENEXR_BUNDLED
    // OpenJPH, which decodes HTJ2K, would print to standard output and error what Core returns as an error.
    static const bool silent = (ojph::set_warning_stream(nullptr), ojph::set_error_stream(nullptr), true);
    static_cast<void>(silent);
#endif
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = keep_first_message;
    return initializer;
}

void clear_core_error() noexcept { first_message[0] = '\0'; }

std::string take_core_error(exr_result_t code) {
    std::string message = first_message[0] != '\0' ? first_message.data() : exr_get_default_error_message(code);
    clear_core_error();
    while (!message.empty() && (message.back() == '.' || message.back() == ' ')) {
        message.pop_back();
    }
    if (message.size() > 1 && message[0] >= 'A' && message[0] <= 'Z' && message[1] >= 'a') {
        message[0] = static_cast<char>(message[0] - 'A' + 'a');
    }
    return message;
}

CoreContext open_core_context(const InputFile& file, const std::filesystem::path& path) {
    exr_context_initializer_t initializer = core_initializer();
    initializer.user_data = const_cast<InputFile*>(&file);  // read back as const
    initializer.read_fn = stream_read;
    initializer.size_fn = stream_size;

    CoreContext context;
    clear_core_error();
    const exr_result_t code = exr_start_read(context.address(), path.string().c_str(), &initializer);
    if (code != EXR_ERR_SUCCESS) {
        if (file.error() != 0) {
            throw Error(ErrorKind::file, path.string() + ": cannot read: " + std::strerror(file.error()));
        }
        throw Error(ErrorKind::format, path.string() + ": damaged header: " + take_core_error(code));
    }
    clear_core_error();
    return context;
}

}  // namespace relume::io
