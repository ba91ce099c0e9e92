// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/names.h"
#include "gbuffer/normal_variance.h"
#include "gbuffer/sampling.h"
#include "relume/error.h"
#include "text/number_format.h"

namespace relume {

const gbuffer::Semantic* GBuffer::Impl::find(std::string_view name) const {
    for (const gbuffer::Semantic& semantic : semantics) {
        if (semantic.info.name == name) return &semantic;
    }
    // "position" and its like mean what they say; a parameter may be called otherwise in the file.
    if (gbuffer::find_semantic(name) || name == "view") return nullptr;
    const std::string folded = gbuffer::fold(name);
    for (const gbuffer::Semantic& semantic : semantics) {
        if (gbuffer::fold(semantic.info.name) == folded || gbuffer::fold(semantic.layer_name) == folded)
            return &semantic;
    }
    return nullptr;
}

gbuffer::Semantic* GBuffer::Impl::find(std::string_view name) {
    return const_cast<gbuffer::Semantic*>(std::as_const(*this).find(name));
}

int GBuffer::Impl::raw_of(const gbuffer::Component& component) {
    for (std::size_t k = 0; k < raws.size(); ++k) {
        if (!raws[k].memory.data && raws[k].address == component.address) return static_cast<int>(k);
    }
    raws.push_back({component.full_name, component.type, component.address, {}});
    return static_cast<int>(raws.size()) - 1;
}

}  // namespace relume

namespace relume::gbuffer {

namespace {

std::string percent(double share) { return format_numbers("%.3g %%", {100 * share}); }

std::string number(double value) { return format_numbers("%.4g", {value}); }

/// The planes that detection looks at, each sampled once.
class Sample {
public:
    explicit Sample(const GBuffer::Impl& impl) : impl_(impl) {}

    /// Index of the first of the semantic's planes in each sampled row, -1 when there is no such channel.
    int want(const Semantic* semantic) {
        if (!semantic) return -1;
        const int first = static_cast<int>(raws_.size());
        raws_.insert(raws_.end(), semantic->raws.begin(), semantic->raws.end());
        return first;
    }
    int want(const std::vector<int>& raws) {
        if (raws.empty()) return -1;
        const int first = static_cast<int>(raws_.size());
        raws_.insert(raws_.end(), raws.begin(), raws.end());
        return first;
    }
    void read(int threads) { rows = sample_rows(impl_, raws_, threads); }
    /// Where these planes stand in each sampled row; empty when one of them is missing.
    std::vector<int> places(const std::vector<int>& raws) const {
        std::vector<int> found;
        for (const int raw : raws) {
            const auto at = std::find(raws_.begin(), raws_.end(), raw);
            if (at == raws_.end()) return {};
            found.push_back(static_cast<int>(at - raws_.begin()));
        }
        return found;
    }

