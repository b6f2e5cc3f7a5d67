// A page of `knurl top` on terminals of any size.

#include <gtest/gtest.h>
#include <top_terminal.hpp>

namespace knurl::test {
namespace {

using cli::fitted;

TEST(TopTerminal, WhatFitsStaysAsItIs) {
    EXPECT_EQ(fitted("one  two\n    three   four\n", 80, 24), "one  two\n    three   four");
    EXPECT_EQ(fitted("exactly ten", 11, 1), "exactly ten");
    EXPECT_EQ(fitted("", 80, 24), "");
}

TEST(TopTerminal, LongLinesGoOnBetweenFields) {
    EXPECT_EQ(fitted("  a b  c d   e f\nnext\n", 10, 24), "  a b  c d\n      e f\nnext");
    EXPECT_EQ(fitted("ab  cd  ef  gh\n", 8, 24), "ab  cd\n    ef\n    gh");
}

TEST(TopTerminal, NoLineIsWiderThanTheTerminal) {
    const std::string text = "a field that is wide  and  some  that are not, or hardly\n";
    for (std::size_t columns = 1; columns < 60; ++columns) {
        std::istringstream lines(fitted(text, columns, 100));
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), columns) << line;
    }
}

TEST(TopTerminal, TheLastLineSaysHowManyFoundNoRoom) {
    EXPECT_EQ(fitted("1\n2\n3\n4\n", 80, 4), "1\n2\n3\n4");
    EXPECT_EQ(fitted("1\n2\n3\n4\n", 80, 3), "1\n2\n... and 2 lines more");
    EXPECT_EQ(fitted("1\n2\n3\n4\n", 6, 1), "... an");
}

}  // namespace
}  // namespace knurl::test
