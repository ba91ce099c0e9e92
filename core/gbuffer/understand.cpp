// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "cryptomatte/cryptomatte.h"
#include "gbuffer/gbuffer_impl.h"
#include "gbuffer/names.h"
#include "gbuffer/select.h"
#include "gbuffer/stored_image.h"
#include "relume/error.h"
#include "relume/working_space.h"
#include "text/printable.h"

namespace relume::gbuffer {

namespace {

/// "coat_weight" for "Coat Weight": how a layer answers to a shader parameter.
std::string parameter_name(std::string_view layer) {
    std::string name;
    for (const char c : layer) {
        // Not tolower(): the host's locale may be Turkish, where that leaves an I as it is.
        const bool capital = c >= 'A' && c <= 'Z';
        name.push_back(c == ' ' || c == '-' || c == '.' ? '_' : capital ? static_cast<char>(c - 'A' + 'a') : c);
    }
    return name;
}

bool has_image_extension(std::string_view name) {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string_view::npos) return false;
    const std::string extension = fold(name.substr(dot + 1));
    for (const std::string_view known : {"exr", "png", "jpg", "jpeg", "tif", "tiff", "hdr", "tga", "webp", "bmp"}) {
        if (extension == known) return true;
    }
    return false;
}

/// Digits at the end of a Cryptomatte channel's layer: the number of its pair of ranks.
std::optional<std::pair<std::string, int>> ranked_name(std::string_view label) {
    if (label.size() < 2) return std::nullopt;
    const char tens = label[label.size() - 2], ones = label.back();
    if (tens < '0' || tens > '9' || ones < '0' || ones > '9') return std::nullopt;
    return std::pair(std::string(label.substr(0, label.size() - 2)), (tens - '0') * 10 + (ones - '0'));
}

class Understanding {
public:
    Understanding(SourceFile main, const GBufferOptions& options, int threads) : options_(options), threads_(threads) {
        impl_->files.push_back(std::move(main));
    }

    std::unique_ptr<GBuffer::Impl> run() {
        impl_->producer = file(0).producer.name;
        impl_->producer_reason = file(0).producer.reason;
        choose_part();
        take_windows();
        take_cryptomatte(0);
        take_semantics();
        take_parameters();
        take_working_space();
        convert_decoded_colors();
        finish(*impl_, options_, threads_);
        return std::move(impl_);
    }

private:
    SourceFile& file(int index) { return impl_->files[static_cast<std::size_t>(index)]; }

    const ChannelRule* rule_of(std::string_view semantic) const {
        const auto found = options_.channels.find(std::string(semantic));
        return found == options_.channels.end() ? nullptr : &found->second;
    }

    void choose_part() {
        const std::vector<Candidate> normals = candidates(file(0), "normal");
        const ChannelRule* rule = rule_of("normal");
        if (!normals.empty()) {
            choice_ = choose_group(file(0), normals, options_);
        } else if (rule && rule->channel) {
            choice_ = {options_.part.value_or(""), options_.view.value_or(first_view()), {}};
        } else {
            std::string advice = "name the layer that holds it (--channel normal=LAYER, channels.normal in a rig)";
            const std::vector<io::Part>& parts = file(0).header.parts;
            if (std::any_of(parts.begin(), parts.end(), [](const io::Part& part) { return part.deep; })) {
                advice = "deep parts are not read, flatten them; or " + advice;
            }
            if (file(0).producer.producer == Producer::blender) {
                advice = "turn on the view layer's Normal pass and save as OpenEXR MultiLayer, or " + advice;
            }
            throw Error(ErrorKind::channel,
                        file(0).path.string() + ": no normal channel; it holds " + contents(file(0)) + "; " + advice);
        }
        impl_->group = choice_.group;
        impl_->view = choice_.view;
        impl_->notes.insert(impl_->notes.end(), choice_.notes.begin(), choice_.notes.end());
    }

    std::string first_view() const {
        const std::vector<std::string> all = views(impl_->files.front().header);
        return all.empty() ? std::string() : all.front();
    }

