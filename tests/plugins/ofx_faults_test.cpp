// SPDX-License-Identifier: Apache-2.0
// Hosts that lack something, hosts that want to stop, and that the node survives all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "ofx_scene.h"
#include "relume/scenes.h"
#include "threads/workers.h"

namespace relume::ofx::test {
namespace {

using Clock = std::chrono::steady_clock;

const SceneClips& scene() {
    static const SceneClips made(60, 40);
    return made;
}

OfxStatus render_scene_clips(Node& node, std::unique_ptr<Image>& image) {
    scene().connect(node);
    light_one(node);
    return node.render({.window = scene().bounds}, image);
}

TEST(OfxFaultsTest, WithoutASuiteThatItNeedsItDoesNotLoad) {
    for (const char* suite : {"OfxPropertySuite", "OfxImageEffectSuite", "OfxParameterSuite"}) {
        Host host({.missing_suites = {suite}});
        Node node(host, "");
        EXPECT_EQ(node.loaded(), kErrMissingHostFeature) << suite;
    }
    Host host({.null_members = {"clipGetImage"}});
    Node node(host, "");
    EXPECT_EQ(node.loaded(), kErrMissingHostFeature);
}

TEST(OfxFaultsTest, WithoutAHostNothingHappens) {
    const Binary binary;
    binary.plugin()->setHost(nullptr);
    EXPECT_EQ(binary.plugin()->mainEntry(name::kActionLoad, nullptr, nullptr, nullptr), kErrMissingHostFeature);
    EXPECT_NE(binary.plugin()->mainEntry(name::kActionDescribe, nullptr, nullptr, nullptr), kOk);
    EXPECT_NE(binary.plugin()->mainEntry(nullptr, nullptr, nullptr, nullptr), kOk);
    OfxHost empty{};
    binary.plugin()->setHost(&empty);
    EXPECT_EQ(binary.plugin()->mainEntry(name::kActionLoad, nullptr, nullptr, nullptr), kErrMissingHostFeature);
}

TEST(OfxFaultsTest, UnknownActionsAreTheHosts) {
    Host host;
    Node node(host, name::kContextGeneral);
    for (const char* action : {"OfxActionBeginInstanceChanged", "OfxActionSyncPrivateData", "NoSuchAction",
                               "OfxImageEffectActionIsIdentity", "OfxImageEffectActionBeginSequenceRender"})
        EXPECT_EQ(node.act(action, &node.instance()), kReplyDefault) << action;
    EXPECT_EQ(node.act(name::kActionPurgeCaches, &node.instance()), kOk);
}

TEST(OfxFaultsTest, MembersThatAreNull) {
    const std::vector<float> wanted = scene().relit(rig_one(), kAllClips);
    for (const char* member :
         {"abort", "clipGetPropertySet", "clipGetRegionOfDefinition", "paramGetValueAtTime", "paramSetValue",
          "paramGetPropertySet", "message", "setPersistentMessage", "clearPersistentMessage"}) {
        Host host({.null_members = {member}});
        Node node(host, name::kContextGeneral);
        std::unique_ptr<Image> image;
        ASSERT_EQ(render_scene_clips(node, image), kOk) << member;
        EXPECT_EQ(pixels(*image), wanted) << member;
        node.clip("Normal").has_image = false;
        EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed) << member;
        EXPECT_EQ(complaints(host), "") << member;
    }
}

TEST(OfxFaultsTest, MessagesByWhateverSuiteThereIs) {
    std::unique_ptr<Image> image;
    {
        Host host({.missing_suites = {"OfxMessageSuite"}});
        Node node(host, name::kContextGeneral);
        EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    }
    {
        Host host({.missing_suites = {"OfxMessageSuite 2"}});
        Node node(host, name::kContextGeneral);
        EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
        ASSERT_EQ(host.dialogs.size(), 1u);
        EXPECT_NE(host.dialogs[0].find("Normal"), std::string::npos);
    }
    {
        // Resolve's second version must not be called.
        Host host({.name = "DaVinciResolveLite"});
        Node node(host, name::kContextGeneral);
        EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
        EXPECT_EQ(host.dialogs.size(), 1u);
        EXPECT_EQ(node.instance().message, "");
    }
}

TEST(OfxFaultsTest, PropertiesThatAreUnknown) {
    const std::vector<float> wanted = scene().relit(rig_one(), kAllClips);
    for (const char* property : {name::kPropDescription,    name::kPropHostFrameThreading,
                                 name::kPropFilePathExists, name::kPropDoubleType,
                                 name::kPropGroupOpen,      name::kPropPageChild,
                                 name::kPropConnected,      name::kPropPremultiplication,
                                 name::kPropImageAspect,    name::kPropRenderScale,
                                 name::kPropProjectSize,    name::kPropProjectOffset,
                                 name::kPropProjectAspect,  name::kPropMin,
                                 name::kPropDisplayMax,     name::kPropSecret,
                                 name::kPropName,           name::kPropEvaluateOnChange,
                                 name::kPropAnimates,       name::kPropFrameVarying}) {
        Host host({.unknown_properties = {property}, .complain = false});
        Node node(host, name::kContextGeneral);
        std::unique_ptr<Image> image;
        ASSERT_EQ(render_scene_clips(node, image), kOk) << property << ": " << node.instance().message;
        EXPECT_EQ(pixels(*image), wanted) << property;
        EXPECT_EQ(node.changed("light1_type"), kOk) << property;
    }
    // Without these there is no picture, and nobody falls over.
    for (const char* property :
         {name::kPropData, name::kPropBounds, name::kPropPixelDepth, name::kPropComponents, name::kPropRenderWindow}) {
        Host host({.unknown_properties = {property}, .complain = false});
        Node node(host, name::kContextGeneral);
        std::unique_ptr<Image> image;
        EXPECT_EQ(render_scene_clips(node, image), kFailed) << property;
        EXPECT_NE(node.instance().message, "") << property;
    }
}

TEST(OfxFaultsTest, ImagesOfFormatsThatNobodyHasSeen) {
    Host host;
    Node node(host, name::kContextGeneral);
    scene().connect(node);
    light_one(node);
    std::unique_ptr<Image> image;
    node.clip("BaseColor").components = "OfxImageComponentCMYK";
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("CMYK"), std::string::npos);
    node.clip("BaseColor").components = name::kAlpha;
    EXPECT_EQ(node.render({.window = scene().bounds}, image), kFailed);
    EXPECT_NE(node.instance().message.find("BaseColor"), std::string::npos) << node.instance().message;
    node.clip("BaseColor").components = name::kRgb;
    node.clip("Roughness").components = name::kAlpha;  // one number is all that it needs
    ASSERT_EQ(node.render({.window = scene().bounds}, image), kOk) << node.instance().message;
    EXPECT_EQ(pixels(*image), scene().relit(rig_one(), kAllClips));
    EXPECT_EQ(complaints(host), "");
}

