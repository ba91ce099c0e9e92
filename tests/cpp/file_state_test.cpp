// SPDX-License-Identifier: Apache-2.0
// The state of a file tells every change of it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "io/file_state.h"

namespace relume::io {
namespace {

namespace fs = std::filesystem;

class FileStateTest : public testing::Test {
protected:
    void SetUp() override { write("one"); }
    void TearDown() override {
        fs::remove(path);
        fs::remove(other);
    }
    void write(const std::string& text) const { std::ofstream(path) << text; }
    const fs::path path = fs::temp_directory_path() / ("relume_state_" + std::to_string(getpid()));
    const fs::path other = path.string() + "_other";
};

TEST_F(FileStateTest, StaysWhileTheFileDoes) {
    const FileState first = FileState::of(path);
    EXPECT_EQ(first.size, 3);
    EXPECT_EQ(FileState::of(path), first);
    EXPECT_EQ(FileState::of(path).key(), first.key());
}

TEST_F(FileStateTest, EveryChangeIsAnother) {
    std::set<std::string> keys{FileState::of(path).key()};
    std::size_t count = 1;
    const auto another = [&](const char* what) {
        keys.insert(FileState::of(path).key());
        EXPECT_EQ(keys.size(), ++count) << what;
    };
    write("three");
    another("size");
    write("seven");
    another("same size");
    // As a copy that keeps the time of what it copies.
    const fs::file_time_type time = fs::last_write_time(path);
    write("eight");
    fs::last_write_time(path, time);
    another("same size, time set back");
    fs::copy_file(path, other);
    fs::last_write_time(other, time);
    fs::rename(other, path);
    another("replaced by its like");
    fs::remove(path);
    another("gone");
    EXPECT_EQ(FileState::of(path).size, -1);
}

TEST_F(FileStateTest, AnotherNameIsAnotherKey) {
    fs::create_hard_link(path, other);
    EXPECT_NE(FileState::of(path).key(), FileState::of(other).key());
    EXPECT_FALSE(FileState::of(path) == FileState::of(other));
}

}  // namespace
}  // namespace relume::io