    /// The frame is that of the normal's and the beauty's parts together.
    void take_windows() {
        const io::Header& header = file(0).header;
        std::vector<int> parts;
        for (const std::string_view semantic : {"normal", "beauty"}) {
            const std::optional<Candidate> found = choose(file(0), semantic, choice_);
            if (found) parts.push_back(found->components.front()->address.part);
        }
        if (parts.empty()) parts.push_back(0);
        const io::Part& first = header.parts[static_cast<std::size_t>(parts.front())];
        std::int64_t left = first.data_window.x, top = first.data_window.y;
        std::int64_t right = first.data_window.x_end(), bottom = first.data_window.y_end();
        for (const int index : parts) {
            const Window& other = header.parts[static_cast<std::size_t>(index)].data_window;
            left = std::min<std::int64_t>(left, other.x);
            top = std::min<std::int64_t>(top, other.y);
            right = std::max<std::int64_t>(right, other.x_end());
            bottom = std::max<std::int64_t>(bottom, other.y_end());
        }
        // Parts far apart may each be small.
        const std::int64_t width = right - left, height = bottom - top;
        if (width <= 0 || height <= 0 || width > read_limits(options_).max_pixels / height) {
            throw Error(ErrorKind::format, file(0).path.string() + ": its parts span " + std::to_string(width) + "x" +
                                               std::to_string(height) +
                                               " pixels, more than max_pixels of [gbuffer] allows");
        }
        impl_->data_window = {static_cast<int>(left), static_cast<int>(top), static_cast<int>(width),
                              static_cast<int>(height)};
        impl_->display_window = first.display_window.empty() ? impl_->data_window : first.display_window;
        const bool plausible = first.pixel_aspect > 1e-3f && first.pixel_aspect < 1e3f;
        impl_->pixel_aspect = plausible ? first.pixel_aspect : 1.0f;
        if (!plausible) impl_->notes.push_back("the header's pixel aspect ratio makes no sense: 1 is taken");
    }

    /// Opens a further file and checks that it shows the same frame.
    int add_file(const std::string& name, std::string_view semantic) {
        std::filesystem::path path(name);
        std::error_code ignored;
        if (path.is_relative() && !std::filesystem::exists(path, ignored)) {
            const std::filesystem::path beside = file(0).path.parent_path() / path;
            if (std::filesystem::exists(beside, ignored)) path = beside;
        }
        const SemanticName* meaning = find_semantic(semantic);
        const bool color = meaning && meaning->quantity == Quantity::color;
        for (std::size_t i = 0; i < impl_->files.size(); ++i) {
            const SourceFile& known = impl_->files[i];
            if (known.path == path && (known.integer_bits != 8 || known.decoded == color)) return static_cast<int>(i);
        }
        SourceFile opened = open_file(path, read_limits(options_), color);
        const int index = static_cast<int>(impl_->files.size());
        for (Layer& layer : opened.layers) {
            for (Component& component : layer.components) component.address.file = index;
        }
        for (const io::Part& part : opened.header.parts) {
            const bool same = part.data_window == impl_->data_window ||
                              (part.display_window == impl_->display_window && !part.data_window.empty());
            if (same) continue;
            const auto size = [](const Window& w) { return std::to_string(w.width) + "x" + std::to_string(w.height); };
            throw Error(ErrorKind::channel, path.string() + ": " + std::string(semantic) + " is " +
                                                size(part.data_window) + " pixels, but the G-buffer " +
                                                file(0).path.string() + " is " + size(impl_->data_window));
        }
        impl_->files.push_back(std::move(opened));
        return index;
    }

