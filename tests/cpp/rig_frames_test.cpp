// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "relume/error.h"
#include "relume/frames.h"

namespace relume {
namespace {

using Frames = std::vector<std::int64_t>;

TEST(Frames, PlaceHoldersBecomeTheNumber) {
    EXPECT_EQ(resolve_frame("shot.####.exr", 7), "shot.0007.exr");
    EXPECT_EQ(resolve_frame("shot.####.exr", 123456), "shot.123456.exr");
    EXPECT_EQ(resolve_frame("shot.#.exr", 7), "shot.7.exr");
    EXPECT_EQ(resolve_frame("shot.%04d.exr", 7), "shot.0007.exr");
    EXPECT_EQ(resolve_frame("shot.%d.exr", 7), "shot.7.exr");
    EXPECT_EQ(resolve_frame("shot.{frame}.exr", 7), "shot.7.exr");
    EXPECT_EQ(resolve_frame("shot.{frame:05d}.exr", 7), "shot.00007.exr");
    EXPECT_EQ(resolve_frame("shot.{frame:05}.exr", 7), "shot.00007.exr");
    EXPECT_EQ(resolve_frame("####/shot.####.exr", 12), "0012/shot.0012.exr");
    EXPECT_EQ(resolve_frame("shot.exr", 12), "shot.exr");
    EXPECT_EQ(resolve_frame("", 12), "");
}

TEST(Frames, NegativeNumbersCountTheirSign) {
    char expected[16];
    for (const int frame : {-1, -12, -123, -1234, -12345, 0}) {
        std::snprintf(expected, sizeof expected, "%04d", frame);
        EXPECT_EQ(resolve_frame("####", frame), expected);
        EXPECT_EQ(resolve_frame("%04d", frame), expected);
    }
    EXPECT_EQ(resolve_frame("a{frame}", -5), "a-5");
    EXPECT_EQ(resolve_frame("#", INT64_MIN), "-9223372036854775808");
}

TEST(Frames, WhatIsNoPlaceHolderStays) {
    for (const char* name : {"a/shot#3/b.exr", "a%b.exr", "100%.exr", "%s.exr", "%04x.exr", "{frames}.exr",
                             "{frame:x}.exr", "{frame", "%", "%99999999999d", "{"}) {
        EXPECT_FALSE(is_pattern(name)) << name;
        EXPECT_EQ(resolve_frame(name, 5), name);
    }
    EXPECT_FALSE(is_pattern(std::string(100000, '#')));
    for (const char* name : {"a.#.exr", "####", "b/##/a.exr", "%d", "%4d", "{frame}", "{frame:4d}"})
        EXPECT_TRUE(is_pattern(name)) << name;
}

TEST(Frames, ListsOfFrames) {
    EXPECT_EQ(parse_frames("1001"), Frames{1001});
    EXPECT_EQ(parse_frames("1-3"), (Frames{1, 2, 3}));
    EXPECT_EQ(parse_frames("1001-1006x2,1200"), (Frames{1001, 1003, 1005, 1200}));
    EXPECT_EQ(parse_frames(" 3 , 1-4 "), (Frames{3, 1, 2, 4}));
    EXPECT_EQ(parse_frames("-3--1"), (Frames{-3, -2, -1}));
    EXPECT_EQ(parse_frames("-1-1"), (Frames{-1, 0, 1}));
    EXPECT_EQ(parse_frames("5-5x100"), Frames{5});
    EXPECT_EQ(parse_frames("9223372036854775806-9223372036854775807"), (Frames{INT64_MAX - 1, INT64_MAX}));
    EXPECT_EQ(parse_frames("1-1000000").size(), 1000000u);
}

TEST(Frames, MistakesAreNamed) {
    for (const char* text : {"",
                             ",",
                             "1,",
                             "a",
                             "1-",
                             "1-2x",
                             "1-2x0",
                             "1-2x-1",
                             "3-1",
                             "1..3",
                             "1-2y3",
                             "x2",
                             "1-2x2x2",
                             "1 2",
                             "99999999999999999999",
                             "1-10000000",
                             "-9223372036854775808-9223372036854775807",
                             "1-600000,600001-1200001",
                             "+1",
                             "1.5"}) {
        try {
            parse_frames(text);
            ADD_FAILURE() << "'" << text << "' was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::value) << text;
        }
    }
}

}  // namespace
}  // namespace relume
