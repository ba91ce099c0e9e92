// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <mutex>
#include <system_error>

#include "gbuffer/gbuffer_impl.h"
#include "relume/error.h"
#include "relume/lookup_table.h"
#include "relume/shader_abi.h"

namespace relume {

namespace {

constexpr std::size_t kMostKept = 4;

/// The channels that make up a table, R, G and B or one alone; empty when there are no such.
std::vector<int> channels_of(const io::Part& part) {
    const auto named = [&](std::string_view name) {
        const auto found =
            std::find_if(part.channels.begin(), part.channels.end(), [&](const auto& c) { return c.name == name; });
        return found == part.channels.end() ? -1 : static_cast<int>(found - part.channels.begin());
    };
    if (const int y = named("Y"); y >= 0) return {y};
    const std::vector<int> rgb{named("R"), named("G"), named("B")};
    if (std::find(rgb.begin(), rgb.end(), -1) == rgb.end()) return rgb;
    if (part.channels.size() == 1) return {0};
    return {};
}

LookupTable read_table(const std::filesystem::path& path) {
    const auto refuse = [&](const std::string& why) { throw Error(ErrorKind::format, path.string() + ": " + why); };
    const gbuffer::SourceFile file = gbuffer::open_file(path, {.max_pixels = kMostTexels});
    if (file.header.parts.empty() || file.header.parts[0].deep) refuse("has no flat picture to make a table of");
    const io::Part& part = file.header.parts[0];
    const std::vector<int> channels = channels_of(part);
    if (channels.empty()) {
        std::string names;
        for (std::size_t k = 0; k < part.channels.size() && k < 8; ++k)
            names += (names.empty() ? "" : ", ") + part.channels[k].name;
        refuse("holds the channels " + names + "; a table is one channel (Y) or R, G, B");
    }
    LookupTable table{part.data_window.width, part.data_window.height, {}};
    const auto count = static_cast<std::size_t>(table.width) * static_cast<std::size_t>(table.height);
    std::vector<std::vector<float>> planes(channels.size(), std::vector<float>(count));
    std::vector<io::ReadTarget> targets;
    for (std::size_t k = 0; k < channels.size(); ++k)
        targets.push_back({0,
                           channels[k],
                           {reinterpret_cast<std::byte*>(planes[k].data()), PixelType::float32, 4,
                            static_cast<std::ptrdiff_t>(sizeof(float)) * table.width}});
    file.pixels->read(part.data_window, targets);
    table.texels = std::move(planes[0]);
    if (channels.size() == 3)
        for (std::size_t i = 0; i < count; ++i)
            table.texels[i] = static_cast<float>(0.2126 * static_cast<double>(table.texels[i]) +
                                                 0.7152 * static_cast<double>(planes[1][i]) +
                                                 0.0722 * static_cast<double>(planes[2][i]));
    try {
        check_table(table, path.string());
    } catch (const Error& error) {
        throw Error(ErrorKind::format, error.what());
    }
    return table;
}

struct Kept {
    std::filesystem::path path;
    std::filesystem::file_time_type written;
    std::uintmax_t bytes;
    std::shared_ptr<const LookupTable> table;
};

}  // namespace

std::shared_ptr<const LookupTable> load_table(const std::filesystem::path& path) {
    static std::mutex mutex;
    static std::vector<Kept> kept;  // the one used last stands last
    std::error_code error;
    const std::filesystem::path full = std::filesystem::absolute(path, error).lexically_normal();
    const auto written = std::filesystem::last_write_time(path, error);
    const auto bytes = error ? 0 : std::filesystem::file_size(path, error);
    if (error) {
        const bool folder = std::filesystem::is_directory(path);
        throw Error(ErrorKind::file,
                    path.string() + (folder ? ": is a directory; a table is a file" : ": no such file"));
    }
    const auto same = [&](const Kept& k) { return k.path == full && k.written == written && k.bytes == bytes; };
    {
        const std::lock_guard lock(mutex);
        if (const auto found = std::find_if(kept.begin(), kept.end(), same); found != kept.end()) {
            std::rotate(found, found + 1, kept.end());
            return kept.back().table;
        }
    }
    auto table = std::make_shared<const LookupTable>(read_table(path));  // without the lock: it may call into Python
    const std::lock_guard lock(mutex);
    std::erase_if(kept, [&](const Kept& k) { return k.path == full; });
    if (kept.size() == kMostKept) kept.erase(kept.begin());
    kept.push_back({full, written, bytes, table});
    return table;
}

}  // namespace relume
