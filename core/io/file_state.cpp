// SPDX-License-Identifier: Apache-2.0
#include "io/file_state.h"

#include <sys/stat.h>

namespace relume::io {

FileState FileState::of(const std::filesystem::path& path) {
    FileState state;
    state.path = path;
    struct stat now {};
    if (::stat(path.c_str(), &now) != 0) return state;
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
