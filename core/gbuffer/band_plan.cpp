// SPDX-License-Identifier: Apache-2.0
#include "gbuffer/band_plan.h"

#include <algorithm>

#include "cryptomatte/cryptomatte.h"
#include "gbuffer/names.h"
#include "relume/error.h"

namespace relume::gbuffer {

namespace {

using Registers = std::array<int, 3>;

/// Computed registers are numbered from here while the number of raw ones is still open.
constexpr int kComputed = 1 << 20;

class Planner {
public:
    Planner(const GBuffer::Impl& source, BandPlan& plan) : source_(source), plan_(plan) {}

    void answer(const ChannelRequest& request) {
        switch (request.kind) {
            case ChannelRequest::Kind::semantic:
                emit(widened(semantic(request), request), request.components);
                return;
            case ChannelRequest::Kind::raw:
                emit(widened(raw_request(request), request), request.components);
                return;
            case ChannelRequest::Kind::id:
                plan_.outputs.push_back(identifier(request));
                return;
            case ChannelRequest::Kind::matte:
                plan_.outputs.push_back(matte(request));
                return;
            case ChannelRequest::Kind::constant:
                emit(widened({-1}, request), request.components);
                return;
        }
    }

    void number_registers() {
        const int raws = static_cast<int>(plan_.raws.size());
        const auto renumber = [&](int& r) {
            if (r >= kComputed) r = r - kComputed + raws;
        };
        for (Step& step : plan_.steps) {
            for (int& r : step.in) renumber(r);
            for (int& r : step.out) renumber(r);
            for (int& r : step.sum) renumber(r);
            for (MatteLayer& layer : step.layers) {
                for (auto& [id, coverage] : layer.ranks) renumber(id), renumber(coverage);
            }
        }
        for (int& r : plan_.outputs) renumber(r);
        for (const Step& step : plan_.steps) {
            const bool looks = step.op == Op::repair || step.op == Op::point || step.op == Op::depth ||
                               step.op == Op::identifier || step.op == Op::face ||
                               (step.op == Op::direction && step.in[5] >= 0);
            for (std::size_t k = 0; looks && k < 3; ++k) {
                const int r = step.in[k];
                if (r < 0 || r >= raws) continue;
                if (std::find(plan_.neighbours.begin(), plan_.neighbours.end(), r) == plan_.neighbours.end()) {
                    plan_.neighbours.push_back(r);
                }
            }
        }
        plan_.registers = plan_.raws.size() + static_cast<std::size_t>(computed_);
    }

private:
    [[noreturn]] void missing(const std::string& what, const std::string& advice) const {
        const std::string where = source_.in_memory() ? "G-buffer in memory" : source_.files.front().path.string();
        throw Error(ErrorKind::channel, where + ": no channel for " + what + (advice.empty() ? "" : "; " + advice));
    }

    int fresh() { return kComputed + computed_++; }

    int raw(int index, bool integer = false) { return raw(source_.raws[static_cast<std::size_t>(index)], integer); }

    int raw(const RawPlane& plane, bool integer) {
        for (std::size_t k = 0; k < plan_.raws.size(); ++k) {
            const PlannedRaw& known = plan_.raws[k];
            const bool same = plane.memory.data ? known.plane.memory.data == plane.memory.data &&
                                                      known.plane.memory.type == plane.memory.type &&
                                                      known.plane.memory.x_stride == plane.memory.x_stride &&
                                                      known.plane.memory.y_stride == plane.memory.y_stride
                                                : !known.plane.memory.data && known.plane.address == plane.address;
            if (same && known.integer == integer) return static_cast<int>(k);
        }
        plan_.raws.push_back({plane, integer});
        return static_cast<int>(plan_.raws.size()) - 1;
    }

    /// One component more than there is repeats the first; one less leaves the others out.
    void emit(const std::vector<int>& registers, int components) {
        for (int i = 0; i < components; ++i) {
            const auto index = static_cast<std::size_t>(i);
            plan_.outputs.push_back(index < registers.size() ? registers[index] : registers.front());
        }
    }

    bool has_coverage() const { return !source_.coverage.raws.empty(); }

    /// Coverage and its reciprocal.
    std::pair<int, int> coverage() {
        if (coverage_ < 0) {
            coverage_ = fresh();
            reciprocal_ = fresh();
            Step step;
            step.op = Op::coverage;
            for (const int index : source_.coverage.raws) step.sum.push_back(raw(index));
            step.out = {coverage_, reciprocal_, -1};
            plan_.steps.push_back(std::move(step));
        }
        return {coverage_, reciprocal_};
    }