    void take_semantics() {
        for (const SemanticName& semantic : semantic_names()) take(semantic);
        // Alpha is a component of the beauty in most files.
        if (!impl_->find("alpha") && beauty_alpha_) {
            const Component* alpha = beauty_alpha_;
            Semantic s = make(*find_semantic("alpha"), {alpha});
            s.info.reason = "the beauty's alpha";
            add(std::move(s));
        }
        // Whatever rule is left names a channel for a shader parameter.
        for (const auto& [name, rule] : options_.channels) {
            if (find_semantic(name) || name == "cryptomatte") continue;
            take({name, Quantity::scalar, name, ""});
        }
        if (const ChannelRule* rule = rule_of("cryptomatte"); rule && rule->channel) {
            take_cryptomatte(add_file(*rule->channel, "cryptomatte"));
        }
    }

    void take(const SemanticName& semantic) {
        const ChannelRule* rule = rule_of(semantic.name);
        if (rule && rule->channel) {
            take_named(semantic, *rule);
            return;
        }
        const std::optional<Candidate> found = choose(file(0), semantic.name, choice_);
        if (!found || is_cryptomatte(*found->layer)) return;
        Semantic s = make(semantic, found->components);
        apply_row(s, *found->row);
        if (rule) apply_rule(s, *rule);
        used_.insert(found->layer);
        if (found->row->normalised && !s.far) {
            impl_->notes.push_back(
                "the depth " + s.info.sources.front() +
                " lies between 0 and 1 and nothing tells its range: it is not used; `near` and `far` give it");
            return;
        }
        if (semantic.name == "beauty") beauty_alpha_ = found->layer->find('A');
        if (semantic.name == "base_color") {
            base_alpha_ = found->layer->find('A');
            if (found->row->fallback) note_diffuse(s);
        }
        add(std::move(s));
    }

    /// A diffuse pass holds base colour times 1 − metallic; the rest may stand in a tinted glossy colour pass.
    void note_diffuse(Semantic& s) {
        impl_->notes.push_back(
            "base colour comes from " + s.info.sources.front() +
            " and its like, which renderers darken by metallic (0 for metals); write an albedo AOV to have it exactly");
        for (const std::string_view name : {"GlossCol", "Glossy Color"}) {
            for (const Layer& layer : file(0).layers) {
                const Match fit = match_layer(layer.label(), name);
                if (fit.fit == Fit::none || fit.group != choice_.group || layer.view != choice_.view) continue;
                const std::vector<const Component*> rgb = layer.pick("RGB");
                if (rgb.empty() || !s.glossy.empty()) continue;
                for (const Component* component : rgb) s.glossy.push_back(impl_->raw_of(*component));
            }
        }
    }

    /// A channel, layer or file that the user named.
    void take_named(const SemanticName& semantic, const ChannelRule& rule) {
        const std::string& name = *rule.channel;
        const std::string group = rule.part.value_or(choice_.group);
        std::vector<const Component*> components = find_by_name(file(0), name, group, choice_.view, semantic.quantity);
        int from = 0;
        if (components.empty()) {
            if (!has_image_extension(name)) {
                throw Error(ErrorKind::channel, file(0).path.string() + ": no channel or layer '" + name + "' for " +
                                                    std::string(semantic.name) + "; it holds " + contents(file(0)));
            }
            from = add_file(name, semantic.name);
            components = find_in_file(file(from), semantic, rule.part);
            if (components.empty()) {
                throw Error(ErrorKind::channel, file(from).path.string() + ": no channels for " +
                                                    std::string(semantic.name) + "; it holds " + contents(file(from)));
            }
        }
        Semantic s = make(semantic, components);
        s.info.reason = "named by the user";
        const ProducerTraits& producer = traits(file(from).producer.producer);
        s.averaged = producer.averaged && semantic.quantity != Quantity::depth &&
                     semantic.quantity != Quantity::identifier && semantic.quantity != Quantity::point &&
                     semantic.name != "beauty" && semantic.name != "alpha" && semantic.name != "coverage";
        s.detect_encoding = semantic.quantity == Quantity::direction;
        for (const Layer& layer : file(from).layers) {
            for (const Component& component : layer.components) {
                if (&component != components.front()) continue;
                used_.insert(&layer);
                if (semantic.name == "beauty") beauty_alpha_ = layer.find('A');
                if (semantic.name == "base_color" && layer.components.size() > 1) base_alpha_ = layer.find('A');
                // The table knows the producer's spaces under its own names.
                for (const Candidate& candidate : candidates(file(from), semantic.name)) {
                    if (candidate.layer == &layer) {
                        const std::string reason = s.info.reason;
                        apply_row(s, *candidate.row);
                        s.info.reason = reason + "; " + std::string(candidate.row->reason);
                        break;
                    }
                }
            }
        }
        if (file(from).integer_bits > 0 && semantic.quantity == Quantity::direction) {
            s.detect_encoding = false;
            s.encoding = Encoding::zero_to_one;
            s.info.reason += "; whole numbers hold vectors as (v + 1)/2";
        }
        if (file(from).decoded) s.info.reason += "; colours of 8 bits are decoded from sRGB";
        apply_rule(s, rule);
        add(std::move(s));
    }

