// SPDX-License-Identifier: Apache-2.0
// Files that are damaged, cut short or made to do harm: an Error, soon and without much memory; never a crash.
#include <gtest/gtest.h>
#include <openexr.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <random>

#include "exr_test_image.h"
#include "relume/error.h"

namespace relume::io {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(RELUME_SOURCE_DIR) / "tests/data/exr";

// What OpenEXRCore allocates, which is where the size of a chunk or of a table ends up.
std::atomic<std::size_t> largest_allocation{0};

void* counting_malloc(std::size_t size) {
    std::size_t seen = largest_allocation;
    while (size > seen && !largest_allocation.compare_exchange_weak(seen, size)) {
    }
    return std::malloc(size);
}

class AllocationWatch {
public:
    AllocationWatch() {
        largest_allocation = 0;
        exr_set_default_memory_routines(counting_malloc, std::free);
    }
    ~AllocationWatch() { exr_set_default_memory_routines(nullptr, nullptr); }
};

enum class Outcome { read, refused };

// Opens a file and reads all it can of it, as a relight would: every channel, band by band.
Outcome try_file(const std::filesystem::path& path, std::string* message = nullptr) {
    ReadLimits limits;
    limits.max_pixels = 1 << 22;
    Outcome outcome = Outcome::read;
    try {
        const ExrReader reader(path, limits);
        for (std::size_t p = 0; p < reader.header().parts.size(); ++p) {
            const Part& part = reader.header().parts[p];
            const Window& window = part.data_window;
            try {
                for (int y = window.y; y < window.y_end(); y += part.rows_per_chunk) {
                    const int rows = std::min(part.rows_per_chunk, window.y_end() - y);
                    if (std::int64_t{rows} * window.width * static_cast<std::int64_t>(part.channels.size()) >
                        (1 << 22)) {
                        break;  // the test's own memory
                    }
                    read_planes(reader, static_cast<int>(p), {window.x, y, window.width, rows}, PixelType::float32);
                }
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::format) << error.what();
                outcome = Outcome::refused;
                if (message != nullptr) {
                    *message = error.what();
                }
            }
        }
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::format) << error.what();
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
        outcome = Outcome::refused;
        if (message != nullptr) {
            *message = error.what();
        }
    }
    return outcome;
}

std::vector<std::filesystem::path> good_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
        if (entry.path().extension() == ".exr" && entry.path().string().find(".decoded") == std::string::npos) {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

TEST(ExrDamage, CutShortAnywhere) {
    const TemporaryFolder folder;
    const AllocationWatch watch;
    for (const auto& path : good_files()) {
        SCOPED_TRACE(path.filename());
        const std::vector<char> bytes = file_bytes(path);
        for (std::size_t length = 0; length < bytes.size(); length += std::max<std::size_t>(1, length / 5)) {
            write_bytes(folder / "cut.exr", std::span(bytes).first(length));
            const Outcome outcome = try_file(folder / "cut.exr");
            // The smaller levels of a mipmap may be missing without harm.
            if (path.stem().string().find("map") == std::string::npos || length < 1000) {
                EXPECT_EQ(outcome, Outcome::refused) << length;
            }
        }
    }
    EXPECT_LT(largest_allocation, std::size_t{16} << 20);
}

TEST(ExrDamage, BytesFlippedAnywhere) {
    const TemporaryFolder folder;
    const AllocationWatch watch;
    std::mt19937 random(20240607);
    for (const auto& path : good_files()) {
        SCOPED_TRACE(path.filename());
        const std::vector<char> bytes = file_bytes(path);
        for (int round = 0; round < 40; ++round) {
            std::vector<char> damaged = bytes;
            // Most of the damage goes where it hurts: the header and the offset table.
            const std::size_t reach = round % 3 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), 700);
            for (int flips = 1 + round % 4; flips > 0; --flips) {
                const std::size_t at = random() % reach;
                constexpr char kValues[] = {'\0', '\xff', '\x7f', '\x80', '\1'};
                damaged[at] = round % 2 == 0 ? static_cast<char>(random()) : kValues[random() % std::size(kValues)];
            }
            write_bytes(folder / "flipped.exr", damaged);
            try_file(folder / "flipped.exr");
        }
    }
    EXPECT_LT(largest_allocation, std::size_t{100} << 20);
}

