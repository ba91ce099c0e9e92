// SPDX-License-Identifier: Apache-2.0
#include "io/chunk_encoder.h"

#include <algorithm>
#include <string>
#include <utility>

#include "io/exr_header.h"
#include "io/pixel_convert.h"
#include "relume/error.h"

namespace relume::io {

namespace {

void check(exr_result_t code) {
    if (code != EXR_ERR_SUCCESS) {
        throw Error(ErrorKind::value, "cannot write EXR: " + take_core_error(code));
    }
}

// OpenEXRCore compresses for a file that it has open. Ours is written elsewhere, so that one leads nowhere.
std::int64_t discard(exr_const_context_t, void*, const void*, std::uint64_t count, std::uint64_t,
                     exr_stream_error_func_ptr_t) {
    return static_cast<std::int64_t>(count);
}

exr_pixel_type_t to_core(PixelType type) {
    switch (type) {
        case PixelType::half:
            return EXR_PIXEL_HALF;
        case PixelType::uint32:
            return EXR_PIXEL_UINT;
        default:
            return EXR_PIXEL_FLOAT;
    }
}

exr_attr_box2i_t to_box(const Window& window) {
    exr_attr_box2i_t box;
    box.min.x = window.x;
    box.min.y = window.y;
    box.max.x = window.x_end() - 1;
    box.max.y = window.y_end() - 1;
    return box;
}

}  // namespace

ChunkEncoder::~ChunkEncoder() {
    if (initialized_) {
        exr_encoding_destroy(context_, &pipeline_);
    }
}

exr_result_t ChunkEncoder::pack(exr_encode_pipeline_t* pipeline) {
    const auto& self = *static_cast<const ChunkEncoder*>(pipeline->encoding_user_data);
    auto* out = static_cast<std::byte*>(pipeline->packed_buffer);
    const int y0 = pipeline->chunk.start_y;
    for (int row = 0; row < pipeline->chunk.height; ++row) {
        for (std::size_t c = 0; c < self.channels_.size(); ++c) {
            const Channel& channel = self.part_.channels[c];
            if ((y0 + row) % channel.y_sampling != 0) {
                continue;
            }
            const ConstPlane& plane = self.channels_[c];
            const auto size = static_cast<std::ptrdiff_t>(size_of(channel.type));
            const auto count = static_cast<std::size_t>(self.part_.data_window.width / channel.x_sampling);
            convert_run({plane.data + row * plane.y_stride, plane.type, plane.x_stride * channel.x_sampling},
                        {out, channel.type, size}, count);
            out += static_cast<std::ptrdiff_t>(count) * size;
        }
    }
    pipeline->packed_bytes = static_cast<std::uint64_t>(out - static_cast<std::byte*>(pipeline->packed_buffer));
    return EXR_ERR_SUCCESS;
}

std::span<const std::byte> ChunkEncoder::encode(int y, std::span<const ConstPlane> channels) {
    channels_ = channels;
    clear_core_error();
    exr_chunk_info_t chunk{};
    check(exr_write_scanline_chunk_info(context_, 0, y, &chunk));
    if (!initialized_) {
        check(exr_encoding_initialize(context_, 0, &chunk, &pipeline_));
        initialized_ = true;
        check(exr_encoding_choose_default_routines(context_, 0, &pipeline_));
        pipeline_.encoding_user_data = this;
        pipeline_.convert_and_pack_fn = &ChunkEncoder::pack;
        pipeline_.yield_until_ready_fn = nullptr;
        pipeline_.write_fn = nullptr;
    } else {
        check(exr_encoding_update(context_, 0, &chunk, &pipeline_));
    }
    for (std::size_t c = 0; c < channels.size(); ++c) {
        pipeline_.channels[c].encode_from_ptr = reinterpret_cast<const std::uint8_t*>(channels[c].data);
    }
    check(exr_encoding_run(context_, 0, &pipeline_));
    if (pipeline_.compressed_bytes >= pipeline_.packed_bytes) {
        // A chunk as large as its pixels is taken for the pixels themselves by every reader. OpenEXRCore 3.1 hands out
        // compressed bytes of just that size.
        return {static_cast<const std::byte*>(pipeline_.packed_buffer), pipeline_.packed_bytes};
    }
    return {static_cast<const std::byte*>(pipeline_.compressed_buffer), pipeline_.compressed_bytes};
}

EncoderPool::Lease::~Lease() {
    const std::lock_guard lock(pool_.mutex_);
    pool_.idle_.push_back(std::move(encoder_));
}

EncoderPool::EncoderPool(const Part& part, const WriteOptions& options) : part_(part) {
    if (!is_supported(options.compression)) {
        throw Error(ErrorKind::value, "cannot write EXR: OpenEXR " OPENEXR_VERSION_STRING " cannot compress by " +
                                          std::string(name_of(options.compression)) + ": choose another compression");
    }
    exr_context_initializer_t initializer = core_initializer();
    initializer.write_fn = discard;
    initializer.zip_level = std::clamp(options.zip_level, 1, 9);
    initializer.dwa_quality = std::max(options.dwa_quality, 0.0f);
    clear_core_error();
    check(exr_start_write(context_.address(), "chunk encoder", EXR_WRITE_FILE_DIRECTLY, &initializer));

    exr_context_t context = context_.get();
    const Window& window = part.data_window;
    int index = 0;
    check(exr_set_longname_support(context, 1));
    check(exr_add_part(context, "pixels", EXR_STORAGE_SCANLINE, &index));
    check(exr_initialize_required_attr_simple(context, index, window.width, window.height,
                                              static_cast<exr_compression_t>(options.compression)));
    const exr_attr_box2i_t box = to_box(window);
    check(exr_set_data_window(context, index, &box));
    for (const Channel& channel : part.channels) {
        check(exr_add_channel(context, index, channel.name.c_str(), to_core(channel.type),
                              channel.perceptually_linear ? EXR_PERCEPTUALLY_LINEAR : EXR_PERCEPTUALLY_LOGARITHMIC,
                              channel.x_sampling, channel.y_sampling));
    }
    check(exr_write_header(context));
    std::int32_t rows = 1;
    check(exr_get_scanlines_per_chunk(context, index, &rows));
    rows_per_chunk_ = std::max(rows, 1);
}

EncoderPool::Lease EncoderPool::borrow() {
    const std::lock_guard lock(mutex_);
    std::unique_ptr<ChunkEncoder> encoder;
    if (idle_.empty()) {
        encoder = std::make_unique<ChunkEncoder>(context_.get(), part_);
    } else {
        encoder = std::move(idle_.back());
        idle_.pop_back();
    }
    return Lease(*this, std::move(encoder));
}

}  // namespace relume::io
