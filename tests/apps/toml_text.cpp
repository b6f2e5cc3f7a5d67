// Texts that are refused before toml++ gets them. This file compiles toml++ with assertions, and with a trap
// in place of undefined behaviour (CMakeLists.txt). Without words::toml_fault these texts reach both.

#undef NDEBUG
#define TOML_HEADER_ONLY 1

#include <cassert>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include <knurl/words/toml.hpp>

#include "../refusal.hpp"

namespace knurl::words {
namespace {

using namespace std::string_view_literals;

std::string refusal(std::string_view text) {
    return test::refusal_of([&] { parse_toml(text, "f.toml"); });
}

TEST(TomlText, WhatTomlPlusPlusDoesNotBearIsRefusedInOneLine) {
    const struct {
        std::string_view text, expected;
    } cases[] = {
        {"[[\0a]]\n"sv, "f.toml:1:3: the control character U+0000 may not stand in TOML; "},
        {"[\0a]\n"sv, "f.toml:1:2: the control character U+0000 "},
        {"[[\x01", "f.toml:1:3: the control character U+0001 "},
        {"a = 1\n# \0\n"sv, "f.toml:2:3: the control character U+0000 "},
        {"a = \"\0\""sv, "f.toml:1:6: the control character U+0000 "},
        {"a\x7f = 1", "f.toml:1:2: the control character U+007F "},
        {"[=]", "f.toml:1:2: '=' stands where the name of a table should begin; write [name] or [[name]]"},
        {"[[ .a]]", "f.toml:1:4: '.' stands where the name "},
        {"[[\n", "f.toml:1:3: the line ends where the name "},
        {"[\r\n", "f.toml:1:2: the line ends where the name "},
        {"a = [[1],\n[2]]\n\t[ +a]", "f.toml:3:4: '+' stands where the name "},
        {"[\x7f", "f.toml:1:2: the control character U+007F "},
        {"a = [}", "f.toml:1:6: '}' stands in an array, which ] closes; write ]"},
        {"a = [1, [2], # {\n}", "f.toml:2:1: '}' stands in an array"},
        {"a = { b = [1, {c = ']'}] ]", "f.toml:1:26: ']' stands in an inline table, which } closes; write }"},
        {"a = [0ff:!\"\uFFBE\n", "f.toml:1:11: \" stands within a word; put all of the word in quotes"},
        {"a = 1.'é'", "f.toml:1:7: ' stands within a word"},
        {"a = [1.'é'", "f.toml:1:8: ' stands within a word"},
        {"a = {b = 1.'é'", "f.toml:1:12: ' stands within a word"},
        {"a = [0ff:[\"\uFFB7\n", "f.toml:1:10: [ stands within a word"},
        {"a = 1{é", "f.toml:1:6: { stands within a word"},
        {"a = 1978-05-27T$7:32:00z",
         "f.toml:1:16: a time should begin here, behind its date; write 07:32:00"},
        {"é = 1\n",
         "f.toml:1:1: the character U+00E9 stands outside quotes and comments, where only ASCII may; "
         "put the word in quotes (' or \")"},
        {"aé = 1\n", "f.toml:1:2: the character U+00E9 "},
        {"[[é]]\n", "f.toml:1:3: the character U+00E9 "},
        {"a = \"ü\" # ß\nb.é = 1\n", "f.toml:2:3: the character U+00E9 "},
        {"a = {é = 1}\n", "f.toml:1:6: the character U+00E9 "},
        {"a = 1é", "f.toml:1:6: the character U+00E9 "},
        {"a = é", "f.toml:1:5: the character U+00E9 "},
        {"a = “b”", "f.toml:1:5: the character U+201C "},
        {"'é' = '\\'\n𝄞 = 1", "f.toml:2:1: the character U+1D11E "},
        {"a = '''\n\\'''''\né", "f.toml:3:1: the character U+00E9 "},
        {"a = \"\xE9\"", "f.toml:1:6: the byte 0xE9 here is no UTF-8; save the file as UTF-8"},
        {"\xFF", "f.toml:1:1: the byte 0xFF "},
        {"# \xC0\x80", "f.toml:1:3: the byte 0xC0 "},
        {"# \xED\xA0\x80", "f.toml:1:3: the byte 0xED "},
        {"# \xF4\x90\x80\x80", "f.toml:1:3: the byte 0xF4 "},
        {"# \xE2\x82", "f.toml:1:3: the byte 0xE2 "},
    };
    for (const auto& [text, expected] : cases) {
        const std::string said = refusal(text);
        EXPECT_EQ(said.substr(0, expected.size()), expected) << said;
        EXPECT_EQ(printable(said), said) << "one line of text";
    }
}

/// toml++ reports all other mistakes, in one line, whatever the file's content.
TEST(TomlText, WhatTomlPlusPlusRefusesIsOneLine) {
    for (const std::string_view text :
         {"[]"sv, "[[]]"sv, "[ [a]]"sv, "[a"sv, "a = = 3"sv, "a"sv, "a = \"b\nc = 1"sv,
          "\"\xC2\x9B\" = 1\n\"\xC2\x9B\" = 2"sv, "['\xC2\x9B']\n['\xC2\x9B']"sv, "a = \"\"\"\\"sv,
          "a = '''"sv, "a = [[[1]]"sv}) {
        const std::string said = refusal(text);
        EXPECT_TRUE(said.starts_with("f.toml:")) << said;
        EXPECT_EQ(printable(said), said);
    }
    EXPECT_LT(refusal("a = \"" + std::string(10'000, 'x') + "\n").size(), 400u);
    EXPECT_LT(refusal(std::string(10'000, 'x')).size(), 400u);
}

TEST(TomlText, ValidTomlIsRead) {
    constexpr std::string_view text =
        "\xEF\xBB\xBF# é, “quotes” and [[\r\n"
        "\"é\" = 'ü' # ß\n"
        "lines = \"\"\"\n[[=]] \\\"\"\" é\\\n  \"\"\"\"\"\n"
        "raw = '''\n[=] \\'''''\n"
        "empty = ['', \"\", '''''', \"\"\"\"\"\"]\n"
        "deep = [\n  [1, 2], # [\n  [+1, -2], [\n    { 'ä' = \"]\" }, [{}]\n  ],\n]\n"
        "\t[ a . 'é' ]\r\n"
        "[[ \"c\" . b ]]\n"
        "[[1-2_x]]\n"
        "x.'é'.\"y\" = {'é' = 1.5, a.'ü' = [1e3, 'b'], c='d'}\n"
        "times = [1979-05-27, 1979-05-27 , 1979-05-27T07:32:00Z, 1979-05-27 07:32:00]\n"
        "day = 1979-05-27 # a day\n"
        "1979-05-27Tx = [{1979-05-27T- = 1}]\n"
        "\\u = 1\n";
    // The scan accepts all of it. Only toml++ finds that the last line is wrong.
    EXPECT_EQ(toml_fault(text), std::nullopt);
    const toml::table table = parse_toml(text.substr(0, text.rfind("\\u")), "f.toml");
    EXPECT_EQ(table["é"].value_or(""sv), "ü");
    EXPECT_EQ(table["lines"].value_or(""sv), "[[=]] \"\"\" é\"\"");
    EXPECT_EQ(table["raw"].value_or(""sv), "[=] \\''");
    EXPECT_TRUE(table["a"]["é"].is_table());
    EXPECT_TRUE(refusal(text).starts_with("f.toml:"));
    EXPECT_EQ(parse_toml("", "f.toml").size(), 0u);
    EXPECT_EQ(parse_toml("\xEF\xBB\xBF", "f.toml").size(), 0u);
}

}  // namespace
}  // namespace knurl::words