    /// One file for one semantic channel: by the rules, else its only layer.
    std::vector<const Component*> find_in_file(const SourceFile& other, const SemanticName& semantic,
                                               const std::optional<std::string>& layer_name) const {
        if (layer_name) return find_by_name(other, *layer_name, "", choice_.view, semantic.quantity);
        const auto view_fits = [&](const Layer& layer) { return layer.view.empty() || layer.view == choice_.view; };
        for (Candidate& candidate : candidates(other, semantic.name)) {
            if (view_fits(*candidate.layer)) return std::move(candidate.components);
        }
        for (const Layer& layer : other.layers) {
            if (!view_fits(layer)) continue;
            std::vector<const Component*> components = components_for(layer, semantic.quantity, "");
            if (!components.empty()) return components;
        }
        return {};
    }

    Semantic make(const SemanticName& semantic, const std::vector<const Component*>& components) {
        Semantic s;
        s.quantity = semantic.quantity;
        s.info.name = semantic.name;
        s.info.components = static_cast<int>(components.size());
        s.info.sources = full_names(components);
        s.layer_name = layer_name(*components.front());
        const Address& address = components.front()->address;
        const SourceFile& source = file(address.file);
        s.info.file = source.path.string();
        if (source.header.parts.size() > 1) {
            s.info.part = source.header.parts[static_cast<std::size_t>(address.part)].name;
        }
        for (const Component* component : components) s.raws.push_back(impl_->raw_of(*component));
        return s;
    }

    /// The name of the layer that a component belongs to, without the chosen group.
    std::string layer_name(const Component& component) {
        for (const Layer& layer : file(component.address.file).layers) {
            if (&component < layer.components.data() || &component >= layer.components.data() + layer.components.size())
                continue;
            std::string_view label = layer.label();
            if (!choice_.group.empty() && label.starts_with(choice_.group + "."))
                label.remove_prefix(choice_.group.size() + 1);
            return parameter_name(label);
        }
        return {};
    }

    void apply_row(Semantic& s, const ChannelRow& row) {
        s.encoding = row.encoding == Code::zero_to_one ? Encoding::zero_to_one : Encoding::as_is;
        s.detect_encoding = row.encoding == Code::detect;
        s.space = row.space;
        // Where the space is an option of the renderer, or nobody's name says it, the pixels must confirm it.
        const bool open = row.producer == Producer::unknown || row.producer == Producer::renderman ||
                          row.producer == Producer::pbrt || row.producer == Producer::karma;
        const bool vector = s.quantity == Quantity::direction || s.quantity == Quantity::point;
        s.detect_space = vector && open && (row.space == Space::world || row.producer != Producer::unknown);
        s.kind = row.depth;
        s.detect_kind = s.quantity == Quantity::depth;
        for (const char axis : row.flip) s.sign[static_cast<std::size_t>(axis - 'x')] *= -1;
        const ProducerTraits& producer = traits(file(0).producer.producer);
        const bool plain = s.info.name == "beauty" || s.info.name == "alpha";
        s.averaged = row.averaged && producer.averaged && !plain;
        // What is not averaged though everything else is, is one sample.
        s.repair = (s.quantity == Quantity::point || s.quantity == Quantity::depth) && producer.averaged;
        if (row.near > 0) {
            s.near = row.near;
            s.near_assumed = true;
        }
        s.two_sided = row.two_sided;
        s.invert = row.invert;
        s.info.reason = row.reason;
    }

