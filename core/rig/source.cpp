// SPDX-License-Identifier: Apache-2.0
#include "rig/source.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "relume/error.h"

namespace relume::rigfile {

namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20;

}  // namespace

std::string shown(const std::filesystem::path& path) {
    std::string text = path.string();
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20) c = '?';
    return text;
}

std::string read_text(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& why) { throw Error(ErrorKind::file, shown(path) + ": " + why); };
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) fail("is a directory; a rig is a file");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) fail(errno == ENOENT ? "no such rig file" : std::string("cannot be opened: ") + std::strerror(errno));
    std::string text;
    char block[65536];
    while (const std::size_t count = std::fread(block, 1, sizeof block, file.get())) {
        text.append(block, count);
        if (text.size() > kMostBytes) fail("is larger than 16 MiB; that is no rig");
    }
    if (std::ferror(file.get()) != 0) fail(std::string("cannot be read: ") + std::strerror(errno));
    return text;
}

std::string resolved(const std::string& name, const std::filesystem::path& folder) {
    const std::filesystem::path path(name);
    if (folder.empty() || name.empty() || path.is_absolute()) return name;
    return (folder / path).lexically_normal().string();
}

}  // namespace relume::rigfile
