// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXRConfig.h>
#include <openexr.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "relume/error.h"

namespace relume::io {

/// A file open for reading at any offset from any thread.
class InputFile {
public:
    /// Throws Error(file) when it is missing, unreadable or not a regular file.
    explicit InputFile(const std::filesystem::path& path);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    std::int64_t size() const { return size_; }
    /// Bytes read, fewer than `count` at the end of the file, -1 on an I/O error.
    std::int64_t read(void* buffer, std::uint64_t count, std::uint64_t offset) const;
    /// Whether somebody has written into it since it was opened. A file that was replaced by another under its name has
    /// not changed: this one is still there for who has it open.
    bool changed() const;
    /// errno of the last I/O error, 0 when there was none: tells a failing disk from a damaged file.
    int error() const { return error_; }

private:
    mutable std::atomic<int> error_{0};
    int descriptor_ = -1;
    std::int64_t size_ = 0;
    std::int64_t written_ = 0;  ///< time of the last change, ns
};

/// Owns an OpenEXRCore context.
class CoreContext {
public:
    CoreContext() = default;
    ~CoreContext();
    CoreContext(CoreContext&& other) noexcept : handle_(other.handle_) { other.handle_ = nullptr; }
    CoreContext& operator=(CoreContext&& other) noexcept;

    exr_context_t get() const { return handle_; }
    exr_context_t* address() { return &handle_; }

private:
    exr_context_t handle_ = nullptr;
};

/// Initialiser with our error handler, which keeps the first message of this thread until throw_core_error() takes it.
exr_context_initializer_t core_initializer();

/// What EXR_DECODE_PIPELINE_INITIALIZER and its like stand for; OpenEXRCore 3.1 has no size field.
template <typename Pipeline> Pipeline empty_pipeline() {
    Pipeline pipeline{};
    if constexpr (requires { pipeline.pipe_size; }) {
        pipeline.pipe_size = sizeof pipeline;
    }
    return pipeline;
}

/// Forgets an error that was expected.
void clear_core_error() noexcept;

/// The message that OpenEXRCore left in this thread for `code`, in lower case and without a full stop, taken away.
std::string take_core_error(exr_result_t code);

/// Opens `file` (which must outlive the context) for reading and parses the header. `path` is for messages.
CoreContext open_core_context(const InputFile& file, const std::filesystem::path& path);

}  // namespace relume::io