    int ones() {
        if (ones_ < 0) {
            ones_ = fresh();
            Step step;
            step.op = Op::ones;
            step.out[0] = ones_;
            plan_.steps.push_back(std::move(step));
        }
        return ones_;
    }

    /// value·scale + offset, divided by coverage first where it was averaged.
    int scalar(int index, bool averaged, float scale, float offset) {
        const int value = raw(index);
        const bool divide = averaged && has_coverage();
        if (!divide && scale == 1 && offset == 0) return value;
        Step step;
        step.op = divide ? Op::divide : Op::scale;
        step.in[0] = value;
        if (divide) step.in[1] = coverage().second;
        step.scale = scale;
        step.offset = offset;
        step.out[0] = fresh();
        const int result = step.out[0];
        plan_.steps.push_back(std::move(step));
        return result;
    }

    static void decoding(Step& step, const Semantic& s) {
        const bool decode = s.encoding == Encoding::zero_to_one;
        for (std::size_t i = 0; i < 3; ++i) {
            step.multiply[i] = s.sign[i] * (decode ? 2.0f : 1.0f);
            step.add[i] = decode ? -s.sign[i] : 0.0f;
        }
        // In 8 bits a zero vector comes back as 127 or 128: nearly, not quite 0.
        if (decode) step.background = 2.5e-3f;
    }

    void to_world(Step& step, bool point) const {
        step.transform = true;
        for (std::size_t i = 0; i < 12; ++i) {
            step.matrix[i] = point || i % 4 != 3 ? static_cast<float>(source_.to_world[i]) : 0.0f;
        }
    }

    std::vector<int> direction(const Semantic& s) {
        const auto known = vectors_.find(s.info.name);
        if (known != vectors_.end()) return {known->second.begin(), known->second.end()};
        Registers result{};
        const bool change = s.encoding != Encoding::as_is || s.space == Space::camera ||
                            s.sign != std::array{1.f, 1.f, 1.f} || !s.unit || has_coverage() || shows_faces(s);
        if (!change) {
            for (std::size_t i = 0; i < 3; ++i) result[i] = raw(s.raws[i]);
        } else {
            Step step;
            step.op = Op::direction;
            decoding(step, s);
            for (std::size_t i = 0; i < 3; ++i) step.in[i] = raw(s.raws[i]);
            if (has_coverage()) step.in[3] = coverage().first;
            // A mean of (n + 1)/2 and the background's 0 decodes only once the background is taken out.
            if (has_coverage() && s.averaged && s.encoding == Encoding::zero_to_one) step.in[4] = coverage().second;
            if (s.space == Space::camera) to_world(step, false);
            if (shows_faces(s)) step.in[5] = faces().first;
            for (int& r : step.out) r = fresh();
            result = step.out;
            plan_.steps.push_back(std::move(step));
        }
        if (s.two_sided) {
            const std::vector<int> v = view();
            Step step;
            step.op = Op::turn;
            for (std::size_t i = 0; i < 3; ++i) step.in[i] = result[i], step.in[i + 3] = v[i];
            for (int& r : step.out) r = fresh();
            result = step.out;
            plan_.steps.push_back(std::move(step));
        }
        vectors_[s.info.name] = result;
        return {result.begin(), result.end()};
    }

    /// What alpha² grows by where the pixel averages normals.
    int variance() {
        if (variance_ >= 0) return variance_;
        const Semantic& normal = *source_.find("normal");
        Step step;
        step.op = Op::variance;
        decoding(step, normal);
        for (std::size_t i = 0; i < 3; ++i) step.in[i] = raw(normal.raws[i]);
        if (has_coverage()) step.in[3] = coverage().first;
        if (has_coverage() && normal.averaged) step.in[4] = coverage().second;
        step.scale = source_.normal_variance.dead_zone;
        step.near = source_.normal_variance.edge_dead_zone;
        variance_ = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return variance_;
    }

    /// Whether this is a normal that the face beside a crease may stand in for: one whose neighbours can be judged by
    /// what they store.
    bool shows_faces(const Semantic& s) const {
        const bool encoded = s.encoding == Encoding::zero_to_one && s.averaged && has_coverage();
        return s.info.name == "normal" && source_.normal_variance.on && !encoded;
    }