    std::vector<SampledRow> rows;

private:
    const GBuffer::Impl& impl_;
    std::vector<int> raws_;
};

void detect_encoding(Semantic& s, const DirectionStatistics& statistics) {
    if (s.detect_encoding) {
        s.detect_encoding = false;
        const std::string count = std::to_string(statistics.samples);
        if (statistics.samples > 0 && statistics.negative < 0.005 && statistics.unit_decoded > 0.5 &&
            statistics.unit_decoded > statistics.unit) {
            s.encoding = Encoding::zero_to_one;
            s.info.reason += "; stored as (v + 1)/2: of " + count + " sampled pixels none is negative and " +
                             percent(statistics.unit_decoded) + " have unit length once decoded";
        } else if (statistics.samples > 0) {
            s.info.reason += "; signed: of " + count + " sampled pixels " + percent(statistics.negative) +
                             " have a negative component and " + percent(statistics.unit) + " unit length";
        }
    }
}

/// The alpha that coverage was to come from, held against the normals: an AOV that not every material writes is no
/// coverage. The share of pixels with a full normal but little alpha.
double uncovered(std::span<const SampledRow> rows, int normal, int alpha) {
    std::int64_t full = 0, without = 0;
    for (const SampledRow& row : rows) {
        for (std::size_t i = 0; i < row.planes.front().size(); ++i) {
            double square = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const double v = row.planes[static_cast<std::size_t>(normal) + k][i];
                square += v * v;
            }
            if (!(square > 0.98)) continue;
            ++full;
            without += row.planes[static_cast<std::size_t>(alpha)][i] < 0.5f;
        }
    }
    return full > 0 ? static_cast<double>(without) / static_cast<double>(full) : 0.0;
}

bool any_below_one(std::span<const SampledRow> rows, int plane) {
    return std::any_of(rows.begin(), rows.end(), [&](const SampledRow& row) {
        const std::vector<float>& values = row.planes[static_cast<std::size_t>(plane)];
        return std::any_of(values.begin(), values.end(), [](float v) { return v < 0.999f; });
    });
}

void choose_coverage(GBuffer::Impl& impl, const Sample& sample, int normal, int albedo_alpha, int alpha) {
    const bool averaged =
        std::any_of(impl.semantics.begin(), impl.semantics.end(), [](const Semantic& s) { return s.averaged; });
    if (!impl.coverage.raws.empty()) {
        if (impl.find("coverage")) return;
        const double share = uncovered(sample.rows, normal, albedo_alpha);
        if (share < 1e-3) return;
        impl.notes.push_back(percent(share) +
                             " of the surfaces do not write the albedo AOV: its alpha is not taken as coverage");
        impl.coverage = {};
    }
    if (!averaged || impl.in_memory()) return;
    const Semantic* beauty_alpha = impl.find("alpha");
    if (beauty_alpha && any_below_one(sample.rows, alpha)) {
        impl.coverage = {beauty_alpha->raws, "the beauty's alpha: the film is transparent"};
        return;
    }
    for (const CryptoLayer& layer : impl.crypto_layers) {
        std::vector<int> shares;
        for (const auto& rank : layer.ranks) shares.push_back(rank.second);
        impl.coverage = {shares, "the sum of the coverages in Cryptomatte layer '" + layer.name + "'"};
        return;
    }
    if (beauty_alpha) {
        impl.coverage = {beauty_alpha->raws, "the beauty's alpha"};
        return;
    }
    impl.notes.push_back(
        "nothing tells how much of a pixel is covered (no alpha, no Cryptomatte): roughness and its like stay "
        "darkened at silhouettes");
}

/// Blender's glossy colour holds the metals' base colour only where it is tinted.
void judge_glossy(GBuffer::Impl& impl, const Sample& sample, int glossy) {
    Semantic* base = impl.find("base_color");
    if (!base || base->glossy.empty()) return;
    std::int64_t bright = 0, tinted = 0;
    for (const SampledRow& row : sample.rows) {
        for (std::size_t i = 0; i < row.planes.front().size(); ++i) {
            const auto at = [&](int k) { return row.planes[static_cast<std::size_t>(glossy + k)][i]; };
            const float largest = std::max({at(0), at(1), at(2)}), smallest = std::min({at(0), at(1), at(2)});
            if (!(largest > 0.1f)) continue;
            ++bright;
            tinted += largest - smallest > 0.02f * largest;
        }
    }
    if (!impl.find("metallic") || tinted == 0) {
        base->glossy.clear();
        return;
    }
    base->info.reason += "; plus metallic times the glossy colour, which is tinted in " +
                         percent(static_cast<double>(tinted) / static_cast<double>(bright)) + " of its bright samples";
}

std::string division(const GBuffer::Impl& impl, const Semantic& s) {
    if (!s.averaged) return "";
    return impl.coverage.raws.empty() ? ", averaged over the pixel" : ", divided by coverage";
}

/// Whether a part holds other numbers than were written.
bool is_lossy(const io::Part& part) {
    const auto holds = [&](PixelType type) { return std::ranges::count(part.channels, type, &io::Channel::type) > 0; };
    switch (part.compression) {
        case io::Compression::dwaa:
        case io::Compression::dwab:
        case io::Compression::lj2k:
            return holds(PixelType::half) || holds(PixelType::float32);
        case io::Compression::b44:
        case io::Compression::b44a:
            return holds(PixelType::half);
        case io::Compression::pxr24:
            return holds(PixelType::float32);
        default:
            return false;
    }
}

void note_lossy(GBuffer::Impl& impl) {
    for (const SourceFile& file : impl.files) {
        const auto part = std::ranges::find_if(file.header.parts, is_lossy);
        if (part == file.header.parts.end()) continue;
        impl.notes.push_back("the compression '" + std::string(io::name_of(part->compression)) +
                             "' changes numbers: normals, positions and what is fitted to them are off, and names of a "
                             "Cryptomatte may not be found; have G-buffers written with 'zip'");
        return;
    }
}

}  // namespace

