#include "streams.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <initializer_list>

#include <fcntl.h>
#include <poll.h>
#include <sys/types.h>
#include <unistd.h>

namespace knurl::commandline {

namespace {

bool broken_pipe_kills = true;  // the parent did not ignore SIGPIPE

/// Accepts everything, even if it cannot be written: fmt and iostreams throw when a write fails, and a
/// program must not lose its work for that.
ssize_t say(void*, const char* text, std::size_t size) {
    for (std::size_t at = 0; at < size;) {
        const ssize_t n = ::write(STDERR_FILENO, text + at, size - at);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        at += static_cast<std::size_t>(n);
    }
    return static_cast<ssize_t>(size);
}

}  // namespace

void secure_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) != -1 || errno != EBADF) continue;
        // All lower descriptors are open, so this one gets the number. A write to a closed stream must fail
        // as before.
        [[maybe_unused]] const int opened =
            ::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
    }
    broken_pipe_kills = std::signal(SIGPIPE, SIG_IGN) == SIG_DFL;
    cookie_io_functions_t functions{};
    functions.write = say;
    if (std::FILE* quiet = ::fopencookie(nullptr, "w", functions)) {
        std::setvbuf(quiet, nullptr, _IONBF, 0);
        stderr = quiet;
    }
}

int output_problem() {
    const bool before = std::ferror(stdout) != 0;
    errno = 0;
    if (std::fflush(stdout) != 0) return errno != 0 ? errno : no_reason;
    if (!before) return 0;
    pollfd one{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
    return ::poll(&one, 1, 0) == 1 && (one.revents & POLLERR) != 0 ? EPIPE : no_reason;
}

void die_of_broken_pipe() {
    if (!broken_pipe_kills) return;
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
}

}  // namespace knurl::commandline
