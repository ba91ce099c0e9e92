// SPDX-License-Identifier: Apache-2.0
// What becomes of the file: whole under its name, or not there at all.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <random>
#include <thread>

#include "exr_test_image.h"
#include "io/ordered_chunks.h"
#include "io/output_file.h"
#include "relume/error.h"

namespace relume::io {
namespace {

Part small_part(int width = 40, int height = 70) {
    Part part;
    part.data_window = {0, 0, width, height};
    part.display_window = part.data_window;
    part.channels = {{"R", PixelType::float32}};
    return part;
}

int files_in(const std::filesystem::path& folder) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        static_cast<void>(entry);
        ++count;
    }
    return count;
}

template <typename Call> std::string message_of(ErrorKind kind, Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
}

// Files of this process may not grow beyond `bytes`: a full disk without one.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    rlimit before_{};
    void (*handler_)(int) = nullptr;
};

TEST(ExrOutput, NothingAppearsBeforeCommit) {
    const TemporaryFolder folder;
    write_bytes(folder / "out.exr", std::string("old"));
    {
        ExrWriter writer(folder / "out.exr", {{small_part()}}, {});
        auto planes = test_planes(small_part());
        writer.write(0, 0, 70, const_planes(planes));
        EXPECT_EQ(files_in(folder.path()), 2);
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            const std::string name = entry.path().filename();
            EXPECT_TRUE(name == "out.exr" || name.starts_with("." + std::to_string(::getpid()) + "-")) << name;
        }
        EXPECT_EQ(file_bytes(folder / "out.exr").size(), 3u);
    }  // never committed
    EXPECT_EQ(file_bytes(folder / "out.exr").size(), 3u);
    EXPECT_EQ(files_in(folder.path()), 1);
    write_test_image(folder / "out.exr", {{small_part()}});
    EXPECT_EQ(files_in(folder.path()), 1);
    EXPECT_NO_THROW(ExrReader(folder / "out.exr"));
}

TEST(ExrOutput, CommitWantsEveryRow) {
    const TemporaryFolder folder;
    ExrWriter writer(folder / "out.exr", {{small_part()}}, {});
    auto planes = test_planes(small_part());
    writer.write(0, 0, 32, const_planes(planes));
    writer.write(0, 64, 6, const_planes(planes, 64));
    const std::string message = message_of(ErrorKind::value, [&] { writer.commit(); });
    EXPECT_NE(message.find("rows from 32 on were never written"), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(folder / "out.exr"));
    EXPECT_NE(message_of(ErrorKind::value, [&] { writer.write(0, 0, 16, const_planes(planes)); }).find("written twice"),
              std::string::npos);
}

TEST(ExrOutput, CallsOutOfStepAreRefused) {
    const TemporaryFolder folder;
    ExrWriter writer(folder / "out.exr", {{small_part()}}, {});
    ASSERT_EQ(writer.rows_per_chunk(), 16);
    auto planes = test_planes(small_part());
    const auto good = const_planes(planes);
    for (const auto& [part, y, rows] : {std::tuple{0, 1, 16},
                                        {0, 0, 15},
                                        {0, -16, 16},
                                        {0, 64, 16},
                                        {1, 0, 16},
                                        {-1, 0, 16},
                                        {0, 0, 0},
                                        {0, 16, 2147483647}}) {
        message_of(ErrorKind::value, [&, part = part, y = y, rows = rows] { writer.write(part, y, rows, good); });
    }
    message_of(ErrorKind::value, [&] { writer.write(0, 0, 16, {}); });
    message_of(ErrorKind::value, [&] { writer.write(0, 0, 16, std::vector<ConstPlane>(1)); });
}