TEST(ExrDamage, TruncationNamesTheRows) {
    const TemporaryFolder folder;
    Part part;
    part.data_window = part.display_window = {0, 100, 64, 160};
    part.channels = {{"Z", PixelType::float32}};
    write_test_image(folder / "whole.exr", {{part}}, {.compression = Compression::none});
    const std::vector<char> bytes = file_bytes(folder / "whole.exr");
    constexpr std::size_t kChunk = 8 + 64 * 4;
    const std::size_t pixels = bytes.size() - 160 * kChunk;
    write_bytes(folder / "cut.exr", std::span(bytes).first(pixels + 90 * kChunk + 10));
    std::string message;
    EXPECT_EQ(try_file(folder / "cut.exr", &message), Outcome::refused);
    EXPECT_NE(message.find("truncated: rows 190..259 are missing"), std::string::npos) << message;
    const ExrReader reader(folder / "cut.exr");
    EXPECT_NO_THROW(read_planes(reader, 0, {0, 100, 64, 90}));  // what is there can be had

    // A renderer that was killed leaves an offset table of zeros behind the pixels that it wrote, or before none at
    // all.
    std::vector<char> killed = bytes;
    std::fill_n(killed.begin() + static_cast<std::ptrdiff_t>(pixels - 160 * 8), 160 * 8, '\0');
    killed.resize(pixels + 30 * kChunk);
    write_bytes(folder / "killed.exr", killed);
    EXPECT_EQ(try_file(folder / "killed.exr", &message), Outcome::refused);
    EXPECT_NE(message.find("truncated: rows 130..259 are missing"), std::string::npos) << message;
}

TEST(ExrDamage, OneBadChunkIsNamed) {
    const TemporaryFolder folder;
    Part part;
    part.data_window = part.display_window = {0, 0, 64, 64};
    part.channels = {{"Z", PixelType::float32}};
    write_test_image(folder / "whole.exr", {{part}});
    std::vector<char> bytes = file_bytes(folder / "whole.exr");
    for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 40; ++i) {
        bytes[i] = static_cast<char>(~bytes[i]);
    }
    write_bytes(folder / "bad.exr", bytes);
    std::string message;
    EXPECT_EQ(try_file(folder / "bad.exr", &message), Outcome::refused);
    EXPECT_NE(message.find("bad.exr: damaged at rows "), std::string::npos) << message;
}

TEST(ExrDamage, WrittenIntoWhileOpen) {
    const TemporaryFolder folder;
    const auto path = folder / "open.exr";
    const std::vector<char> bytes = file_bytes(kFolder / "scanline_zip.exr");
    write_bytes(path, bytes);
    const ExrReader reader(path);
    const Window window = reader.header().parts[0].data_window;
    const auto whole = [&] { return read_planes(reader, 0, window, PixelType::float32); };
    EXPECT_NO_THROW(whole());
    // Another file in its place: the open one is still what it was.
    write_bytes(folder / "other.exr", std::vector<char>(bytes.begin(), bytes.begin() + std::ssize(bytes) / 2));
    std::filesystem::rename(path, folder / "moved.exr");
    std::filesystem::rename(folder / "other.exr", path);
    EXPECT_NO_THROW(whole());
    const auto told = [&] {
        try {
            whole();
        } catch (const Error& error) {
            return error.kind() == ErrorKind::file ? std::string(error.what()) : "another kind";
        }
        return std::string();
    };
    // The same bytes at a later time, and a file that is cut while its chunks are still to be read.
    const auto open_one = folder / "moved.exr";
    std::filesystem::last_write_time(open_one, std::filesystem::last_write_time(open_one) + std::chrono::seconds(1));
    EXPECT_NE(told().find("open.exr: changed on disk"), std::string::npos) << told();
    std::filesystem::resize_file(open_one, bytes.size() / 2);
    EXPECT_NE(told().find("open.exr: changed on disk"), std::string::npos) << told();
}

