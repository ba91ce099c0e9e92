// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace relume::rigfile {

/// The whole file. Throws Error(file) naming it: missing, a directory, unreadable, or over 16 MiB.
std::string read_text(const std::filesystem::path& path);

/// `name` as a path below `folder`; itself when it is absolute or `folder` is empty.
std::string resolved(const std::string& name, const std::filesystem::path& folder);

/// What stands in a message for a path: as given, control characters out.
std::string shown(const std::filesystem::path& path);

}  // namespace relume::rigfile