TEST(OfxFaultsTest, RenderWithoutCreateInstance) {
    Host host;
    Node node(host, name::kContextGeneral);
    node.act(name::kActionDestroyInstance, &node.instance());
    std::unique_ptr<Image> image;
    EXPECT_EQ(render_scene_clips(node, image), kOk);
    EXPECT_EQ(pixels(*image), scene().relit(rig_one(), kAllClips));
}

// ---- stopping

/// How many times as long as alone this machine takes at the moment, for what keeps all threads busy.
double slowdown() {
    constexpr double kMilliseconds = 10;
    const auto work = [] {
        const auto used = [] {
            timespec now{};
            clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
            return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
        };
        for (const double start = used(); used() - start < kMilliseconds;) {
        }
    };
    const auto start = Clock::now();
    {
        std::vector<std::jthread> others;
        for (int k = 1; k < default_threads(); ++k) others.emplace_back(work);
        work();
    }
    return std::max(1.0, std::chrono::duration<double, std::milli>(Clock::now() - start).count() / kMilliseconds);
}

/// Renders, and tells the node to stop `delay` after it first asked; the milliseconds until it has, of a machine that
/// has nothing else to do.
double time_to_stop(Node& node, const RenderJob& job, std::chrono::milliseconds delay, OfxStatus& status) {
    const auto never = Clock::time_point::max();
    std::atomic<Clock::time_point> stop{never};
    node.instance().abort = [&] {
        if (stop.load() == never) stop = Clock::now() + delay;
        return Clock::now() >= stop.load();
    };
    std::unique_ptr<Image> image;
    const double before = slowdown();
    status = node.render(job, image);
    const auto end = Clock::now();
    node.instance().abort = nullptr;
    if (stop.load() == never) return 1e9;
    return std::chrono::duration<double, std::milli>(end - stop.load()).count() / std::max(before, slowdown());
}

