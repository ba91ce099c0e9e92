// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace relume::io {

/// A file as it is when it is looked at; whatever changes it later makes another. Its times alone are as coarse as the
/// kernel's tick, and may be set back; the time of its last change of any kind may not.
struct FileState {
    std::filesystem::path path;
    std::int64_t size = -1;  ///< −1: not there
    std::int64_t modified_s = 0, modified_ns = 0;
    std::int64_t changed_s = 0, changed_ns = 0;
    std::uint64_t device = 0, inode = 0;

    static FileState of(const std::filesystem::path& path);
    bool operator==(const FileState&) const = default;
    /// All of it in one line, as (a part of) a key.
    std::string key() const;
};

}  // namespace relume::io