    void add(Semantic s) {
        if (s.info.name == "coverage") {
            impl_->coverage.raws = {s.raws.front()};
            impl_->coverage.reason = "the channel " + s.info.sources.front();
        }
        impl_->semantics.push_back(std::move(s));
    }

    bool is_cryptomatte(const Layer& layer) const { return crypto_layers_.contains(&layer); }

    /// Cryptomatte layers: those that the metadata names, and those that look like it.
    void take_cryptomatte(int index) {
        const SourceFile& source = file(index);
        const std::vector<cryptomatte::LayerInfo> infos = cryptomatte::layer_infos(source.header);
        std::map<std::string, std::map<int, const Layer*>> found;
        for (const Layer& layer : source.layers) {
            if (layer.pick("RGBA").empty() || (index == 0 && layer.view != choice_.view)) continue;
            std::optional<std::pair<std::string, int>> ranked = ranked_name(layer.label());
            if (!ranked && layer.name.empty() && infos.size() == 1 && layer.data)
                ranked = std::pair(infos.front().name, 0);
            if (!ranked) continue;
            const bool known =
                std::any_of(infos.begin(), infos.end(), [&](const auto& info) { return info.name == ranked->first; });
            const bool looks = fold(ranked->first).find("crypto") != std::string::npos;
            if (!known && !looks) continue;
            found[ranked->first].emplace(ranked->second, &layer);
            crypto_layers_.insert(&layer);
        }
        for (const auto& [name, ranks] : found) {
            // Another view layer's objects are not in this picture.
            if (index == 0 && !choice_.group.empty() && name.find('.') != std::string::npos &&
                !name.starts_with(choice_.group + ".")) {
                continue;
            }
            CryptoLayer layer;
            layer.name = name;
            for (const auto& [number, rank] : ranks) {
                for (const auto& [id, coverage] : {std::pair('R', 'G'), std::pair('B', 'A')}) {
                    layer.ranks.emplace_back(impl_->raw_of(*rank->find(id)), impl_->raw_of(*rank->find(coverage)));
                }
                if (rank->find('R')->type == PixelType::half) {
                    impl_->notes.push_back("Cryptomatte layer '" + name + "' is stored as half: its IDs are damaged");
                }
            }
            for (const cryptomatte::LayerInfo& info : infos) {
                if (info.name == name) layer.manifest = cryptomatte::load_manifest(info, source.path, impl_->notes);
            }
            std::vector<std::string>& names = impl_->crypto_names[name];
            for (const auto& entry : layer.manifest) names.push_back(printable(entry.first));
            impl_->crypto_layers.push_back(std::move(layer));
        }
    }

    bool is_pass(std::string_view label) const {
        for (const PassRow& row : pass_rows()) {
            if (row.producer != Producer::unknown && row.producer != impl_->files.front().producer.producer) continue;
            for (const std::string_view name : split(row.names, '|')) {
                const Fit fit = match_layer(label, name).fit;
                // User AOVs are spelt as their users like: a pass has its exact name.
                if (fit == Fit::exact || (fit == Fit::tolerant && row.producer == Producer::unknown)) return true;
            }
        }
        return false;
    }

