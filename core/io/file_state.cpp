// SPDX-License-Identifier: Apache-2.0
#include "io/file_state.h"

#include <sys/stat.h>

#include <chrono>
#include <ctime>
#include <thread>

namespace relume::io {

namespace {

/// Whether a change from now on would get another time than the file's last one. The kernel's clock of files moves in
/// ticks of a few milliseconds.
bool is_settled(const struct stat& file) {
#if defined(CLOCK_REALTIME_COARSE)
    timespec tick{};
    if (::clock_gettime(CLOCK_REALTIME_COARSE, &tick) != 0) return true;
    const timespec& last = file.st_ctim;
    return tick.tv_sec != last.tv_sec ? tick.tv_sec > last.tv_sec : tick.tv_nsec > last.tv_nsec;
#else
    static_cast<void>(file);
    return true;
#endif
}

}  // namespace

FileState FileState::of(const std::filesystem::path& path) {
    FileState state;
    state.path = path;
    struct stat now {};
    if (::stat(path.c_str(), &now) != 0) return state;
    // Not for ever: a server's clock may be ahead.
    for (int wait = 0; wait < 20 && !is_settled(now); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (::stat(path.c_str(), &now) != 0) return state;
    }
    state.size = now.st_size;
    state.modified_s = now.st_mtim.tv_sec;
    state.modified_ns = now.st_mtim.tv_nsec;
    state.changed_s = now.st_ctim.tv_sec;
    state.changed_ns = now.st_ctim.tv_nsec;
    state.device = now.st_dev;
    state.inode = now.st_ino;
    return state;
}

std::string FileState::key() const {
    std::string text = path.string();
    for (const std::int64_t number : {size, modified_s, modified_ns, changed_s, changed_ns}) {
        text += ' ';
        text += std::to_string(number);
    }
    return text + ' ' + std::to_string(device) + ' ' + std::to_string(inode) + '\n';
}

}  // namespace relume::io
