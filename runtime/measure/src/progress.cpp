#include <algorithm>
#include <cstdio>
#include <utility>

#include <sys/ioctl.h>
#include <unistd.h>

#include <knurl/measure/progress.hpp>

namespace knurl::measure {

namespace {

constexpr auto pace = std::chrono::milliseconds(100);

std::size_t columns() {
    winsize size{};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1u : 79u;
}

}  // namespace

Progress::Progress(std::string who) : who_(std::move(who)), terminal_(::isatty(STDERR_FILENO) != 0) {}
Progress::~Progress() {
    clear();
}

void Progress::show(const std::string& text) {
    const auto now = std::chrono::steady_clock::now();
    if (!terminal_ || now < next_) return;
    next_ = now + pace;
    // Cut off, since a wrapped line cannot be overwritten.
    const std::string line = (who_ + ": " + text).substr(0, columns());
    const std::size_t rest = shown_ > line.size() ? shown_ - line.size() : 0;
    std::fprintf(stderr, "\r%s%*s", line.c_str(), static_cast<int>(rest), "");
    shown_ = line.size();
}

void Progress::clear() {
    if (shown_ > 0) std::fprintf(stderr, "\r%*s\r", static_cast<int>(shown_), "");
    shown_ = 0;
    next_ = {};
}

std::string seconds_of(double done, double all) {
    char text[64];
    if (all > 0)
        std::snprintf(text, sizeof text, "%.0f of %.0f s", std::min(done, all), all);
    else
        std::snprintf(text, sizeof text, "%.0f s", done);
    return text;
}

}  // namespace knurl::measure