void apply_rule(Semantic& s, const ChannelRule& rule) {
    if (rule.encoding) {
        s.encoding = *rule.encoding;
        s.detect_encoding = false;
    }
    if (rule.space) {
        s.space = *rule.space;
        s.detect_space = false;
    }
    if (rule.flip) {
        s.sign = {1, 1, 1};
        for (const char axis : *rule.flip) {
            if (axis < 'x' || axis > 'z') {
                throw Error(ErrorKind::value,
                            "flip of channel " + s.info.name + " is '" + *rule.flip + "'; it names axes: x, y, z");
            }
            s.sign[static_cast<std::size_t>(axis - 'x')] *= -1;
        }
    }
    if (rule.kind) {
        s.kind = *rule.kind;
        s.detect_kind = false;
    }
    if (rule.near) {
        s.near = rule.near;
        s.near_assumed = false;
    }
    if (rule.far) s.far = rule.far;
    if (rule.invert) s.invert = *rule.invert;
    if (rule.premultiplied) s.averaged = *rule.premultiplied;
}

std::string interpretation(const Semantic& s) {
    std::string text;
    const auto add = [&](const std::string& words) { text += (text.empty() ? "" : ", ") + words; };
    const bool vector = s.quantity == Quantity::direction || s.quantity == Quantity::point;
    if (vector) {
        add(s.space == Space::world ? "world space" : "camera space");
        if (s.quantity == Quantity::direction || s.encoding == Encoding::zero_to_one) {
            add(s.encoding == Encoding::zero_to_one ? "0..1" : "-1..1");
        }
        std::string flipped;
        for (std::size_t i = 0; i < 3; ++i) {
            if (s.sign[i] < 0) flipped.push_back(static_cast<char>('x' + i));
        }
        if (!flipped.empty()) add(flipped + " flipped");
        if (s.quantity == Quantity::direction && !s.unit) add("normalised");
        if (s.two_sided) add("turned to the viewer");
    }
    if (s.quantity == Quantity::depth) {
        add(s.kind == DepthKind::ray ? "along the pixel's ray" : "along the view axis");
        if (s.far) {
            add("normalised: " + number(s.near.value_or(0)) + " to " + number(*s.far));
        } else if (s.near && s.kind == DepthKind::ray) {
            add("from the near plane at " + number(*s.near));
        }
    }
    if (s.repair && !s.averaged) add("one sample a pixel, edges repaired from the row");
    if (s.quantity == Quantity::color) add("scene-linear");
    if (s.quantity == Quantity::identifier) add("rounded to whole numbers");
    if (s.invert) add("1 - value");
    return text;
}

