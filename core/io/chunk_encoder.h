// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "io/exr.h"
#include "io/exr_core.h"

namespace relume::io {

/// Packs and compresses chunks of one part, one at a time. Its buffers are kept from chunk to chunk.
class ChunkEncoder {
public:
    ChunkEncoder(exr_context_t context, const Part& part) : context_(context), part_(part) {}
    ~ChunkEncoder();
    ChunkEncoder(const ChunkEncoder&) = delete;
    ChunkEncoder& operator=(const ChunkEncoder&) = delete;

    /// The bytes of the chunk that starts at row `y`, valid until the next call. `channels` are in file order, (0, 0)
    /// is the left pixel of row y. Throws Error(value) when the compression fails.
    std::span<const std::byte> encode(int y, std::span<const ConstPlane> channels);

private:
    static exr_result_t pack(exr_encode_pipeline_t* pipeline);

    exr_context_t context_;
    const Part& part_;
    std::span<const ConstPlane> channels_;
    bool initialized_ = false;
    exr_encode_pipeline_t pipeline_ = empty_pipeline<exr_encode_pipeline_t>();
};

/// The compressor of one part: OpenEXRCore's settings for it, and the idle encoders.
class EncoderPool {
public:
    /// A borrowed encoder; goes back at the end.
    class Lease {
    public:
        Lease(EncoderPool& pool, std::unique_ptr<ChunkEncoder> encoder) : pool_(pool), encoder_(std::move(encoder)) {}
        ~Lease();
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        ChunkEncoder* operator->() const { return encoder_.get(); }

    private:
        EncoderPool& pool_;
        std::unique_ptr<ChunkEncoder> encoder_;
    };

    /// `part` must outlive the pool, its channels sorted by name. Throws Error(value) when OpenEXR refuses it.
    EncoderPool(const Part& part, const WriteOptions& options);
    Lease borrow();
    int rows_per_chunk() const { return rows_per_chunk_; }

private:
    const Part& part_;
    CoreContext context_;
    int rows_per_chunk_ = 1;
    std::mutex mutex_;
    std::vector<std::unique_ptr<ChunkEncoder>> idle_;
};

}  // namespace relume::io