    /// Every other layer of the choice answers to the shader parameter of its name.
    void take_parameters() {
        const ProducerTraits& producer = traits(file(0).producer.producer);
        std::string left_alone;
        for (const Layer& layer : file(0).layers) {
            if (used_.contains(&layer) || is_cryptomatte(layer) || layer.view != choice_.view || layer.label().empty())
                continue;
            std::string_view label = layer.label();
            if (!choice_.group.empty()) {
                if (!label.starts_with(choice_.group + ".")) continue;
                label.remove_prefix(choice_.group.size() + 1);
            }
            if (is_pass(label)) {
                left_alone += (left_alone.empty() ? "" : ", ") + std::string(label);
                continue;
            }
            const std::string name = parameter_name(label);
            if (impl_->find(name) || find_semantic(name)) continue;
            const bool color = !layer.pick("RGB").empty(), vector = !layer.pick("XYZ").empty();
            const Quantity quantity = color || vector ? Quantity::color : Quantity::scalar;
            const std::vector<const Component*> components = components_for(layer, quantity, "");
            if (components.empty()) continue;
            Semantic s = make({name, quantity, name, ""}, components);
            s.averaged = producer.averaged;
            s.info.reason = "its name: a shader parameter of this name takes it";
            add(std::move(s));
        }
        if (!left_alone.empty()) {
            impl_->notes.push_back("passes of light and for compositing are left alone: " + left_alone);
        }
        // In Blender the alpha of any colour AOV is the coverage of the surfaces that write it.
        if (impl_->coverage.raws.empty() && base_alpha_ && file(0).producer.producer == Producer::blender) {
            impl_->coverage.raws = {impl_->raw_of(*base_alpha_)};
            impl_->coverage.reason = "the alpha of the albedo AOV (" + base_alpha_->full_name + ")";
        }
    }

    void take_working_space() {
        const Semantic* beauty = impl_->find("beauty");
        const int part = beauty ? impl_->raws[static_cast<std::size_t>(beauty->raws.front())].address.part : 0;
        if (options_.working_space) {
            impl_->working_space = canonical_space(*options_.working_space);
            impl_->working_space_reason = "given";
        } else if (const auto stated = stated_working_space(file(0).header, part)) {
            std::tie(impl_->working_space, impl_->working_space_reason) = *stated;
            if (impl_->working_space == "unknown") {
                impl_->notes.push_back(impl_->working_space_reason +
                                       ": lights and textures are taken as they are; `working_space` names it");
            }
        } else {
            impl_->working_space_reason = "nothing in the header says otherwise";
        }
        impl_->straight_alpha = options_.alpha == AlphaMode::straight;
    }

    /// What was decoded from sRGB has Rec.709's primaries.
    void convert_decoded_colors() {
        const WorkingSpace* from = find_working_space("lin_rec709");
        const WorkingSpace* to = find_working_space(impl_->working_space);
        if (to == from) return;
        const auto decoded = [](const SourceFile& source) { return source.decoded; };
        if (std::none_of(impl_->files.begin(), impl_->files.end(), decoded)) return;
        if (!to) {
            impl_->notes.push_back("colours decoded from sRGB stay in Rec.709: the working space '" +
                                   impl_->working_space + "' is none that relume can convert to");
            return;
        }
        const ColorMatrix matrix = rgb_to_rgb(from->chromaticities, to->chromaticities);
        for (SourceFile& source : impl_->files) {
            if (source.decoded) convert_colors(source, matrix);
        }
        for (Semantic& s : impl_->semantics) {
            const Address& address = impl_->raws[static_cast<std::size_t>(s.raws.front())].address;
            if (file(address.file).decoded)
                s.info.reason += ", and converted from Rec.709 to " + std::string(to->label);
        }
    }

    const GBufferOptions& options_;
    const int threads_;
    std::unique_ptr<GBuffer::Impl> impl_ = std::make_unique<GBuffer::Impl>();
    Choice choice_;
    std::set<const Layer*> used_;
    std::set<const Layer*> crypto_layers_;
    const Component* beauty_alpha_ = nullptr;
    const Component* base_alpha_ = nullptr;
};

}  // namespace

std::unique_ptr<GBuffer::Impl> understand(SourceFile main, const GBufferOptions& options, int threads) {
    return Understanding(std::move(main), options, threads).run();
}

}  // namespace relume::gbuffer
