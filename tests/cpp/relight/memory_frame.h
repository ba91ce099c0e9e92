// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "relume/gbuffer.h"
#include "relume/relight.h"
#include "relume/rig.h"

namespace relume::test {

/// A random G-buffer in memory with a camera at (0, 0, 5) that looks down −Z, and the pictures a relight makes of it.
struct MemoryFrame {
    int width, height;
    std::map<std::string, std::vector<std::vector<float>>> channels;

    MemoryFrame(int w, int h, unsigned seed = 1) : width(w), height(h) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> uniform(0.f, 1.f);
        for (const char* name : {"normal", "position", "base_color", "beauty", "emission"})
            channels[name].assign(3, std::vector<float>(pixels()));
        for (const char* name : {"roughness", "metallic", "specular"})
            channels[name].assign(1, std::vector<float>(pixels()));
        for (auto& [name, planes] : channels)
            for (auto& plane : planes)
                for (float& x : plane) x = uniform(random);
        for (std::size_t i = 0; i < pixels(); ++i) {
            const float x = uniform(random) * 2 - 1, y = uniform(random) * 2 - 1;
            const float length = std::sqrt(x * x + y * y + 1);
            channels["normal"][0][i] = x / length;
            channels["normal"][1][i] = y / length;
            channels["normal"][2][i] = 1 / length;
            channels["position"][0][i] = 4 * uniform(random) - 2;
            channels["position"][1][i] = 4 * uniform(random) - 2;
            channels["position"][2][i] = uniform(random);
            channels["roughness"][0][i] = 0.1f + 0.9f * channels["roughness"][0][i];
        }
    }

    std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

    static GBufferOptions camera() {
        GBufferOptions options;
        options.camera_matrix = std::array<double, 16>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5, 0, 0, 0, 1};
        options.fov = 60;
        return options;
    }

    /// A window of the frame; the whole of it by default.
    GBuffer gbuffer(int x = 0, int y = 0, int w = 0, int h = 0) const {
        std::map<std::string, MemoryChannel> memory;
        for (const auto& [name, planes] : channels) {
            MemoryChannel channel;
            for (const auto& plane : planes)
                channel.planes.push_back({reinterpret_cast<const std::byte*>(plane.data() + y * width + x),
                                          PixelType::float32, 4, static_cast<std::ptrdiff_t>(width) * 4});
            memory[name] = channel;
        }
        return GBuffer::from_memory(w > 0 ? w : width, h > 0 ? h : height, memory, camera());
    }
};

/// Pictures by AOV name: planes of floats.
struct Pictures {
    std::map<std::string, std::vector<std::vector<float>>> planes;
    RelightReport report;

    const std::vector<float>& operator()(const std::string& name, std::size_t component) const {
        return planes.at(name)[component];
    }
};

inline Pictures relit(const GBuffer& gbuffer, const Rig& rig, int threads = 1) {
    Pictures out;
    const auto width = static_cast<std::size_t>(gbuffer.data_window().width);
    const auto height = static_cast<std::size_t>(gbuffer.data_window().height);
    std::map<std::string, std::vector<Plane>> targets;
    for (const AovInfo& aov : aovs(rig)) {
        auto& planes = out.planes[aov.name];
        planes.assign(static_cast<std::size_t>(aov.components), std::vector<float>(width * height, -1.f));
        for (auto& plane : planes)
            targets[aov.name].push_back({reinterpret_cast<std::byte*>(plane.data()), PixelType::float32, 4,
                                         static_cast<std::ptrdiff_t>(width * 4)});
    }
    RelightOptions options;
    options.threads = threads;
    out.report = relight(gbuffer, rig, targets, options);
    return out;
}

}  // namespace relume::test