TEST(ExrOutput, HeadersThatNoFileMayHaveAreRefused) {
    const TemporaryFolder folder;
    const auto refused = [&](const std::function<void(Header&)>& spoil) {
        Header header{{small_part(), small_part()}};
        header.parts[0].name = "a";
        header.parts[1].name = "b";
        spoil(header);
        return message_of(ErrorKind::value, [&] { ExrWriter(folder / "out.exr", header, {}); });
    };
    refused([](Header& h) { h.parts.clear(); });
    refused([](Header& h) { h.parts[1].name = "a"; });
    refused([](Header& h) { h.parts[1].name.clear(); });
    refused([](Header& h) { h.parts[1].channels.clear(); });
    refused([](Header& h) { h.parts[0].channels.push_back(h.parts[0].channels[0]); });
    refused([](Header& h) { h.parts[0].channels[0].name.clear(); });
    refused([](Header& h) { h.parts[0].channels[0].name = std::string(300, 'x'); });
    refused([](Header& h) { h.parts[0].channels[0].x_sampling = 7; });
    refused([](Header& h) { h.parts[1].data_window.width = 41; });
    refused([](Header& h) { h.parts[1].pixel_aspect = 2; });
    refused([](Header& h) { h.parts[0].data_window.width = h.parts[1].data_window.width = 0; });
    refused([](Header& h) { h.parts[0].data_window.x = h.parts[1].data_window.x = 2147483600; });
    refused([](Header& h) { h.parts[0].attributes = {{"m", "m44f", std::vector<double>(15)}}; });
    refused([](Header& h) { h.parts[0].attributes = {{"s", "float", std::string("x")}}; });
    EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(ExrOutput, UnwritablePlaces) {
    const TemporaryFolder folder;
    const Header header{{small_part()}};
    EXPECT_NE(
        message_of(ErrorKind::file, [&] { ExrWriter(folder / "no/such/out.exr", header, {}); }).find("No such file"),
        std::string::npos);
    message_of(ErrorKind::file, [&] { ExrWriter(folder.path(), header, {}); });
    message_of(ErrorKind::file, [&] { ExrWriter("/dev/null", header, {}); });
    message_of(ErrorKind::file, [&] { ExrWriter("", header, {}); });
    write_bytes(folder / "file", std::string("x"));
    message_of(ErrorKind::file, [&] { ExrWriter(folder / "file/out.exr", header, {}); });
    if (::geteuid() != 0) {  // root may write anywhere
        std::filesystem::permissions(folder.path(),
                                     std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
        message_of(ErrorKind::file, [&] { ExrWriter(folder / "out.exr", header, {}); });
        std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
    }
}

TEST(ExrOutput, NamesAsLongAsTheyMayBe) {
    const TemporaryFolder folder;
    const std::string name = std::string(251, 'n') + ".exr";
    write_test_image(folder / name, {{small_part()}});
    EXPECT_NO_THROW(ExrReader(folder / name));
}

TEST(ExrOutput, FullDiskLeavesTheDestinationAlone) {
    const TemporaryFolder folder;
    write_bytes(folder / "out.exr", std::string("old"));
    const Part part = small_part(200, 400);
    for (const rlim_t limit : {rlim_t{10}, rlim_t{600}, rlim_t{20000}, rlim_t{100000}}) {
        const FileSizeLimit full(limit);
        auto planes = test_planes(part);
        const std::string message = message_of(ErrorKind::file, [&] {
            ExrWriter writer(folder / "out.exr", {{part}}, {.compression = Compression::none});
            writer.write(0, 0, part.data_window.height, const_planes(planes));
            writer.commit();
        });
        EXPECT_NE(message.find("out.exr: cannot write: File too large"), std::string::npos) << message;
        EXPECT_EQ(files_in(folder.path()), 1);
        EXPECT_EQ(file_bytes(folder / "out.exr").size(), 3u);
    }
}

TEST(ExrOutput, FullDiskReachesTheWritersAndTheCommit) {
    const TemporaryFolder folder;
    const Part part = small_part(300, 640);
    const FileSizeLimit full(200000);
    auto planes = test_planes(part);
    ExrWriter writer(folder / "out.exr", {{part}}, {.compression = Compression::none});
    const int last = part.data_window.height - 1;
    std::atomic<int> next{0};
    std::atomic<int> failed{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            try {
                for (int y = next++; y < last; y = next++) {
                    writer.write(0, y, 1, const_planes(planes, y));
                }
            } catch (const Error& error) {
                failed += error.kind() == ErrorKind::file;
            }
        });
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    // Whoever writes when the disk is full; the others may have queued all their rows by then, and learn of it at the
    // commit.
    EXPECT_GE(failed, 1);
    EXPECT_THROW(writer.write(0, last, 1, const_planes(planes, last)), Error);  // from then on everybody
    EXPECT_THROW(writer.commit(), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.exr"));
}

TEST(ExrOutput, PermissionsFollowTheUmaskAndLinksStayLinks) {
    const TemporaryFolder folder;
    const mode_t before = ::umask(027);
    write_test_image(folder / "real.exr", {{small_part()}});
    ::umask(before);
    struct stat status {};
    ASSERT_EQ(::stat((folder / "real.exr").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0640u);

    std::filesystem::create_directory(folder / "sub");
    std::filesystem::rename(folder / "real.exr", folder / "sub/real.exr");
    std::filesystem::create_symlink("sub/real.exr", folder / "link.exr");
    write_bytes(folder / "sub/real.exr", std::string("old"));
    write_test_image(folder / "link.exr", {{small_part()}});
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.exr"));
    EXPECT_NO_THROW(ExrReader(folder / "sub/real.exr"));
}

// One thread hands in everything backwards, through a queue that holds almost nothing.
TEST(OrderedChunks, AnyOrderFinishesWithinABoundedQueue) {
    const TemporaryFolder folder;
    constexpr std::size_t kCount = 200;
    constexpr std::size_t kSize = 100;
    for (const int order : {0, 1, 2}) {
        OutputFile file(folder / "chunks");
        OrderedChunks chunks(file, kCount, 8, 5 * kSize);
        std::vector<std::size_t> numbers(kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            numbers[i] = order == 1 ? kCount - 1 - i : i;
        }
        if (order == 2) {
            std::shuffle(numbers.begin(), numbers.end(), std::mt19937(7));
        }
        for (const std::size_t number : numbers) {
            const std::vector<std::byte> data(kSize, static_cast<std::byte>(number));
            EXPECT_TRUE(chunks.put(number, std::span(data).first(4), std::span(data).subspan(4)));
            EXPECT_FALSE(chunks.put(number, data, {}));
        }
        file.commit();
        const std::vector<char> bytes = file_bytes(folder / "chunks");
        ASSERT_EQ(bytes.size(), 8 + kCount * kSize);
        for (std::size_t i = 0; i < kCount; ++i) {
            ASSERT_NE(chunks.offsets()[i], 0u);
            EXPECT_EQ(bytes[chunks.offsets()[i]], static_cast<char>(i));
            EXPECT_EQ(bytes[chunks.offsets()[i] + kSize - 1], static_cast<char>(i));
            if (order == 0) {
                EXPECT_EQ(chunks.offsets()[i], 8 + i * kSize);
            }
        }
    }
}

}  // namespace
}  // namespace relume::io
