// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/file_state.h"
#include "node_rig.h"
#include "relume/gbuffer.h"

namespace relume::ofx {

/// A G-buffer of a file and the files that it was understood from.
struct FileGBuffer {
    GBuffer gbuffer;
    std::vector<io::FileState> files;
};

/// A relit frame of a file: R, G, B, A, premultiplied, row 0 at the top of the data window.
struct FileFrame {
    Window data_window, display_window;
    double aspect = 1;
    std::size_t size = 0;  ///< of rgba
    std::unique_ptr<float[]> rgba;
};

/// The file that the node takes its G-buffer from: the parameter's, else the rig's where the Normal clip is not
/// connected.
std::string gbuffer_file(const Instance& instance, const NodeRig& node);

/// Understands a file, or remembers that it did. What changed on disk is read again. `relight`: to relight it; the
/// second time its channels are kept as well, for then somebody turns knobs. Errors: as GBuffer::read.
std::shared_ptr<const FileGBuffer> understand_file(const std::filesystem::path& path, const GBufferOptions& options,
                                                   bool relight = false);

/// Relights a file's frame, or remembers that it did. Renders that want the same frame at once wait for one relight,
/// which ends when none of them wants it any more. Errors: as GBuffer::read and relight; file (it changed while it was
/// read); cancelled.
std::shared_ptr<const FileFrame> relight_file(const Instance& instance, const std::filesystem::path& path,
                                              const NodeRig& node);

/// Forgets what is finished.
void purge_frames();
/// The same, and waits for relights that still run.
void end_frames();

}  // namespace relume::ofx