void finish(GBuffer::Impl& impl, const GBufferOptions& options, int threads) {
    note_lossy(impl);
    Semantic* normal = impl.find("normal");
    const Semantic* position = impl.find("position");
    Semantic* tangent = impl.find("tangent");
    Sample sample(impl);
    const int normal_planes = sample.want(normal);
    const int tangent_planes = sample.want(tangent);
    const int position_planes = sample.want(position);
    const int depth_plane = sample.want(impl.find("depth"));
    const int alpha_plane = sample.want(impl.find("alpha"));
    const int coverage_plane = sample.want(impl.coverage.raws);
    if (impl.coverage.raws.empty() && !impl.crypto_layers.empty()) {
        for (const auto& rank : impl.crypto_layers.front().ranks) sample.want(std::vector{rank.second});
    }
    const Semantic* base = impl.find("base_color");
    const int glossy_planes = base ? sample.want(base->glossy) : -1;
    sample.read(threads);

    for (const auto& [semantic, planes] : {std::pair(normal, normal_planes), std::pair(tangent, tangent_planes)}) {
        if (!semantic) continue;
        const DirectionStatistics statistics = direction_statistics(sample.rows, static_cast<std::size_t>(planes));
        detect_encoding(*semantic, statistics);
        // Arrays in memory are used where they stand when they need no change; files are normalised anyway.
        semantic->unit =
            impl.in_memory() && !impl.resampled && semantic->encoding == Encoding::as_is && statistics.near_unit == 1.0;
    }
    choose_coverage(impl, sample, normal_planes, coverage_plane, alpha_plane);
    judge_glossy(impl, sample, glossy_planes);
    const std::vector<int> coverage_planes = sample.places(impl.coverage.raws);
    if (normal_planes >= 0 && coverage_planes.size() == impl.coverage.raws.size())
        judge_normal_variance(impl, options, {sample.rows, static_cast<std::size_t>(normal_planes), coverage_planes});
    set_up_camera(impl, options, {sample.rows, position_planes, depth_plane, normal_planes}, threads);

    for (Semantic& s : impl.semantics) {
        s.info.interpretation = interpretation(s) + division(impl, s);
        if (s.info.interpretation.starts_with(", ")) s.info.interpretation.erase(0, 2);
        if (s.info.name == "beauty")
            s.info.interpretation =
                "as rendered, " + std::string(impl.straight_alpha ? "straight alpha" : "premultiplied");
        if (s.info.interpretation.empty()) s.info.interpretation = "as it is";
        impl.infos.push_back(s.info);
    }
    const auto derived = [&](std::string_view name, int components, const std::string& how, const std::string& reason) {
        if (impl.find(name)) return;
        ChannelInfo info;
        info.name = name;
        info.components = components;
        info.interpretation = how;
        info.reason = reason;
        impl.infos.push_back(std::move(info));
    };
    if (!impl.coverage.raws.empty()) {
        ChannelInfo info;
        info.name = "coverage";
        for (const int raw : impl.coverage.raws) info.sources.push_back(impl.raws[static_cast<std::size_t>(raw)].name);
        info.interpretation = "share of the pixel that surfaces cover";
        info.reason = impl.coverage.reason;
        if (!impl.find("coverage")) impl.infos.push_back(std::move(info));
    }
    if (impl.normal_variance.on) {
        ChannelInfo info = impl.find("normal")->info;
        info.name = "normal_variance";
        info.components = 1;
        info.interpretation = "what alpha² of highlights grows by: 2(1 − |N|)/|N|, from |N| = 1 − " +
                              number(static_cast<double>(impl.normal_variance.dead_zone)) + " down";
        info.reason = impl.normal_variance.reason;
        impl.infos.push_back(std::move(info));
    }
    if (impl.find("depth") && impl.view_source == ViewSource::camera) {
        derived("position", 3, "world space", "from the depth along the camera's rays");
    }
    if (impl.find("position") && impl.view_source == ViewSource::camera) {
        derived("depth", 1, "along the view axis", "from the position and the camera");
    }
    derived("view", 3, "world space, unit, to the camera",
            impl.view_source == ViewSource::camera ? "from the camera"
                                                   : "no camera: every surface is seen along its normal");
    for (const SemanticName& semantic : semantic_names()) {
        const bool known = std::any_of(impl.infos.begin(), impl.infos.end(),
                                       [&](const ChannelInfo& i) { return i.name == semantic.name; });
        if (known || semantic.absent.empty()) continue;
        impl.notes.push_back("no " + std::string(semantic.label) + ": assumed is " + std::string(semantic.absent));
    }
}

}  // namespace relume::gbuffer
