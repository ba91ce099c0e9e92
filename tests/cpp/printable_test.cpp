// SPDX-License-Identifier: Apache-2.0
#include "text/printable.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "relume/error.h"

namespace relume {
namespace {

TEST(Printable, PrintableUtf8StaysAsItIs) {
    for (const std::string text : {"", "ViewLayer.Normal.X", "a\\n'\"~ ", "caf\u00e9 \u00a0", "\u6cd5\u7dda",
                                   "\U0001f9ca", "\ue000\U0010ffff"}) {
        EXPECT_EQ(printable(text), text);
        EXPECT_TRUE(is_utf8(text));
    }
}

TEST(Printable, ControlCharactersAndLineSeparatorsAreEscaped) {
    EXPECT_EQ(printable("a\nb\r\t"), "a\\nb\\x0d\\x09");
    EXPECT_EQ(printable(std::string_view("\0z", 2)), "\\x00z");
    EXPECT_EQ(printable("\x1b[31mred\x7f"), "\\x1b[31mred\\x7f");
    EXPECT_EQ(printable("\u0085\u009b1m"), "\\x85\\x9b1m");
    EXPECT_EQ(printable("a\u2028b\u2029"), "a\\u2028b\\u2029");
}

TEST(Printable, BytesThatAreNotUtf8AreLatin1) {
    EXPECT_EQ(printable("diffus\xe9.R"), "diffus\u00e9.R");
    EXPECT_EQ(printable("\xfc"
                        "ber \xc3\xbc"),
              "\u00fcber \u00fc");
    EXPECT_EQ(printable("\x9b"
                        "31m"),
              "\\x9b31m")
        << "C1 as a lone byte, which some terminals obey";
    EXPECT_EQ(printable("\xc0\xaf"), "\u00c0\u00af") << "an overlong '/'";
    EXPECT_EQ(printable("\xed\xa0\x80"), "\u00ed\u00a0\\x80") << "a surrogate";
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\u00f4\\x90\\x80\\x80") << "above U+10FFFF";
    EXPECT_EQ(printable("\xe2\x82"), "\u00e2\\x82") << "cut off";
    for (const char* text : {"\xe9", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82", "\x80"})
        EXPECT_FALSE(is_utf8(text));
}

TEST(Printable, AnythingBecomesUtf8WithoutControlCharactersAndStaysSo) {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> byte(0, 255), length(0, 12);
    for (int n = 0; n < 200000; ++n) {
        std::string text(static_cast<std::size_t>(length(random)), '\0');
        for (char& c : text) c = static_cast<char>(byte(random));
        const std::string once = printable(text);
        ASSERT_TRUE(is_utf8(once));
        for (const char c : once) ASSERT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
        ASSERT_EQ(printable(once), once);
    }
}

TEST(Printable, AnErrorIsOneLineWhateverItQuotes) {
    const Error error(ErrorKind::channel, "no layer 'a\nb\x1b[2J\xe9'");
    EXPECT_STREQ(error.what(), "no layer 'a\\nb\\x1b[2J\u00e9'");
}

}  // namespace
}  // namespace relume