    /// The pixels whose faces stand in, and the variance that is left then.
    std::pair<int, int> faces() {
        if (face_ >= 0) return {face_, face_variance_};
        const Semantic& normal = *source_.find("normal");
        const int mixed = variance();
        if (!shows_faces(normal)) return {-1, mixed};
        Step step;
        step.op = Op::face;
        decoding(step, normal);
        for (std::size_t i = 0; i < 3; ++i) step.in[i] = raw(normal.raws[i]);
        step.in[3] = mixed;
        step.scale = source_.normal_variance.dead_zone;
        const RawPlane& plane = source_.raws[static_cast<std::size_t>(normal.raws.front())];
        if (!plane.memory.data) {
            // The rows of other blocks may have to be decoded for the purpose: they are left alone.
            const SourceFile& file = source_.files[static_cast<std::size_t>(plane.address.file)];
            const io::Part& part = file.header.parts[static_cast<std::size_t>(plane.address.part)];
            step.block_rows = rows_of_band(part.rows_per_chunk);
            step.block_top = part.data_window.y;
        }
        face_ = step.out[0] = fresh();
        face_variance_ = step.out[1] = fresh();
        plan_.steps.push_back(std::move(step));
        return {face_, face_variance_};
    }

    /// Widths of highlights, wider by what the pixel averages. A register of -1 is the request's constant.
    std::vector<int> widened(std::vector<int> registers, const ChannelRequest& request) {
        const bool widen = request.widen != LobeWidth::none && source_.normal_variance.on;
        for (int& r : registers) {
            if (!widen && r >= 0) continue;
            Step step;
            step.op = Op::widen;
            step.in[0] = r;
            step.in[1] = widen ? faces().second : ones();
            step.offset = static_cast<float>(request.offset);
            step.lobe_width = widen ? request.widen : LobeWidth::none;
            r = step.out[0] = fresh();
            plan_.steps.push_back(std::move(step));
        }
        return registers;
    }

    std::vector<int> view() {
        if (const Semantic* given = source_.find("view")) return direction(*given);
        const auto known = vectors_.find("view");
        if (known != vectors_.end()) return {known->second.begin(), known->second.end()};
        Registers result{};
        if (source_.view_source == ViewSource::normal) {
            // Nothing is known of the camera: each surface is seen head-on.
            Semantic facing = *source_.find("normal");
            facing.two_sided = false;
            const std::vector<int> n = direction(facing);
            std::copy(n.begin(), n.end(), result.begin());
        } else {
            Step step;
            step.op = Op::view;
            for (int& r : step.out) r = fresh();
            result = step.out;
            plan_.steps.push_back(std::move(step));
        }
        vectors_["view"] = result;
        return {result.begin(), result.end()};
    }

    /// Offsets to the pixels that stand in for those whose single sample hit the background, or -1.
    int repair() {
        if (repair_known_) return repair_;
        repair_known_ = true;
        const Semantic* position = source_.find("position");
        const Semantic* depth = source_.find("depth");
        const Semantic* judge = position && position->repair ? position : depth && depth->repair ? depth : nullptr;
        const Semantic* normal = source_.find("normal");
        if (!judge || judge->averaged || (!has_coverage() && !normal)) return repair_;
        Step step;
        step.op = Op::repair;
        step.ray = judge == depth;
        for (std::size_t i = 0; i < judge->raws.size(); ++i) step.in[i] = raw(judge->raws[i]);
        if (has_coverage()) {
            step.in[3] = coverage().first;
        } else {
            for (std::size_t i = 0; i < 3; ++i) step.in[i + 3] = raw(normal->raws[i]);
        }
        // For depths the background is far away or at the far end; for positions it is the origin.
        step.scale = depth && depth == judge && depth->far ? 1.0f : 1e9f;
        const RawPlane& plane = source_.raws[static_cast<std::size_t>(judge->raws.front())];
        if (!plane.memory.data) {
            const SourceFile& file = source_.files[static_cast<std::size_t>(plane.address.file)];
            const io::Part& part = file.header.parts[static_cast<std::size_t>(plane.address.part)];
            plan_.chunk_rows = std::max(part.rows_per_chunk, 1);
            plan_.chunk_top = part.data_window.y;
        }
        repair_ = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return repair_;
    }

