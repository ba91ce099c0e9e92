// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/understood_frames.h"

#include <algorithm>
#include <atomic>
#include <list>
#include <mutex>
#include <vector>

#include "gbuffer/sampling.h"

namespace relume {

namespace {

using gbuffer::Look;

constexpr std::size_t kMostFrames = 8;

/// What the present pixels show, each look taken once.
class Present {
public:
    explicit Present(const GBuffer::Impl& frame) : frame_(frame) {}

    bool shows(const Look& past) {
        const auto same = [&](const Look& look) { return look.raws == past.raws && look.dense == past.dense; };
        const auto known = std::find_if(looks_.begin(), looks_.end(), same);
        if (known != looks_.end()) return known->seen == past.seen;
        looks_.push_back({past.raws, past.dense, gbuffer::hash_of_rows(frame_, past.raws, 0, past.dense)});
        return looks_.back().seen == past.seen;
    }

private:
    const GBuffer::Impl& frame_;
    std::vector<Look> looks_;
};

/// What stands in the arrays, without looking at them.
struct Signature {
    Window data_window, display_window;
    float pixel_aspect = 1;
    bool resampled = false;
    GBufferOptions options;
    std::vector<std::pair<std::string, PixelType>> planes;
    std::vector<ChannelRule> rules;
    bool operator==(const Signature&) const = default;
};

struct Entry {
    Signature signature;
    std::vector<Look> looks;
    GBuffer::Impl impl;  ///< its planes point nowhere
};

/// `entry`'s understanding of `fresh`'s planes.
std::unique_ptr<GBuffer::Impl> over(const Entry& entry, const GBuffer::Impl& fresh) {
    auto impl = std::make_unique<GBuffer::Impl>(entry.impl);
    for (std::size_t k = 0; k < impl->raws.size(); ++k) impl->raws[k].memory = fresh.raws[k].memory;
    return impl;
}

}  // namespace

struct UnderstoodFrames::Impl {
    std::mutex mutex;                                 ///< of the entries
    std::mutex understanding;                         ///< held by who understands, so that the others find it done
    std::list<std::shared_ptr<const Entry>> entries;  ///< the latest first
    std::atomic<std::int64_t> understood{0};

    std::shared_ptr<const Entry> find(const Signature& signature, Present& present) {
        std::vector<std::shared_ptr<const Entry>> alike;
        {
            const std::scoped_lock lock(mutex);
            for (const auto& entry : entries)
                if (entry->signature == signature) alike.push_back(entry);
        }
        for (const auto& entry : alike) {
            const auto shown = [&](const Look& look) { return present.shows(look); };
            if (!std::all_of(entry->looks.begin(), entry->looks.end(), shown)) continue;
            const std::scoped_lock lock(mutex);
            const auto at = std::find(entries.begin(), entries.end(), entry);
            if (at != entries.end()) entries.splice(entries.begin(), entries, at);
            return entry;
        }
        return nullptr;
    }
};

UnderstoodFrames::UnderstoodFrames() : impl_(std::make_unique<Impl>()) {}
UnderstoodFrames::~UnderstoodFrames() = default;

std::int64_t UnderstoodFrames::understood() const { return impl_->understood; }

void UnderstoodFrames::clear() {
    const std::scoped_lock lock(impl_->mutex);
    impl_->entries.clear();
}

namespace gbuffer {

std::unique_ptr<GBuffer::Impl> understand_once(std::unique_ptr<GBuffer::Impl> fresh,
                                               const std::map<std::string, MemoryChannel>& channels,
                                               const GBufferOptions& options, UnderstoodFrames::Impl& known) {
    Signature signature{
        fresh->data_window, fresh->display_window, fresh->pixel_aspect, fresh->resampled, options, {}, {}};
    for (const RawPlane& raw : fresh->raws) signature.planes.emplace_back(raw.name, raw.type);
    for (const auto& [name, channel] : channels) signature.rules.push_back(channel.rule);
    Present present(*fresh);
    if (const auto entry = known.find(signature, present)) return over(*entry, *fresh);
    const std::scoped_lock lock(known.understanding);
    if (const auto entry = known.find(signature, present)) return over(*entry, *fresh);
    ++known.understood;
    auto entry = std::make_shared<Entry>();
    fresh->looks = &entry->looks;
    finish(*fresh, options, 1);
    fresh->looks = nullptr;
    fresh->fill_row = nullptr;
    entry->signature = std::move(signature);
    entry->impl = *fresh;
    for (RawPlane& raw : entry->impl.raws) raw.memory.data = nullptr;
    const std::scoped_lock entries_lock(known.mutex);
    known.entries.push_front(std::move(entry));
    if (known.entries.size() > kMostFrames) known.entries.pop_back();
    return fresh;
}

}  // namespace gbuffer
}  // namespace relume
