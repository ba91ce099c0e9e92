// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "io/exr_core.h"

namespace relume::io {

/// A chunk's bytes, valid until its decoder's next call.
struct DecodedChunk {
    /// The pixels as the file format lays them out: row after row, in a row channel after channel. Empty when the chunk
    /// cannot be had.
    std::span<const std::byte> bytes;
    /// Those pixels are still in ZIP's order and differences: to be walked through by ZipRows.
    bool zip_rows = false;
};

/// Reads and decompresses chunks of one part, one at a time. Its buffers are kept from chunk to chunk.
class ChunkDecoder {
public:
    /// `zip_rows`: ZIP chunks may be left half done, for ZipRows.
    ChunkDecoder(exr_const_context_t context, int part, bool zip_rows)
        : context_(context), part_(part), zip_rows_(zip_rows) {}
    ~ChunkDecoder();
    ChunkDecoder(const ChunkDecoder&) = delete;
    ChunkDecoder& operator=(const ChunkDecoder&) = delete;

    /// Sets OpenEXRCore's error where it fails.
    DecodedChunk decode(const exr_chunk_info_t& chunk, exr_result_t& code);

private:
    DecodedChunk inflate(const exr_chunk_info_t& chunk, exr_result_t& code);

    exr_const_context_t context_;
    int part_;
    bool zip_rows_;
    std::vector<std::byte> packed_;
    std::vector<std::byte> inflated_;
    bool initialized_ = false;
    exr_result_t (*decompress_)(exr_decode_pipeline_t*) = nullptr;
    exr_decode_pipeline_t pipeline_ = empty_pipeline<exr_decode_pipeline_t>();
};

/// The idle decoders of one part: as many come to be as threads read at once.
class DecoderPool {
public:
    /// A borrowed decoder. It goes back at the end unless discard() says that its state can't be trusted any more.
    class Lease {
    public:
        Lease(DecoderPool& pool, std::unique_ptr<ChunkDecoder> decoder) : pool_(pool), decoder_(std::move(decoder)) {}
        ~Lease();
        Lease(const Lease&) = delete;
        Lease& operator=(const Lease&) = delete;
        ChunkDecoder* operator->() const { return decoder_.get(); }
        void discard() { decoder_.reset(); }

    private:
        DecoderPool& pool_;
        std::unique_ptr<ChunkDecoder> decoder_;
    };

    DecoderPool(exr_const_context_t context, int part, bool zip_rows)
        : context_(context), part_(part), zip_rows_(zip_rows) {}
    Lease borrow();
    /// Destroys those that are idle, and says how many.
    int clear();

private:
    exr_const_context_t context_;
    int part_;
    bool zip_rows_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<ChunkDecoder>> idle_;
};

}  // namespace relume::io
