// SPDX-License-Identifier: Apache-2.0
#include "oiio/relit_frame.h"

#include <algorithm>
#include <cstring>
#include <list>

#include "gbuffer/release_buffers.h"
#include "io/file_state.h"
#include "relight/blank_frame.h"
#include "relight/output_header.h"
#include "relight/plan.h"
#include "relume/error.h"

namespace relume::oiio {

namespace {

/// Frames that are understood and kept: their headers and cameras, no pixels.
constexpr std::size_t kFrames = 16;

/// What the frame is made of: the rig with all that was changed in it, and its files as they are now.
std::string key_of(const Rig& rig) {
    std::string key = rig.to_toml();
    key += '\n';
    for (const std::filesystem::path& path : rig.input_files()) key += io::FileState::of(path).key();
    return key;
}

/// The frames that were understood last.
struct FrameCache {
    std::mutex mutex;
    std::list<std::shared_ptr<RelitFrame>> frames;

    static FrameCache& instance() {
        static auto* const cache = new FrameCache;
        return *cache;
    }
};

}  // namespace

std::shared_ptr<RelitFrame> RelitFrame::get(Rig rig) {
    std::string key = key_of(rig);
    FrameCache& cache = FrameCache::instance();
    // Held while a G-buffer is understood, so that threads that open one file do that once.
    const std::scoped_lock lock(cache.mutex);
    const auto found = std::find_if(cache.frames.begin(), cache.frames.end(),
                                    [&](const std::shared_ptr<RelitFrame>& f) { return f->key() == key; });
    if (found != cache.frames.end()) {
        cache.frames.splice(cache.frames.begin(), cache.frames, found);
        return cache.frames.front();
    }
    cache.frames.push_front(std::make_shared<RelitFrame>(std::move(rig), std::move(key)));
    if (cache.frames.size() > kFrames) cache.frames.pop_back();
    // Of the others few will be read again: their buffers are larger than all else of them.
    for (const std::shared_ptr<RelitFrame>& other : cache.frames)
        if (other != cache.frames.front()) gbuffer::release_buffers(other->gbuffer_);
    return cache.frames.front();
}

RelitFrame::RelitFrame(Rig rig, std::string key)
    : key_(std::move(key)), rig_(std::move(rig)), gbuffer_(GBuffer::read(rig_.main_file().value(), rig_.gbuffer)) {
    const Plan plan(gbuffer_, rig_);
    const OutputLayout layout = output_layout(gbuffer_, rig_, plan);
    header_ = layout.header.parts.front();
    type_ = header_.channels.front().type;
    if (window().empty()) throw Error(ErrorKind::value, rig_.main_file().value() + ": the G-buffer has no pixels");
    for (std::size_t a = 0; a < plan.aovs.size(); ++a)
        pictures_.push_back({a == 0 ? header_.name.empty() ? "beauty" : header_.name : layer_name(plan.aovs[a].name),
                             plan.aovs[a].components});
    const auto count = static_cast<std::size_t>((window().height + kTile - 1) / kTile);
    strips_.resize(count);
    busy_.resize(count);
    seen_.resize(count);
}

std::size_t RelitFrame::strip_bytes() const {
    std::size_t components = 0;
    for (const Picture& picture : pictures_) components += static_cast<std::size_t>(picture.components);
    return components * size_of(type_) * static_cast<std::size_t>(window().width) * kTile;
}

/// What a render says of the strips that nobody has seen. Called with the lock.
void RelitFrame::take_note(int first_strip, int strips, const RelightReport& report) {
    if (seen_[static_cast<std::size_t>(first_strip)]) return;
    std::fill_n(seen_.begin() + first_strip, strips, true);
    if (report.shaded == 0) return;
    std::map<std::string, std::int64_t> in_all;
    for (const auto& [name, count] : report.nonfinite) {
        const auto before = nonfinite_.find(name);
        if (count >= report.shaded && (surfaces_ == 0 || before != nonfinite_.end()))
            in_all[name] = count + (surfaces_ == 0 ? 0 : before->second);
    }
    nonfinite_ = std::move(in_all);
    surfaces_ += report.shaded;
}

RelitFrame::Render RelitFrame::render(int first_strip, int strips) {
    auto block = std::make_shared<Block>();
    block->first_row = first_strip * kTile;
    block->rows = std::min(strips * kTile, window().height - block->first_row);
    std::map<std::string, std::vector<Plane>> out;
    const std::vector<AovInfo> names = aovs(rig_);
    const std::size_t value = size_of(type_);
    const auto row_bytes = [&](const Picture& picture) {
        return value * static_cast<std::size_t>(picture.components) * static_cast<std::size_t>(window().width);
    };
    const auto picture_bytes = [&](const Picture& picture) {
        return (row_bytes(picture) * static_cast<std::size_t>(block->rows) + kBlockAlignment - 1) / kBlockAlignment *
               kBlockAlignment;
    };
    std::size_t bytes = 0;
    for (const Picture& picture : pictures_) bytes += picture_bytes(picture);
    block->memory = BlockMemory(bytes);
    std::byte* at = block->memory.data();
    for (std::size_t p = 0; p < pictures_.size(); ++p) {
        const std::size_t pixel = value * static_cast<std::size_t>(pictures_[p].components);
        const std::size_t row = row_bytes(pictures_[p]);
        block->pictures.push_back(at);
        at += picture_bytes(pictures_[p]);
        for (std::size_t k = 0; k < static_cast<std::size_t>(pictures_[p].components); ++k)
            out[names[p].name].push_back({block->pictures[p] + k * value, type_, static_cast<std::ptrdiff_t>(pixel),
                                          static_cast<std::ptrdiff_t>(row)});
    }
    RelightOptions options;
    options.region = Window{window().x, window().y + block->first_row, window().width, block->rows};
    RelightReport report = relight(gbuffer_, rig_, out, options);
    rendered_rows_ += block->rows;
    return {std::move(block), std::move(report)};
}

void RelitFrame::read(int picture, int x, int x_end, int y, int y_end, std::byte* out, std::ptrdiff_t stride,
                      int ahead) {
    const std::size_t pixel =
        size_of(type_) * static_cast<std::size_t>(pictures_[static_cast<std::size_t>(picture)].components);
    const int top = y - window().y, bottom = y_end - window().y;
    // As many strips at once as a quarter of the cache holds.
    const int most = static_cast<int>(std::clamp<std::size_t>(
        BlockCache::instance().limit() / 4 / std::max<std::size_t>(strip_bytes(), 1), 1, 1 << 20));
    for (int row = top; row < bottom;) {
        const int strip = row / kTile;
        std::shared_ptr<const Block> block;
        int claimed = 0;
        {
            std::unique_lock lock(mutex_);
            const auto s = static_cast<std::size_t>(strip);
            rendered_.wait(lock, [&] { return !busy_[s]; });
            block = strips_[s].lock();
            if (!block) {
                // All of what this call wants that nobody has and nobody makes.
                const int last =
                    std::min({(bottom - 1 + ahead) / kTile + 1, strip + most, static_cast<int>(strips_.size())});
                for (int k = strip; k < last; ++k) {
                    const auto index = static_cast<std::size_t>(k);
                    if (busy_[index] || !strips_[index].expired()) break;
                    busy_[index] = true;
                    ++claimed;
                }
            }
        }
        if (block) {
            BlockCache::instance().touch(block);
        } else {
            Render made;
            const auto finish = [&] {
                const std::scoped_lock lock(mutex_);
                for (int k = strip; k < strip + claimed; ++k) {
                    busy_[static_cast<std::size_t>(k)] = false;
                    if (made.block) strips_[static_cast<std::size_t>(k)] = made.block;
                }
                if (made.block) take_note(strip, claimed, made.report);
                rendered_.notify_all();
            };
            try {
                made = render(strip, claimed);
            } catch (...) {
                finish();
                throw;
            }
            block = made.block;
            BlockCache::instance().add(block);
            finish();
        }
        {
            const std::scoped_lock lock(mutex_);
            if (!nonfinite_.empty() && std::find(seen_.begin(), seen_.end(), false) == seen_.end())
                refuse_blank(gbuffer_, surfaces_, nonfinite_);
        }
        const int end = std::min(bottom, block->first_row + block->rows);
        const auto row_bytes = pixel * static_cast<std::size_t>(window().width);
        const std::byte* from = block->pictures[static_cast<std::size_t>(picture)] +
                                static_cast<std::size_t>(row - block->first_row) * row_bytes +
                                static_cast<std::size_t>(x - window().x) * pixel;
        for (; row < end; ++row, from += row_bytes)
            std::memcpy(out + (row - top) * stride, from, pixel * static_cast<std::size_t>(x_end - x));
    }
}

}  // namespace relume::oiio
