#include "top_terminal.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <initializer_list>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace knurl::cli {

namespace {

constexpr std::size_t indent = 4;

bool is_mark(char c) {
    return c == wrong_begins || c == wrong_ends;
}

std::size_t width_of(const std::string& text) {
    return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_mark));
}

/// Limits the width and keeps marks.
std::string cut(const std::string& text, std::size_t columns) {
    std::string kept;
    std::size_t width = 0;
    for (const char c : text)
        if (is_mark(c) || width++ < columns) kept += c;
    return kept;
}

/// The parts between two or more spaces.
std::vector<std::string> fields(const std::string& line, std::size_t from) {
    std::vector<std::string> found;
    while ((from = line.find_first_not_of(' ', from)) != std::string::npos) {
        const std::size_t end = std::min(line.find("  ", from), line.size());
        found.push_back(line.substr(from, end - from));
        from = end;
    }
    return found;
}

void wrap(const std::string& line, std::size_t columns, std::vector<std::string>& lines) {
    if (width_of(line) <= columns) {
        lines.push_back(line);
        return;
    }
    const std::size_t margin = std::min(line.find_first_not_of(' '), line.size());
    std::string next(margin, ' ');
    bool empty = true;
    for (const std::string& field : fields(line, margin)) {
        if (!empty && width_of(next) + 2 + width_of(field) > columns) {
            lines.push_back(next);
            next.assign(margin + indent, ' ');
            empty = true;
        }
        if (!empty) next += "  ";
        next += field;
        empty = false;
    }
    lines.push_back(next);
}

}  // namespace

std::string shown(const std::string& text, bool colours) {
    std::string result;
    for (const char c : text) {
        if (!is_mark(c))
            result += c;
        else if (colours)
            result += c == wrong_begins ? "\033[1;31m" : "\033[0m";
    }
    return result;
}

std::string fitted(const std::string& text, std::size_t columns, std::size_t rows) {
    std::vector<std::string> lines;
    std::istringstream all(text);
    for (std::string line; std::getline(all, line);) wrap(line, columns, lines);
    if (lines.size() > rows && rows > 0) {
        const std::size_t left = lines.size() - rows + 1;
        lines.resize(rows);
        lines.back() = fmt::format("... and {} lines more", left);
    }
    std::string page;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (i > 0) page += '\n';
        page += cut(lines[i], columns);
    }
    return page;
}

Terminal::Terminal(bool page) : page_(page && ::isatty(STDOUT_FILENO) != 0) {
    const char* kind = std::getenv("TERM");
    page_ = page_ && kind != nullptr && std::strcmp(kind, "dumb") != 0;
    const char* none = std::getenv("NO_COLOR");
    colours_ = page_ && (none == nullptr || *none == '\0');
    ::sigemptyset(&signals_);
    // SIGWINCH is included, so that it wakes the wait though it has no handler. Without a page there is
    // nothing to restore, so suspension needs no handling.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&signals_, signal);
    if (page_)
        for (const int signal : {SIGTSTP, SIGWINCH}) ::sigaddset(&signals_, signal);
    ::sigprocmask(SIG_BLOCK, &signals_, &before_);
    enter();
}

Terminal::~Terminal() {
    leave();
    // A signal that arrived meanwhile has been handled by now.
    const timespec none{};
    while (::sigtimedwait(&signals_, nullptr, &none) > 0) {
    }
    ::sigprocmask(SIG_SETMASK, &before_, nullptr);
}

void Terminal::enter() {
    if (!page_) return;
    keys_.emplace(true);
    fmt::print("\033[?1049h\033[?25l");  // another page, no cursor
    draw();
}

void Terminal::leave() {
    if (page_) fmt::print("\033[?25h\033[?1049l");
    std::fflush(stdout);
    keys_.reset();
}

void Terminal::show(const std::string& text) {
    shown_ = text;
    draw();
}

void Terminal::draw() const {
    if (page_) {
        winsize size{};
        const bool known =
            ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;
        const std::size_t columns = known ? size.ws_col : 80, rows = known ? size.ws_row : 24;
        const bool hint = keys_ && keys_->there() && rows > 2;
        // Erases first, then writes: after a line that ends in the last column nothing can be erased.
        fmt::print("\033[H\033[J{}", shown(fitted(shown_, columns, hint ? rows - 1 : rows), colours_));
        if (hint) fmt::print("\033[{};1H{}", rows, std::string("q: end").substr(0, columns));
    } else {
        fmt::print("{}", shown(shown_, false));
    }
    std::fflush(stdout);
}

bool Terminal::wait(double seconds) {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    const double end = static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9 + seconds;
    for (double left = seconds; left > 0;) {
        // A key comes through a descriptor, so a wait for signals sees it only at the next check.
        constexpr double key_pace = 0.1;  // s
        const bool keys = keys_ && keys_->there();
        for (char key = keys ? keys_->next() : '\0'; key != '\0'; key = keys_->next())
            if (key == 'q' || key == 'Q') return false;
        if (keys) left = std::min(left, key_pace);
        const timespec pause{.tv_sec = static_cast<time_t>(left),
                             .tv_nsec = static_cast<long>((left - std::floor(left)) * 1e9)};
        const int signal = ::sigtimedwait(&signals_, nullptr, &pause);
        if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) return false;
        if (signal == SIGTSTP) {
            leave();
            ::raise(SIGSTOP);
            enter();
        } else if (signal == SIGWINCH) {
            draw();
        }
        ::clock_gettime(CLOCK_MONOTONIC, &now);
        left = end - static_cast<double>(now.tv_sec) - static_cast<double>(now.tv_nsec) * 1e-9;
    }
    return true;
}

}  // namespace knurl::cli