    std::vector<int> point() {
        const auto known = vectors_.find("position");
        if (known != vectors_.end()) return {known->second.begin(), known->second.end()};
        Registers result{};
        const Semantic* s = source_.find("position");
        Step step;
        if (s) {
            const int stand_in = s->repair && !s->averaged ? repair() : -1;
            const bool divide = s->averaged && has_coverage();
            const bool change = divide || stand_in >= 0 || s->space == Space::camera ||
                                s->sign != std::array{1.f, 1.f, 1.f} || s->encoding != Encoding::as_is;
            if (!change) {
                for (std::size_t i = 0; i < 3; ++i) result[i] = raw(s->raws[i]);
                vectors_["position"] = result;
                return {result.begin(), result.end()};
            }
            step.op = Op::point;
            decoding(step, *s);
            for (std::size_t i = 0; i < 3; ++i) step.in[i] = raw(s->raws[i]);
            step.in[3] = stand_in;
            if (divide) step.in[4] = coverage().second;
            if (s->space == Space::camera) to_world(step, true);
            step.ray = source_.camera.has_value();
        } else {
            if (!source_.find("depth")) missing("position", "give a position, or a depth and a camera");
            if (source_.view_source != ViewSource::camera) {
                missing("position", "it follows from the depth once a camera is given (a matrix, or a field of view)");
            }
            step.op = Op::point_at_depth;
            step.in[0] = depth();
        }
        for (int& r : step.out) r = fresh();
        result = step.out;
        plan_.steps.push_back(std::move(step));
        vectors_["position"] = result;
        return {result.begin(), result.end()};
    }

    int depth() {
        if (depth_ >= 0) return depth_;
        const Semantic* s = source_.find("depth");
        if (!s) {
            if (!source_.find("position") || source_.view_source != ViewSource::camera) {
                missing("depth", "give a depth, or a position and a camera");
            }
            const std::vector<int> p = point();
            Step step;
            step.op = Op::depth_of_point;
            for (std::size_t i = 0; i < 3; ++i) step.in[i] = p[i];
            depth_ = step.out[0] = fresh();
            plan_.steps.push_back(std::move(step));
            return depth_;
        }
        const bool ray = s->kind == DepthKind::ray;
        if (ray && source_.view_source != ViewSource::camera) {
            missing("depth", "a depth along the ray becomes a depth along the view axis once a camera is given");
        }
        const int stand_in = s->repair && !s->averaged ? repair() : -1;
        const bool divide = s->averaged && has_coverage();
        if (!ray && stand_in < 0 && !s->far && !divide) return depth_ = raw(s->raws.front());
        Step step;
        step.op = Op::depth;
        step.in[0] = raw(s->raws.front());
        step.in[1] = stand_in;
        if (divide) step.in[2] = coverage().second;
        step.ray = ray;
        if (s->far) {
            const double near = s->near.value_or(0);
            step.scale = static_cast<float>(*s->far - near);
            step.offset = static_cast<float>(near);
        } else if (ray && s->near) {
            step.near = static_cast<float>(*s->near);
        }
        depth_ = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return depth_;
    }

    std::vector<int> semantic(const ChannelRequest& request) {
        const std::string& name = request.name;
        if (name == "coverage") return {has_coverage() ? coverage().first : ones()};
        if (name == "view") return view();
        if (name == "position") return point();
        if (name == "depth") return {depth()};
        if (name == "normal_variance" && source_.normal_variance.on) return {faces().second};
        const Semantic* s = source_.find(name);
        if (name == "alpha" && !s) return {ones()};
        if (!s) missing(name, "");
        if (s->quantity == Quantity::direction) return direction(*s);
        const auto scale = static_cast<float>((s->invert ? -1.0 : 1.0) * request.scale);
        const auto offset = static_cast<float>((s->invert ? request.scale : 0.0) + request.offset);
        std::vector<int> registers;
        for (std::size_t i = 0; i < s->raws.size(); ++i) {
            int result = -1;
            if (!s->glossy.empty()) {
                result = metal_base(*s, i);
            } else if (name == "beauty" && source_.straight_alpha && source_.find("alpha")) {
                Step step;
                step.op = Op::product;
                step.in[0] = raw(s->raws[i]);
                step.in[1] = raw(source_.find("alpha")->raws.front());
                result = step.out[0] = fresh();
                plan_.steps.push_back(std::move(step));
            } else {
                result = scalar(s->raws[i], s->averaged, scale, offset);
            }
            registers.push_back(result);
        }
        return registers;
    }

