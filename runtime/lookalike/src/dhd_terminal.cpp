// The parts of the interface that have nothing to do with devices: keyboard, time, threads.

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <new>
#include <thread>

#include <poll.h>
#include <pthread.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "dhd.h"
#include "dhd_state.hpp"

namespace {

termios before;  // the terminal as the program found it

void restore() {
    ::tcsetattr(STDIN_FILENO, TCSANOW, &before);
}

/// Keys without Enter, until the process ends.
void take_terminal() {
    static const bool taken = [] {
        if (::isatty(STDIN_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &before) != 0) return false;
        termios raw = before;
        raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
        std::atexit(restore);
        return ::tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
    }();
    static_cast<void>(taken);
}

bool ended = false;  // standard input: nothing will come

}  // namespace

extern "C" {

bool dhdKbHit(void) {
    if (ended) return false;
    take_terminal();
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (::poll(&input, 1, 0) <= 0) return false;
    int waiting = 0;  // bytes; of a pipe or a file that has ended there are none, for ever
    if (::ioctl(STDIN_FILENO, FIONREAD, &waiting) != 0 || waiting <= 0) ended = true;
    return !ended;
}

char dhdKbGet(void) {
    take_terminal();
    char key = 0;
    if (ended || ::read(STDIN_FILENO, &key, 1) <= 0) {
        ended = true;
        return 0;
    }
    return key;
}

double dhdGetTime(void) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void dhdSleep(double seconds) {
    constexpr double longest = 1e6;
    if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(std::fmin(seconds, longest)));
}

unsigned long dhdGetSystemCounter(void) {
    return static_cast<unsigned long>(std::chrono::steady_clock::now().time_since_epoch().count());
}

int dhdStartThread(void* (*body)(void*), void* argument, int) {
    using namespace knurl::lookalike::dhd;
    if (body == nullptr) return fail(Code::null_argument);
    pthread_t thread;
    if (::pthread_create(&thread, nullptr, body, argument) != 0) return fail(Code::failed);
    ::pthread_detach(thread);
    return 0;
}

}  // extern "C"
