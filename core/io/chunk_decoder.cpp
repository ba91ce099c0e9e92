// SPDX-License-Identifier: Apache-2.0
#include "io/chunk_decoder.h"

#include <utility>

#if __has_include(<openexr_compression.h>)
#  include <openexr_compression.h>
#  define RELUME_CORE_INFLATES 1
#else
#  define RELUME_CORE_INFLATES 0  // OpenEXRCore 3.1: its pipeline does all of it
#endif

namespace relume::io {

ChunkDecoder::~ChunkDecoder() {
    if (initialized_) {
        exr_decoding_destroy(context_, &pipeline_);
    }
}

DecodedChunk ChunkDecoder::inflate(const exr_chunk_info_t& chunk, exr_result_t& code) {
    packed_.resize(static_cast<std::size_t>(chunk.packed_size));
    code = exr_read_chunk(context_, part_, &chunk, packed_.data());
    if (code != EXR_ERR_SUCCESS) {
        return {};
    }
    if (chunk.packed_size == chunk.unpacked_size) {
        return {packed_, false};
    }
#if RELUME_CORE_INFLATES
    inflated_.resize(static_cast<std::size_t>(chunk.unpacked_size));
    std::size_t size = 0;
    code = exr_uncompress_buffer(context_, packed_.data(), packed_.size(), inflated_.data(), inflated_.size(), &size);
    if (code == EXR_ERR_SUCCESS && size != inflated_.size()) {
        code = EXR_ERR_CORRUPT_CHUNK;
    }
#endif
    if (code != EXR_ERR_SUCCESS) {
        return {};
    }
    return {inflated_, true};
}

DecodedChunk ChunkDecoder::decode(const exr_chunk_info_t& chunk, exr_result_t& code) {
    if (RELUME_CORE_INFLATES && zip_rows_) {
        return inflate(chunk, code);
    }
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
    return {{static_cast<const std::byte*>(pixels), static_cast<std::size_t>(chunk.unpacked_size)}, false};
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
        decoder = std::make_unique<ChunkDecoder>(context_, part_, zip_rows_);
    } else {
        decoder = std::move(idle_.back());
        idle_.pop_back();
    }
    return Lease(*this, std::move(decoder));
}

int DecoderPool::clear() {
    std::vector<std::unique_ptr<ChunkDecoder>> idle;  // destroyed without the lock
    const std::lock_guard lock(mutex_);
    idle.swap(idle_);
    return static_cast<int>(idle.size());
}

}  // namespace relume::io
