// A servo in small, for the test of the guardian: opens the device at argv[1], forks its guardian, then
// cycles at 1 kHz with a constant effort of 0.1 N m until it is killed; after it has stood still for half a
// second, with 0.05.
//   to the test (stdout):  "ready GUARDIAN-PID real-time|ordinary"
//   guardian: makes the device safe when the servo has died, or when a byte comes from stdin (in the place of
//   the servo's stall watch), and says so: "safe"

#include <cstdio>
#include <ctime>
#include <memory>

#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <knurl/drivers/registry.hpp>

namespace {

using knurl::drivers::Nanoseconds;

Nanoseconds now() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

/// Like knurld and its guardian, where allowed. Without it, nothing is guaranteed in milliseconds.
bool real_time(int priority) {
    const sched_param parameters{.sched_priority = priority};
    return sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
}

[[noreturn]] void guard(knurl::drivers::Device& device, int servo) {
    real_time(50);
    for (;;) {
        pollfd waits[2] = {{.fd = servo, .events = POLLIN, .revents = 0},
                           {.fd = STDIN_FILENO, .events = POLLIN, .revents = 0}};
        poll(waits, 2, -1);
        char byte = 0;
        const bool asked = (waits[1].revents & POLLIN) != 0 && read(STDIN_FILENO, &byte, 1) == 1;
        const bool dead = waits[0].revents != 0;
        if (asked || dead) {
            device.make_safe();
            std::puts("safe");
        }
        if (dead || (!asked && waits[1].revents != 0)) _exit(0);
    }
}

}  // namespace

int main(int, char** argv) {
    prctl(PR_SET_TIMERSLACK, 1UL);
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const bool promises = real_time(40);
    const auto device = knurl::drivers::open_device(argv[1], {.hand_file = "", .seed = 1, .io_priority = 41});
    const int servo = static_cast<int>(syscall(SYS_pidfd_open, getpid(), 0));
    const pid_t guardian = fork();
    if (guardian == 0) guard(*device, servo);
    std::printf("ready %d %s\n", static_cast<int>(guardian), promises ? "real-time" : "ordinary");

    double push = 0.1;  // N m
    Nanoseconds due = now();
    for (;;) {
        due += 1'000'000;
        const timespec until{.tv_sec = due / 1'000'000'000, .tv_nsec = due % 1'000'000'000};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
        const Nanoseconds t = now();
        if (t - due > 500'000'000) push = 0.05;
        due = t;
        knurl::drivers::JointSample sample;
        device->read(t, sample);
        device->write(t, {push, push, push});
    }
}
