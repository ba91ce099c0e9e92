// SPDX-License-Identifier: Apache-2.0
#include "relume/gbuffer.h"

#include <algorithm>

#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/release_buffers.h"
#include "gbuffer/stored_image.h"

namespace relume {

namespace gbuffer {

namespace {

class ExrPixels final : public PixelSource {
public:
    explicit ExrPixels(io::ExrReader reader) : reader_(std::move(reader)) {}
    void read(const Window& region, std::span<const io::ReadTarget> targets) const override {
        reader_.read(region, targets);
    }
    int release_buffers() const override { return reader_.release_buffers(); }
    const io::Header& header() const { return reader_.header(); }

private:
    io::ExrReader reader_;
};

}  // namespace

io::ReadLimits read_limits(const GBufferOptions& options) {
    io::ReadLimits limits;
    limits.max_pixels = options.max_pixels.value_or(limits.max_pixels);
    limits.max_channels = options.max_channels.value_or(limits.max_channels);
    limits.max_parts = options.max_parts.value_or(limits.max_parts);
    return limits;
}

SourceFile open_file(const std::filesystem::path& path, const io::ReadLimits& limits, bool color) {
    if (is_other_image(path)) return open_other_image(path, color);
    auto pixels = std::make_shared<ExrPixels>(io::ExrReader(path, limits));
    SourceFile file;
    file.path = path;
    file.header = pixels->header();
    file.layers = index_layers(file.header, 0, path.stem().string());
    file.producer = detect_producer(file.header, file.layers);
    file.pixels = std::move(pixels);
    return file;
}

int release_buffers(const GBuffer& gbuffer) {
    int decoders = 0;
    for (const SourceFile& file : gbuffer.impl().files) decoders += file.pixels->release_buffers();
    return decoders;
}

}  // namespace gbuffer

GBuffer::GBuffer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GBuffer::GBuffer(GBuffer&&) noexcept = default;
GBuffer& GBuffer::operator=(GBuffer&&) noexcept = default;
GBuffer::~GBuffer() = default;

GBuffer GBuffer::read(const std::filesystem::path& path, const GBufferOptions& options, int threads) {
    return GBuffer(gbuffer::understand(gbuffer::open_file(path, gbuffer::read_limits(options)), options, threads));
}

void GBuffer::keep_channels(std::int64_t bytes) {
    // Arrays are the caller's, who may change them.
    if (!impl_->in_memory()) impl_->kept = std::make_shared<gbuffer::KeptChannels>(bytes);
}

const Window& GBuffer::data_window() const { return impl_->data_window; }
const Window& GBuffer::display_window() const { return impl_->display_window; }
float GBuffer::pixel_aspect() const { return impl_->pixel_aspect; }
std::string_view GBuffer::producer() const { return impl_->producer; }
std::string_view GBuffer::working_space() const { return impl_->working_space; }
const std::vector<ChannelInfo>& GBuffer::channels() const { return impl_->infos; }

const ChannelInfo* GBuffer::find(std::string_view name) const {
    for (const ChannelInfo& info : impl_->infos) {
        if (info.name == name) return &info;
    }
    const gbuffer::Semantic* semantic = impl_->find(name);
    for (const ChannelInfo& info : impl_->infos) {
        if (semantic && info.name == semantic->info.name) return &info;
    }
    return nullptr;
}

bool GBuffer::normal_variance() const { return impl_->normal_variance.on; }

const std::optional<Camera>& GBuffer::camera() const { return impl_->camera; }
std::string_view GBuffer::camera_reason() const { return impl_->camera_reason; }
double GBuffer::camera_error() const { return impl_->camera_error; }
const std::vector<std::string>& GBuffer::notes() const { return impl_->notes; }
const std::map<std::string, std::vector<std::string>>& GBuffer::cryptomatte() const { return impl_->crypto_names; }

}  // namespace relume
