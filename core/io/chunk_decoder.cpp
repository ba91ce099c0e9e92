// SPDX-License-Identifier: Apache-2.0
#include "io/chunk_decoder.h"

#include <utility>

namespace relume::io {

ChunkDecoder::~ChunkDecoder() {
    if (initialized_) {
        exr_decoding_destroy(context_, &pipeline_);
    }
}

std::span<const std::byte> ChunkDecoder::decode(const exr_chunk_info_t& chunk, exr_result_t& code) {
    if (!initialized_) {
        code = exr_decoding_initialize(context_, part_, &chunk, &pipeline_);
        if (code != EXR_ERR_SUCCESS) {
            return {};
        }
        initialized_ = true;
        code = exr_decoding_choose_default_routines(context_, part_, &pipeline_);
        // The library's unpackers know neither regions nor replicated subsampling: reading and decompressing is all
        // that is asked of it.
        pipeline_.unpack_and_convert_fn = nullptr;
        decompress_ = pipeline_.decompress_fn;
    } else {
        code = exr_decoding_update(context_, part_, &chunk, &pipeline_);
    }
    // A chunk as large as its pixels is stored as it is. OpenEXRCore 3.1 forgets that for B44.
    pipeline_.decompress_fn = chunk.packed_size == chunk.unpacked_size ? nullptr : decompress_;
    if (code == EXR_ERR_SUCCESS) {
        code = exr_decoding_run(context_, part_, &pipeline_);
    }
    if (code != EXR_ERR_SUCCESS) {
        return {};
    }
    const void* pixels = pipeline_.unpacked_buffer != nullptr ? pipeline_.unpacked_buffer : pipeline_.packed_buffer;
    return {static_cast<const std::byte*>(pixels), static_cast<std::size_t>(chunk.unpacked_size)};
}

DecoderPool::Lease::~Lease() {
    if (decoder_) {
        const std::lock_guard lock(pool_.mutex_);
        pool_.idle_.push_back(std::move(decoder_));
    }
}

DecoderPool::Lease DecoderPool::borrow() {
    const std::lock_guard lock(mutex_);
    std::unique_ptr<ChunkDecoder> decoder;
    if (idle_.empty()) {
        decoder = std::make_unique<ChunkDecoder>(context_, part_);
    } else {
        decoder = std::move(idle_.back());
        idle_.pop_back();
    }
    return Lease(*this, std::move(decoder));
}

}  // namespace relume::io