    int metal_base(const Semantic& s, std::size_t component) {
        Step step;
        step.op = Op::metal_base;
        step.in[0] = raw(s.raws[component]);
        ChannelRequest metallic;
        metallic.name = "metallic";
        step.in[1] = semantic(metallic).front();
        step.in[2] = raw(s.glossy[component]);
        if (s.averaged && has_coverage()) step.in[3] = coverage().second;
        const int result = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return result;
    }

    std::vector<int> raw_request(const ChannelRequest& request) {
        const auto scale = static_cast<float>(request.scale), offset = static_cast<float>(request.offset);
        std::vector<int> registers;
        if (!source_.in_memory()) {
            const SourceFile& file = source_.files.front();
            const Quantity quantity = request.components == 3 ? Quantity::color : Quantity::scalar;
            std::vector<const Component*> found =
                find_by_name(file, request.name, source_.group, source_.view, quantity);
            // A layer of one channel serves a colour as grey.
            if (found.empty() && quantity == Quantity::color) {
                found = find_by_name(file, request.name, source_.group, source_.view, Quantity::scalar);
            }
            for (const Component* component : found) {
                RawPlane plane{component->full_name, component->type, component->address, {}};
                registers.push_back(scaled(raw(plane, false), averaged(*component), scale, offset));
            }
        }
        if (registers.empty()) {
            if (const Semantic* s = source_.find(request.name)) {
                for (const int index : s->raws) registers.push_back(scalar(index, s->averaged, scale, offset));
            }
        }
        if (registers.empty()) missing("'" + request.name + "'", "");
        return registers;
    }

    int scaled(int value, bool averaged_value, float scale, float offset) {
        const bool divide = averaged_value && has_coverage();
        if (!divide && scale == 1 && offset == 0) return value;
        Step step;
        step.op = divide ? Op::divide : Op::scale;
        step.in[0] = value;
        if (divide) step.in[1] = coverage().second;
        step.scale = scale;
        step.offset = offset;
        const int result = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return result;
    }

    /// Whether a channel asked for by its own name was averaged over the pixel: as the semantic channel that it belongs
    /// to.
    bool averaged(const Component& component) const {
        for (const Semantic& s : source_.semantics) {
            const auto& sources = s.info.sources;
            if (std::find(sources.begin(), sources.end(), component.full_name) != sources.end()) return s.averaged;
        }
        return false;
    }

    int identifier(const ChannelRequest& request) {
        const Semantic* s = source_.find(request.name);
        if (!s) missing(request.name, "");
        const int index = s->raws.front();
        const bool stored = source_.raws[static_cast<std::size_t>(index)].type == PixelType::uint32;
        const int stand_in = s->averaged || source_.in_memory() ? -1 : repair();
        const int value = raw(index, stored);
        if (stored && stand_in < 0) return value;
        Step step;
        step.op = Op::identifier;
        step.in[0] = value;
        step.in[1] = stand_in;
        step.ray = stored;
        const int result = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return result;
    }

    int matte(const ChannelRequest& request) {
        if (source_.crypto_layers.empty()) {
            missing("the Cryptomatte '" + (request.patterns.empty() ? std::string() : request.patterns.front()) + "'",
                    "the G-buffer has no Cryptomatte layer");
        }
        Step step;
        step.op = Op::matte;
        for (const CryptoLayer& layer : source_.crypto_layers) {
            MatteLayer wanted;
            wanted.ids = cryptomatte::ids_of(request.patterns, layer.name, layer.manifest);
            if (wanted.ids.empty()) continue;
            for (const auto& [id, share] : layer.ranks) {
                const int id_register = raw(id);
                wanted.ranks.emplace_back(id_register, raw(share));
            }
            step.layers.push_back(std::move(wanted));
        }
        const int result = step.out[0] = fresh();
        plan_.steps.push_back(std::move(step));
        return result;
    }

    const GBuffer::Impl& source_;
    BandPlan& plan_;
    std::map<std::string, Registers> vectors_;
    int computed_ = 0;
    int coverage_ = -1, reciprocal_ = -1, ones_ = -1, depth_ = -1, repair_ = -1;
    int variance_ = -1, face_ = -1, face_variance_ = -1;
    bool repair_known_ = false;
};

}  // namespace

BandPlan::BandPlan(const GBuffer::Impl& source, std::span<const ChannelRequest> requests) {
    Planner planner(source, *this);
    for (const ChannelRequest& request : requests) planner.answer(request);
    planner.number_registers();
}

}  // namespace relume::gbuffer
