// SPDX-License-Identifier: Apache-2.0
#include "scenes/renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "cryptomatte/cryptomatte.h"
#include "threads/workers.h"

namespace relume::scene {
namespace {

constexpr std::string_view kLayer = "ViewLayer.";
constexpr std::string_view kMatte = "ViewLayer.CryptoObject";
/// Two ranks a layer: a pixel that sees more than four objects loses the smallest.
constexpr int kMatteLayers = 2;

/// Eight lower-case digits, as manifests hold them.
std::string hexadecimal(std::uint32_t id) {
    std::string text(8, '0');
    for (std::size_t digit = 8; digit-- > 0; id >>= 4) text[digit] = "0123456789abcdef"[id & 15];
    return text;
}

/// Where in the pixel ray `sample` goes, in [0, 1)²: one through the centre, several by the R₂ sequence (Roberts 2018),
/// moved as a whole by two random numbers of the pixel's own, so that each ray alone is uniform over the pixel.
class PixelPattern {
public:
    PixelPattern(std::uint32_t pixel, int samples) : single_(samples == 1) {
        const auto words = philox({pixel, 0, 0, 0}, {0x6A697474, 0x65720000});
        start_ = {to_unit(words[0]), to_unit(words[1])};
    }
    glm::dvec2 operator()(int sample) const {
        if (single_) return {0.5, 0.5};
        const auto part = [](double x) { return x - std::floor(x); };
        return {part(start_.x + sample * 0.7548776662466927), part(start_.y + sample * 0.5698402909980532)};
    }

private:
    bool single_;
    glm::dvec2 start_;
};

class Renderer {
public:
    Renderer(const Scene& scene, const SceneOptions& options)
        : scene_(scene), options_(options), specs_(scene.channels()) {
        image_.window = {0, 0, options.width, options.height};
        image_.camera = scene.camera();
        for (const ChannelSpec& spec : specs_) add(spec.name);
        if (has_beauty()) {
            for (const char* component : {"R", "G", "B", "A"}) add("Combined." + std::string(component));
        }
        for (int layer = 0; layer < kMatteLayers; ++layer) {
            for (const char* component : {"r", "g", "b", "a"}) {
                add("CryptoObject0" + std::to_string(layer) + "." + component);
            }
        }
        for (const std::string_view object : scene.objects()) ids_.push_back(cryptomatte::id_bits(object));
        add_attributes();
    }

    SceneImage run() && {
        parallel_for(options_.height, options_.threads, nullptr, [this](int, int j) {
            for (int i = 0; i < options_.width; ++i) render_pixel(i, j);
        });
        std::sort(image_.channels.begin(), image_.channels.end(),
                  [](const SceneChannel& a, const SceneChannel& b) { return a.name < b.name; });
        return std::move(image_);
    }

private:
    bool has_beauty() const { return !scene_.random() || options_.paths > 0; }

    void add(std::string_view name) {
        const auto size = static_cast<std::size_t>(options_.width) * static_cast<std::size_t>(options_.height);
        image_.channels.push_back({std::string(kLayer) + std::string(name), std::vector<float>(size)});
    }

    void add_attributes() {
        const std::string key = "cryptomatte/" + hexadecimal(cryptomatte::id_bits(kMatte)).substr(0, 7) + "/";
        std::string manifest;
        for (const std::string_view object : scene_.objects()) {
            manifest += (manifest.empty() ? "{\"" : ",\"") + std::string(object) + "\":\"" +
                        hexadecimal(cryptomatte::id_bits(object)) + "\"";
        }
        image_.attributes[key + "name"] = kMatte;
        image_.attributes[key + "hash"] = "MurmurHash3_32";
        image_.attributes[key + "conversion"] = "uint32_to_float32";
        image_.attributes[key + "manifest"] = manifest + "}";
    }

    void render_pixel(int i, int j) {
        const std::size_t at =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(options_.width) + static_cast<std::size_t>(i);
        const auto pixel = static_cast<std::uint32_t>(at);
        const Surface centre = scene_.trace({i + 0.5, j + 0.5});

        std::array<double, 64> sums{};
        std::array<int, 64> seen{};
        glm::dvec3 beauty(0);
        const PixelPattern pattern(pixel, options_.samples);
        const int paths = scene_.random() ? options_.paths : 1;
        for (int sample = 0; sample < options_.samples; ++sample) {
            const glm::dvec2 in_pixel = pattern(sample);
            const Surface s = options_.samples == 1 ? centre : scene_.trace({i + in_pixel.x, j + in_pixel.y});
            ++seen[static_cast<std::size_t>(s.object)];
            for (std::size_t c = 0; c < specs_.size(); ++c) {
                if (!specs_[c].centre_only) sums[c] += specs_[c].value(s);
            }
            for (int path = 0; path < paths; ++path) {
                beauty += scene_.radiance(s, {options_.seed, pixel, static_cast<std::uint32_t>(sample * paths + path)});
            }
            if (options_.opaque && s.object == 0) beauty += scene_.background(s.direction) * double(paths);
        }

        std::size_t c = 0;
        for (; c < specs_.size(); ++c) {
            store(c, at, specs_[c].centre_only ? specs_[c].value(centre) : sums[c] / options_.samples);
        }
        const double coverage = 1 - double(seen[0]) / options_.samples;
        if (has_beauty()) {
            for (int component = 0; component < 3; ++component) {
                store(c++, at, beauty[component] / (double(options_.samples) * paths));
            }
            store(c++, at, options_.opaque ? 1 : coverage);
        }
        store_mattes(c, at, seen);
    }

    void store_mattes(std::size_t c, std::size_t at, const std::array<int, 64>& seen) {
        std::array<std::size_t, 64> order{};
        const std::size_t objects = ids_.size();
        std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(objects), std::size_t{1});
        constexpr std::size_t ranks = 2 * kMatteLayers;
        std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(objects),
                         [&](std::size_t a, std::size_t b) { return seen[a] > seen[b]; });
        for (std::size_t rank = 0; rank < std::min(ranks, objects); ++rank) {
            const int count = seen[order[rank]];
            if (count == 0) return;
            image_.channels[c + 2 * rank].pixels[at] = std::bit_cast<float>(ids_[order[rank] - 1]);
            store(c + 2 * rank + 1, at, double(count) / options_.samples);
        }
    }

    void store(std::size_t channel, std::size_t at, double value) {
        image_.channels[channel].pixels[at] = static_cast<float>(value);
    }

    const Scene& scene_;
    const SceneOptions& options_;
    std::span<const ChannelSpec> specs_;
    std::vector<std::uint32_t> ids_;
    SceneImage image_;
};

}  // namespace

SceneImage render(const Scene& scene, const SceneOptions& options) { return Renderer(scene, options).run(); }

}  // namespace relume::scene
