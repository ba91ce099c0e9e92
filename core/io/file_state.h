// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace relume::io {

/// A file as it is when it is looked at; whatever changes it later makes another. The time of its contents may be set
/// back, that of its last change of any kind may not. A file that was written just now is waited for, a few
/// milliseconds, until a further change would show in its times.
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
