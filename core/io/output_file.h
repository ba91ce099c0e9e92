// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace relume::io {

/// A file that appears under its name whole or not at all: written under a temporary name in the same folder, renamed
/// by commit(). Without commit() the destructor removes it. Writing at different offsets is thread-safe.
class OutputFile {
public:
    /// Throws Error(file) when the folder is missing or not writable, or when `path` exists and is no regular file.
    explicit OutputFile(const std::filesystem::path& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// As the caller named it, for messages.
    const std::filesystem::path& path() const { return path_; }

    /// Both spans, one after the other, at `offset`. Throws Error(file) on a full disk.
    void write(std::span<const std::byte> first, std::span<const std::byte> second, std::uint64_t offset);

    /// Flushes to the disk, renames onto the destination.
    void commit();

private:
    [[noreturn]] void fail(const char* what) const;

    std::filesystem::path path_;
    std::filesystem::path target_;  // where symbolic links lead to
    std::filesystem::path temporary_;
    int descriptor_ = -1;
};

}  // namespace relume::io