TEST(ExrDamage, NotAnExr) {
    const TemporaryFolder folder;
    std::string message;
    write_bytes(folder / "empty.exr", std::string());
    EXPECT_EQ(try_file(folder / "empty.exr", &message), Outcome::refused);
    EXPECT_NE(message.find("is empty"), std::string::npos);
    write_bytes(folder / "text.exr", std::string("This is a text, not a picture."));
    EXPECT_EQ(try_file(folder / "text.exr", &message), Outcome::refused);
    EXPECT_NE(message.find("is not an EXR file"), std::string::npos);
    for (const std::string& path :
         {std::string("/no/such/file.exr"), folder.path().string(), std::string("/dev/null")}) {
        try {
            const ExrReader reader(path);
            FAIL() << path;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::file) << error.what();
        }
    }
}

// The header of a real small file, with other windows in it.
std::vector<char> with_data_window(std::vector<char> bytes, const std::array<std::int32_t, 4>& box) {
    static constexpr char kAttribute[] = "dataWindow\0box2i\0\x10\0\0";
    const auto at = std::search(bytes.begin(), bytes.end(), kAttribute, kAttribute + sizeof kAttribute);
    std::memcpy(&*at + sizeof kAttribute, box.data(), sizeof box);
    return bytes;
}

TEST(ExrDamage, SizesThatAreLies) {
    const TemporaryFolder folder;
    const AllocationWatch watch;
    Part part;
    part.data_window = part.display_window = {0, 0, 4, 4};
    part.channels = {{"Z", PixelType::float32}};
    for (int c = 0; c <= static_cast<int>(Compression::zstd); ++c) {
        const auto compression = static_cast<Compression>(c);
        if (!is_supported(compression)) {
            continue;
        }
        SCOPED_TRACE(name_of(compression));
        write_test_image(folder / "small.exr", {{part}}, {.compression = compression});
        const std::vector<char> bytes = file_bytes(folder / "small.exr");
        ASSERT_LT(bytes.size(), 1024u);
        const std::array<std::int32_t, 4> boxes[] = {
            {0, 0, 46339, 46339},  // 2^31 pixels
            {0, 0, 1 << 29, 0},    // in one row
            {0, 0, 0, 1 << 29},    // in one column
            {-2147483647 - 1, -2147483647 - 1, 2147483647, 2147483647},
            {5, 5, 4, 4},
            {0, 0, -1, -1},
            {2147483646, 2147483646, 2147483647, 2147483647},
            {0, 0, 30000, 30000},  // within the limit, not within the file
        };
        for (const auto& box : boxes) {
            write_bytes(folder / "lie.exr", with_data_window(bytes, box));
            const std::clock_t start = std::clock();  // of the CPU, since others may have the machine
            try {
                const ExrReader reader(folder / "lie.exr");
                const Window& window = reader.header().parts[0].data_window;
                std::vector<float> row(static_cast<std::size_t>(std::min(window.width, 100)));
                const ReadTarget target{0, 0, {reinterpret_cast<std::byte*>(row.data()), PixelType::float32, 4, 4}};
                reader.read({window.x, window.y, static_cast<int>(row.size()), 1}, {&target, 1});
                FAIL() << "a lie was believed: " << box[2] << " " << box[3];
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::format) << error.what();
            }
            EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC);
        }
    }
    EXPECT_LT(largest_allocation, std::size_t{100} << 20);
}

TEST(ExrDamage, LimitsAreOptions) {
    const TemporaryFolder folder;
    Header header;
    for (const char* name : {"a", "b", "c"}) {
        Part part;
        part.name = name;
        part.data_window = part.display_window = {0, 0, 100, 100};
        part.channels = {{"X", PixelType::half}, {"Y", PixelType::half}};
        header.parts.push_back(part);
    }
    write_test_image(folder / "parts.exr", header);
    EXPECT_NO_THROW(ExrReader(folder / "parts.exr", {.max_pixels = 10000, .max_channels = 6, .max_parts = 3}));
    EXPECT_THROW(ExrReader(folder / "parts.exr", {.max_pixels = 9999}), Error);
    EXPECT_THROW(ExrReader(folder / "parts.exr", {.max_channels = 5}), Error);
    EXPECT_THROW(ExrReader(folder / "parts.exr", {.max_parts = 2}), Error);
}

}  // namespace
}  // namespace relume::io