// Everything is some fifty times as slow under a sanitizer: there it is about how a render ends, not about when.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int kLightCount = 20, kRepeat = 4;
constexpr double kSoon = 5000;
#else
constexpr int kLightCount = 1000, kRepeat = 16;
constexpr double kSoon = 50;  // milliseconds
#endif

/// What else the machine does comes and goes.
constexpr int kAttempts = 4;

/// So many lights that a frame takes more than a second.
class ManyLights {
public:
    explicit ManyLights(int count = kLightCount)
        : path_(std::filesystem::temp_directory_path() / ("relume_many_" + std::to_string(getpid()) + ".relume")) {
        std::ofstream file(path_);
        for (int k = 0; k < count; ++k)
            file << "[[light]]\ntype = \"spot\"\nposition = [" << 0.01 * k - 5
                 << ", 3, 1]\ndirection = [0.1, -1, -0.2]\ncone_angle = 120\nintensity = 0.01\n";
    }
    ~ManyLights() { std::filesystem::remove(path_); }
    std::string file() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

TEST(OfxFaultsTest, StopsWithin50Milliseconds) {
    Host host;
    Node node(host, name::kContextGeneral);
    const SceneClips small(64, 48);
    // The scene's pixels, again and again: a frame that takes its time.
    const OfxRectI large{0, 0, 64 * kRepeat, 48 * kRepeat};
    for (const char* clip : kAllClips) {
        const Picture tile = small.picture(clip);
        const auto whole =
            std::make_shared<const Picture>(large, [&](int x, int y, int c) { return tile.at(x % 64, y % 48, c); });
        node.connect(clip, [whole](double) { return *whole; });
    }
    // With fewer lights the node asks the host between bands, with many from beside the work.
    for (const int count : {kLightCount / 5, kLightCount}) {
        const ManyLights lights(count);
        node.set("rig", lights.file());
        for (const int delay : {0, 10, 40, 150}) {
            if (delay > 40 && count < kLightCount) continue;  // it would be over
            double best = 1e9;
            for (int attempt = 0; attempt < kAttempts && best > kSoon; ++attempt) {
                OfxStatus status = kFailed;
                best = std::min(best, time_to_stop(node, {.window = large}, std::chrono::milliseconds(delay), status));
                EXPECT_EQ(status, kOk);
            }
            EXPECT_LT(best, kSoon) << count << " lights, stopped " << delay << " ms after the start";
            EXPECT_EQ(node.instance().message, "");
        }
    }
    EXPECT_EQ(complaints(host), "");
}

TEST(OfxFaultsTest, StopsWithin50MillisecondsOfAFile) {
    const SceneFile file(1600, 1000);
    Host host;
    {
        Node node(host, name::kContextGenerator);
        node.set("gbuffer_file", file.path().string());
        const ManyLights lights;
        node.set("rig", lights.file());
        for (const int delay : {0, 10, 40, 150}) {
            double best = 1e9;
            for (int attempt = 0; attempt < kAttempts && best > kSoon; ++attempt) {
                OfxStatus status = kFailed;
                node.act(name::kActionPurgeCaches, &node.instance());
                best = std::min(
                    best, time_to_stop(node, {.window = {0, 0, 1600, 1000}}, std::chrono::milliseconds(delay), status));
            }
            EXPECT_LT(best, kSoon) << "stopped " << delay << " ms after the start";
        }
        // Stopped is not failed: the next render has its picture.
        node.set("rig", "outdoor");
        std::unique_ptr<Image> image;
        EXPECT_EQ(node.render({.window = {0, 0, 64, 64}}, image), kOk) << node.instance().message;
    }
    EXPECT_EQ(complaints(host), "");
}

TEST(OfxFaultsTest, UnloadsWhileAStoppedRelightStillRuns) {
    const SceneFile file(1600, 1000);
    Host host;
    for (int k = 0; k < 3; ++k) {
        Node node(host, name::kContextGenerator);
        node.set("gbuffer_file", file.path().string());
        const ManyLights lights;
        node.set("rig", lights.file());
        OfxStatus status = kFailed;
        time_to_stop(node, {.window = {0, 0, 1600, 1000}}, std::chrono::milliseconds(1), status);
    }
    EXPECT_EQ(complaints(host), "");
}

}  // namespace
}  // namespace relume::ofx::test
