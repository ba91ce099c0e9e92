// SPDX-License-Identifier: Apache-2.0
#include "file_frames.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <thread>

#include "../cache_budget.h"
#include "abortable.h"
#include "clip_gbuffer.h"
#include "gbuffer/release_buffers.h"
#include "relight_picture.h"
#include "relume/error.h"
#include "relume/relight.h"

namespace relume::ofx {

namespace {

constexpr std::size_t kMostUnderstood = 8;
/// A file that is being written while it is read is read again, not for ever.
constexpr int kTries = 3;

std::vector<io::FileState> states_of(const std::vector<io::FileState>& files) {
    std::vector<io::FileState> now;
    for (const io::FileState& file : files) now.push_back(io::FileState::of(file.path));
    return now;
}

/// The files that a rig and G-buffer are made of, as they are now.
std::vector<io::FileState> input_states(const std::filesystem::path& path, Rig rig) {
    rig.gbuffer_file = path.string();
    std::vector<io::FileState> states;
    for (const std::filesystem::path& file : rig.input_files()) states.push_back(io::FileState::of(file));
    return states;
}

/// Understood files, the latest first. They hold no pixels, but an open file each.
struct Understood {
    struct Entry {
        std::filesystem::path path;
        GBufferOptions options;
        std::shared_ptr<const FileGBuffer> file;
        int relights = 0;
        bool kept = false;  ///< with its pixels
    };
    std::mutex mutex;
    std::list<Entry> entries;
};
Understood& understood() {
    static Understood all;
    return all;
}

/// A relight that runs or has ended.
struct Job {
    std::string key;
    std::shared_ptr<const FileFrame> frame;
    std::exception_ptr failure;
    std::atomic<bool> cancel{false};
    bool done = false;
    int waiting = 0;
    std::size_t bytes = 0;
};

struct Frames {
    std::mutex mutex;
    std::condition_variable ended;
    std::list<std::shared_ptr<Job>> jobs;  ///< the latest first; the failed and cancelled are taken out
    /// Threads are joined, never detached: the bundle may be unloaded as soon as they have ended.
    std::list<std::pair<std::shared_ptr<Job>, std::thread>> threads;
};
Frames& frames() {
    static Frames all;
    return all;
}

/// Everything that the pixels depend on.
std::string key_of(const std::filesystem::path& path, const NodeRig& node) {
    Rig rig = node.rig;
    if (!node.shader.use.empty()) rig.shaders.push_back(node.shader);
    std::string key;
    for (const io::FileState& state : input_states(path, rig)) key += state.key();
    return key + node.picture + (node.override_channels ? "\n!\n" : "\n?\n") + rig.to_toml();
}

std::shared_ptr<const FileFrame> relight_understood(const GBuffer& gbuffer, const NodeRig& node,
                                                    const std::atomic<bool>& cancel) {
    auto frame = std::make_shared<FileFrame>();
    frame->data_window = gbuffer.data_window();
    frame->display_window = gbuffer.display_window();
    frame->aspect = static_cast<double>(gbuffer.pixel_aspect());
    const auto width = static_cast<std::size_t>(frame->data_window.width);
    frame->size = 4 * width * static_cast<std::size_t>(frame->data_window.height);
    // Not cleared: that would be one thread's work, and as long as the relight.
    frame->rgba = std::make_unique_for_overwrite<float[]>(frame->size);
    auto* data = reinterpret_cast<std::byte*>(frame->rgba.get());
    const auto y_stride = static_cast<std::ptrdiff_t>(16 * width);
    std::vector<Plane> planes;
    for (std::ptrdiff_t k = 0; k < 4; ++k) planes.push_back({data + 4 * k, PixelType::float32, 16, y_stride});
    relight_picture(gbuffer, complete_rig(node, gbuffer), node.picture, frame->data_window, planes, cancel);
    return frame;
}

std::shared_ptr<const FileFrame> relight_once(const std::filesystem::path& path, const NodeRig& node,
                                              const std::atomic<bool>& cancel) {
    for (int attempt = 1;; ++attempt) {
        std::vector<io::FileState> before = input_states(path, node.rig);
        std::shared_ptr<const FileFrame> frame;
        std::exception_ptr failure;
        try {
            const std::shared_ptr<const FileGBuffer> file = understand_file(path, node.rig.gbuffer, true);
            if (cancel) throw Error(ErrorKind::cancelled, "cancelled");
            before = file->files;
            frame = relight_understood(file->gbuffer, node, cancel);
        } catch (...) {
            failure = std::current_exception();
        }
        if (cancel) throw Error(ErrorKind::cancelled, "cancelled");
        // Whatever came of a file that has changed meanwhile, picture or error, is not to be trusted.
        if (states_of(before) == before) {
            if (failure) std::rethrow_exception(failure);
            return frame;
        }
        if (attempt == kTries)
            throw Error(ErrorKind::file,
                        path.string() + ": changes while it is being read; render again when it is written");
    }
}

void run(const std::shared_ptr<Job>& job, const std::filesystem::path& path, const NodeRig& node) {
    std::shared_ptr<const FileFrame> frame;
    std::exception_ptr failure;
    try {
        frame = relight_once(path, node, job->cancel);
    } catch (...) {
        failure = std::current_exception();
    }
    Frames& all = frames();
    const std::scoped_lock lock(all.mutex);
    job->frame = std::move(frame);
    job->failure = failure;
    job->done = true;
    if (failure) {
        all.jobs.remove(job);
    } else {
        job->bytes = job->frame->size * sizeof(float);
        std::size_t kept = 0;
        for (auto at = all.jobs.begin(); at != all.jobs.end();) {
            kept += (*at)->bytes;
            // The newest stays whatever its size: its other tiles are about to be asked for.
            if ((*at)->done && *at != job && kept > cache_budget()) {
                kept -= (*at)->bytes;
                at = all.jobs.erase(at);
            } else {
                ++at;
            }
        }
    }
    all.ended.notify_all();
}

/// Joins what has ended, or with `every` what still runs as well. Called without the lock.
void join_threads(bool every) {
    Frames& all = frames();
    std::list<std::pair<std::shared_ptr<Job>, std::thread>> ended;
    {
        const std::scoped_lock lock(all.mutex);
        for (auto at = all.threads.begin(); at != all.threads.end();) {
            const auto next = std::next(at);
            if (every || at->first->done) ended.splice(ended.end(), all.threads, at);
            at = next;
        }
    }
    for (auto& [job, thread] : ended) thread.join();
}

}  // namespace

std::string gbuffer_file(const Instance& instance, const NodeRig& node) {
    if (!node.gbuffer_file.empty()) return node.gbuffer_file;
    return has_normal_clip(instance) ? std::string() : node.rig.main_file().value_or("");
}

std::shared_ptr<const FileGBuffer> understand_file(const std::filesystem::path& path, const GBufferOptions& options,
                                                   bool relight) {
    Understood& all = understood();
    bool keep = false;
    {
        const std::scoped_lock lock(all.mutex);
        for (auto at = all.entries.begin(); at != all.entries.end(); ++at) {
            if (at->path != path || !(at->options == options)) continue;
            if (states_of(at->file->files) != at->file->files) {
                all.entries.erase(at);
                break;
            }
            all.entries.splice(all.entries.begin(), all.entries, at);
            keep = relight && ++at->relights == 2 && !at->kept;
            if (!keep) return at->file;
            break;
        }
    }
    // The state is from before the reading: what changes meanwhile shows.
    Rig inputs;
    inputs.gbuffer = options;
    std::vector<io::FileState> files = input_states(path, std::move(inputs));
    GBuffer gbuffer = GBuffer::read(path, options);
    if (keep) gbuffer.keep_channels(static_cast<std::int64_t>(cache_budget()));
    auto file = std::make_shared<const FileGBuffer>(FileGBuffer{std::move(gbuffer), std::move(files)});
    const std::scoped_lock lock(all.mutex);
    // One entry of a file, and one file with its pixels.
    all.entries.remove_if([&](const Understood::Entry& entry) {
        return (keep && entry.kept) || (entry.path == path && entry.options == options);
    });
    all.entries.push_front({path, options, file, keep ? 2 : relight ? 1 : 0, keep});
    if (all.entries.size() > kMostUnderstood) all.entries.pop_back();
    for (const Understood::Entry& entry : all.entries)
        if (entry.file != file) gbuffer::release_buffers(entry.file->gbuffer);
    return file;
}

std::shared_ptr<const FileFrame> relight_file(const Instance& instance, const std::filesystem::path& path,
                                              const NodeRig& node) {
    const std::string key = key_of(path, node);
    join_threads(false);
    Frames& all = frames();
    std::unique_lock lock(all.mutex);
    std::shared_ptr<Job> job;
    for (auto at = all.jobs.begin(); at != all.jobs.end(); ++at) {
        if ((*at)->key != key || (*at)->cancel) continue;
        job = *at;
        all.jobs.splice(all.jobs.begin(), all.jobs, at);
        break;
    }
    if (!job) {
        job = std::make_shared<Job>();
        job->key = key;
        // Whatever of this there is no memory for leaves nothing behind.
        all.jobs.push_front(job);
        try {
            all.threads.emplace_back(job, std::thread());
            try {
                all.threads.back().second = std::thread(run, job, path, node);
            } catch (...) {
                all.threads.pop_back();
                throw;
            }
        } catch (...) {
            all.jobs.pop_front();
            throw;
        }
    }
    ++job->waiting;
    bool stop = false;
    while (!job->done && !stop) {
        all.ended.wait_for(lock, std::chrono::milliseconds(kAskMilliseconds), [&] { return job->done; });
        lock.unlock();
        stop = aborted(instance.effect());
        lock.lock();
    }
    --job->waiting;
    if (!job->done) {
        if (job->waiting == 0) job->cancel = true;
        throw Error(ErrorKind::cancelled, "cancelled");
    }
    if (job->failure) std::rethrow_exception(job->failure);
    return job->frame;
}

void purge_frames() {
    {
        Frames& all = frames();
        const std::scoped_lock lock(all.mutex);
        all.jobs.remove_if([](const std::shared_ptr<Job>& job) { return job->done; });
    }
    Understood& files = understood();
    const std::scoped_lock lock(files.mutex);
    files.entries.clear();
}

void end_frames() {
    Frames& all = frames();
    {
        const std::scoped_lock lock(all.mutex);
        for (const std::shared_ptr<Job>& job : all.jobs) job->cancel = true;
    }
    join_threads(true);
    purge_frames();
}

}  // namespace relume::ofx
