// SPDX-License-Identifier: Apache-2.0
// What the OpenFX node costs over the core, for ./dev bench doors:
//     relume_ofx_bench RIG GBUFFER REPEATS
// The best wall seconds of each as JSON: the core (understanding, relight and one copy of the picture) and the node,
// with the G-buffer by float clips that lie in the host's memory (in one render and in tiles of 256 rows) and by its
// file. Core and node take turns. Nothing is remembered from one to the next, but for `file.again`: a knob was turned.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>

#include "ofx_node.h"
#include "relume/gbuffer.h"
#include "relume/relight.h"
#include "relume/rig.h"

namespace relume::ofx::test {
namespace {

constexpr int kTileRows = 256;

/// Clip, the channel in it, the components of that.
struct Content {
    const char* clip;
    const char* semantic;
    int components;
};
constexpr Content kContents[] = {{"Source", "beauty", 3},        {"Normal", "normal", 3},
                                 {"BaseColor", "base_color", 3}, {"Roughness", "roughness", 1},
                                 {"Metallic", "metallic", 1},    {"Position", "position", 3}};

/// Planes of an image's first components, row 0 at the top.
std::vector<Plane> planes_of(const Image& image, int components) {
    std::vector<Plane> planes;
    for (int c = 0; c < components; ++c)
        planes.push_back({image.at(image.bounds.x1, image.bounds.y2 - 1, c), PixelType::float32, 16, -image.row_bytes});
    return planes;
}

class Bench {
public:
    Bench(const std::string& rig_file, const std::string& file, int repeats)
        : file_(file), repeats_(repeats), rig_(Rig::load(rig_file)) {
        const GBuffer gbuffer = GBuffer::read(file, rig_.gbuffer);
        window_ = gbuffer.data_window();
        if (!(window_ == gbuffer.display_window()) || window_.x != 0 || window_.y != 0)
            throw std::runtime_error(file + ": the bench wants a whole frame");
        frame_ = {0, 0, window_.width, window_.height};
        for (const Content& content : kContents) load(gbuffer, content);
        for (Node* node : {&by_clips_, &by_file_}) {
            node->set_project(window_.width, window_.height);
            node->set("rig", rig_file);
        }
        by_file_.set("gbuffer_file", file);
        output_ = std::make_unique<Image>(&host_);
        output_->bounds = frame_;
        output_->allocate(0, false);
        size_ = std::size_t{4} * static_cast<std::size_t>(window_.width) * static_cast<std::size_t>(window_.height);
        picture_.resize(size_);
        copied_.resize(size_);
    }

    void run() {
        double core_memory = kNever, whole = kNever, tiles = kNever;
        double core_file = kNever, from_file = kNever, again = kNever;
        for (int k = 0; k <= repeats_; ++k) {
            const auto best = [k](double& of, double seconds) { of = k > 0 ? std::min(of, seconds) : of; };
            best(core_memory, core([&] { return understand_memory(); }));
            purge(by_clips_);
            best(whole, render(by_clips_, window_.height));
            check("clips");
            purge(by_clips_);
            best(tiles, render(by_clips_, kTileRows));
            check("tiles");
        }
        for (int k = 0; k <= repeats_; ++k) {
            const auto best = [k](double& of, double seconds) { of = k > 0 ? std::min(of, seconds) : of; };
            best(core_file, core([&] { return GBuffer::read(file_, rig_.gbuffer); }));
            purge(by_file_);
            best(from_file, render(by_file_, window_.height));
            check("file");
            if (k == 0) continue;
            // Twice more, so that the pixels are kept.
            for (int turn = 0; turn < 2; ++turn) {
                by_file_.set("overrides", "light.l0.exposure = " + std::to_string(0.001 * (2 * k + turn)));
                again = turn > 0 ? std::min(again, render(by_file_, window_.height))
                                 : (render(by_file_, window_.height), again);
            }
            by_file_.set("overrides", "");
        }
        for (const std::string& complaint : host_.complaints()) throw std::runtime_error(complaint);
        std::printf("{\"clips\": {\"core\": %.6f, \"frame\": %.6f, \"tiles\": %.6f}, ", core_memory, whole, tiles);
        std::printf("\"file\": {\"core\": %.6f, \"frame\": %.6f, \"again\": %.6f}}\n", core_file, from_file, again);
    }

private:
    static constexpr double kNever = std::numeric_limits<double>::infinity();

