// A page of `knurl top` on terminals of any size.

#include <csignal>
#include <string>

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <top_terminal.hpp>
#include <unistd.h>

#include "../rights.hpp"

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

TEST(TopTerminal, MarksTakeNoRoomAndAreLeftOutWithoutColours) {
    const std::string text = "ab  " + cli::wrong("cd") + "  ef";
    EXPECT_EQ(fitted(text + "\n", 10, 24), text);
    EXPECT_EQ(cli::shown(text, true), "ab  \033[1;31mcd\033[0m  ef");
    EXPECT_EQ(cli::shown(text, false), "ab  cd  ef");
    EXPECT_EQ(cli::shown(fitted(cli::wrong("abcdef") + "\n", 3, 24), true), "\033[1;31mabc\033[0m")
        << "what is cut off ends all the same";
}

TEST(TopTerminal, AResizedPageIsDrawnAnewAtOnce) {
    KNURL_NEEDS(missing_terminal());
    winsize size{.ws_row = 20, .ws_col = 80, .ws_xpixel = 0, .ws_ypixel = 0};
    int screen = -1;
    const pid_t pid = ::forkpty(&screen, nullptr, nullptr, &size);
    if (pid == 0) {
        ::setenv("TERM", "xterm", 1);
        cli::Terminal terminal(true);
        terminal.show("1\n2\n3\n4\n5\n");
        terminal.wait(3600);  // shows nothing more until it is asked to end
        _exit(0);
    }
    std::string shown;
    const auto shows = [&](const char* what) {
        char text[4096];
        while (shown.find(what) == std::string::npos) {
            const ssize_t n = ::read(screen, text, sizeof text);  // blocks; ctest has a timeout
            if (n <= 0) return false;
            shown.append(text, static_cast<std::size_t>(n));
        }
        return true;
    };
    ASSERT_TRUE(shows("5")) << shown;
    size.ws_row = 3;
    ASSERT_EQ(::ioctl(screen, TIOCSWINSZ, &size), 0);
    EXPECT_TRUE(shows("... and 4 lines more")) << shown;
    ::kill(pid, SIGTERM);
    int status = 0;
    ASSERT_EQ(::waitpid(pid, &status, 0), pid);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    ::close(screen);
}

}  // namespace
}  // namespace knurl::test
