// SPDX-License-Identifier: Apache-2.0
// Renders a rig and a G-buffer file through the bundle, as a host does, for tests outside of C++:
//     relume_ofx_render RIG GBUFFER OUT.raw [CONTEXT [TIME]]
// GBUFFER "-": the rig's own. CONTEXT: generator (as without), general or filter. OUT.raw: R, G, B, A as float32 of
// this machine, the top row first. Prints the bounds in pixels, y up, as JSON.
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>

#include "ofx_node.h"
#include "relume/error.h"
#include "relume/frames.h"
#include "relume/gbuffer.h"
#include "relume/rig.h"

namespace relume::ofx::test {
namespace {

const char* context_called(const std::string& name) {
    if (name == "generator") return name::kContextGenerator;
    if (name == "general") return name::kContextGeneral;
    if (name == "filter") return name::kContextFilter;
    throw std::runtime_error("there is no context '" + name + "'; there are generator, general and filter");
}

/// What the node defines, in pixels.
OfxRectI window_of(Node& node, double time, double aspect) {
    const auto region = node.region_of_definition(time);
    if (!region) return {0, 0, 1, 1};  // the render says what is wrong
    return {static_cast<int>(std::lround(region->x1 / aspect)), static_cast<int>(std::lround(region->y1)),
            static_cast<int>(std::lround(region->x2 / aspect)), static_cast<int>(std::lround(region->y2))};
}

/// Pixels of the project are those of the file, whatever their shape; nothing where there is no file, which the node
/// says.
double set_project(Node& node, const std::string& rig_file, const std::string& gbuffer_file, double time) {
    try {
        const auto frame = std::llround(time);
        const Rig rig = Rig::load(rig_file).of_frame(frame);
        const std::string file =
            gbuffer_file.empty() ? rig.main_file().value_or("") : resolve_frame(gbuffer_file, frame);
        const GBuffer gbuffer = GBuffer::read(file, rig.gbuffer);
        const auto aspect = static_cast<double>(gbuffer.pixel_aspect());
        const Window& display = gbuffer.display_window();
        node.set_project(display.width * aspect, display.height, 0, 0, aspect);
        node.clip(name::kClipOutput).properties.set<double>(name::kPropImageAspect, 0, aspect);
        return aspect;
    } catch (const Error&) {
        return 1;
    }
}

int render(int count, char** words) {
    if (count < 4 || count > 6) {
        std::fprintf(stderr, "usage: relume_ofx_render RIG GBUFFER OUT.raw [CONTEXT [TIME]]\n");
        return 2;
    }
    const std::string rig = words[1], gbuffer = words[2] == std::string("-") ? "" : words[2];
    const double time = count > 5 ? std::stod(words[5]) : 0;
    Host host;
    Node node(host, context_called(count > 4 ? words[4] : "generator"));
    if (count > 4 && words[4] == std::string("filter")) {
        const Picture black({0, 0, 16, 16}, [](int, int, int) { return 0.f; });
        node.connect("Source", black);
    }
    node.set("rig", rig);
    node.set("gbuffer_file", gbuffer);
    const double aspect = set_project(node, rig, gbuffer, time);
    const OfxRectI window = window_of(node, time, aspect);
    std::unique_ptr<Image> image;
    if (node.render({.time = time, .window = window}, image) != kOk)
        throw std::runtime_error(node.instance().message.empty() ? "the render failed" : node.instance().message);
    for (const std::string& complaint : host.complaints()) throw std::runtime_error(complaint);
    std::ofstream out(words[3], std::ios::binary);
    const auto row_bytes = static_cast<std::streamsize>(16) * (window.x2 - window.x1);
    for (int y = window.y2 - 1; y >= window.y1; --y)
        out.write(reinterpret_cast<const char*>(image->at(window.x1, y, 0)), row_bytes);
    out.close();
    if (!out) throw std::runtime_error(std::string(words[3]) + ": cannot be written");
    std::printf("{\"bounds\": [%d, %d, %d, %d], \"width\": %d, \"height\": %d}\n", window.x1, window.y1, window.x2,
                window.y2, window.x2 - window.x1, window.y2 - window.y1);
    return 0;
}

}  // namespace
}  // namespace relume::ofx::test

int main(int count, char** words) {
    try {
        return relume::ofx::test::render(count, words);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "relume_ofx_render: %s\n", error.what());
        return 1;
    }
}