    template <class Work> static double seconds(Work&& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    /// A clip that holds the channel, one number in all of R, G and B, alpha 1.
    void load(const GBuffer& gbuffer, const Content& content) {
        Clip& clip = by_clips_.clip(content.clip);
        auto image = std::make_unique<Image>(&host_);
        image->bounds = frame_;
        image->allocate(0, false);
        ChannelRequest request;
        request.name = content.semantic;
        request.components = content.components;
        read_channels(gbuffer, {&request, 1}, planes_of(*image, content.components));
        for (int y = 0; y < frame_.y2; ++y)
            for (int x = 0; x < frame_.x2; ++x) {
                for (int c = content.components; c < 3; ++c) image->put(x, y, c, image->number(x, y, 0));
                image->put(x, y, 3, 1);
            }
        clip.connected = true;
        clip.properties.set<int>(name::kPropConnected, 0, 1);
        clip.region_of_definition = OfxRectD{0, 0, 1.0 * frame_.x2, 1.0 * frame_.y2};
        clip.lasting = std::move(image);
    }

    GBuffer understand_memory() {
        std::map<std::string, MemoryChannel> channels;
        for (const Content& content : kContents)
            for (const Plane& plane :
                 planes_of(*by_clips_.clip(content.clip).lasting,
                           std::string_view("beauty") == content.semantic ? 4 : content.components))
                channels[content.semantic].planes.push_back(plane);
        return GBuffer::from_memory({window_, window_}, channels, rig_.gbuffer);
    }

    template <class Understand> double core(Understand&& understand) {
        return seconds([&] {
            const GBuffer gbuffer = understand();
            std::vector<Plane> planes;
            for (std::size_t k = 0; k < 4; ++k)
                planes.push_back({reinterpret_cast<std::byte*>(picture_.data() + k), PixelType::float32, 16,
                                  std::ptrdiff_t{16} * window_.width});
            relight(gbuffer, rig_, {{"beauty", planes}});
            std::memcpy(copied_.data(), picture_.data(), size_ * sizeof(float));
        });
    }

    void purge(Node& node) { node.act(name::kActionPurgeCaches, &node.instance()); }

    double render(Node& node, int rows) {
        return seconds([&] {
            for (int y = 0; y < frame_.y2; y += rows) {
                const RenderJob job{.window = {0, y, frame_.x2, std::min(y + rows, frame_.y2)}};
                if (node.render_into(job, *output_) != kOk) throw std::runtime_error(node.instance().message);
            }
        });
    }

    /// That both made the same picture.
    void check(const char* what) {
        for (int y = 0; y < frame_.y2; ++y)
            if (std::memcmp(output_->at(0, frame_.y2 - 1 - y, 0),
                            copied_.data() + size_ / static_cast<std::size_t>(frame_.y2) * static_cast<std::size_t>(y),
                            static_cast<std::size_t>(16 * frame_.x2)) != 0)
                throw std::runtime_error(std::string(what) + ": the node's pixels are not the core's");
    }

    std::string file_;
    int repeats_;
    Rig rig_;
    Window window_;
    OfxRectI frame_{};
    Host host_;
    Node by_clips_{host_, name::kContextGeneral}, by_file_{host_, name::kContextGenerator};
    std::unique_ptr<Image> output_;
    std::vector<float> picture_, copied_;
    std::size_t size_ = 0;
};

}  // namespace
}  // namespace relume::ofx::test

int main(int count, char** words) {
    if (count != 4) {
        std::fprintf(stderr, "usage: relume_ofx_bench RIG GBUFFER REPEATS\n");
        return 2;
    }
    try {
        relume::ofx::test::Bench(words[1], words[2], std::stoi(words[3])).run();
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "relume_ofx_bench: %s\n", error.what());
        return 1;
    }
}
