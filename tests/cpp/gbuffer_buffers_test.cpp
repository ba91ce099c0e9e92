// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "gbuffer/release_buffers.h"
#include "gbuffer_files.h"
#include "relume/scenes.h"

namespace relume::test {
namespace {

class GBufferBuffers : public testing::Test {
protected:
    void SetUp() override {
        path = std::filesystem::temp_directory_path() / ("relume_buffers_" + std::to_string(::getpid()) + ".exr");
        SceneOptions options;
        options.width = 160;
        options.height = 120;
        options.samples = 1;
        write_scene("sdf", path, options);
    }
    void TearDown() override { std::filesystem::remove(path); }

    static std::vector<float> normals(const GBuffer& gbuffer) {
        std::vector<float> out(std::size_t{160} * 120 * 3);
        std::vector<Plane> planes;
        for (std::size_t k = 0; k < 3; ++k)
            planes.push_back({reinterpret_cast<std::byte*>(out.data() + k), PixelType::float32, 12, 12 * 160});
        const ChannelRequest request = semantic("normal", 3);
        read_channels(gbuffer, {&request, 1}, planes, 2);
        return out;
    }

    std::filesystem::path path;
};

TEST_F(GBufferBuffers, AreGivenBackAndComeAgain) {
    const GBuffer gbuffer = GBuffer::read(path);
    const std::vector<float> wanted = normals(gbuffer);
    EXPECT_GT(gbuffer::release_buffers(gbuffer), 0);
    EXPECT_EQ(gbuffer::release_buffers(gbuffer), 0);
    EXPECT_EQ(normals(gbuffer), wanted);
    EXPECT_GT(gbuffer::release_buffers(gbuffer), 0);
}

TEST_F(GBufferBuffers, AreGivenBackWhileSomebodyReads) {
    const GBuffer gbuffer = GBuffer::read(path);
    const std::vector<float> wanted = normals(gbuffer);
    std::atomic<bool> reads{true};
    std::jthread other([&] {
        while (reads) gbuffer::release_buffers(gbuffer);
    });
    for (int k = 0; k < 50; ++k) EXPECT_EQ(normals(gbuffer), wanted);
    reads = false;
}

}  // namespace
}  // namespace relume::test
