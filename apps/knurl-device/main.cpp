// knurl-device: drives one device through its maker's library, for a knurld that has started it. drivers/README.md,
// "Behind a process".

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <knurl/commandline/command.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/drivers/vendor_library.hpp>

#include "backend.hpp"

namespace knurl::device {

namespace {

using drivers::process::Exchange;

constexpr int farewell_ms = 1000;  // for a call of the library to return, when the servo is gone

/// NAME=VALUE of --set.
void put_setting(Arguments& arguments, const std::string& word) {
    const std::size_t equals = word.find('=');
    double value = 0;
    const char* first = word.data() + std::min(equals + 1, word.size());
    const char* last = word.data() + word.size();
    const auto [end, error] = std::from_chars(first, last, value);
    if (equals == std::string::npos || error != std::errc() || end != last)
        throw commandline::UsageError("--set " + word + ": write NAME=NUMBER");
    arguments.settings[word.substr(0, equals)] = value;
}

void become_real_time([[maybe_unused]] int priority) {
    prctl(PR_SET_TIMERSLACK, 1UL);
#if !defined(__SANITIZE_THREAD__)
    mlockall(MCL_CURRENT | MCL_FUTURE);
    const sched_param parameters{.sched_priority = priority};
    // Without the right to it the loop stays ordinary; knurld has said so of itself.
    if (priority > 0) sched_setscheduler(0, SCHED_FIFO, &parameters);
#endif
}

/// Ends the loop when the servo is gone or says so, and the process when the loop does not end.
class Watch {
  public:
    explicit Watch(Exchange& exchange) {
        sigset_t wanted;
        sigemptyset(&wanted);
        for (const int signal : {SIGTERM, SIGINT}) sigaddset(&wanted, signal);
        pthread_sigmask(SIG_BLOCK, &wanted, nullptr);  // before the library starts threads
        signals_ = signalfd(-1, &wanted, SFD_CLOEXEC);
        thread_ = std::thread([this, &exchange] { run(exchange); });
    }
    ~Watch() {
        done_.store(true);
        kill(getpid(), SIGTERM);
        thread_.join();
        close(signals_);
    }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

  private:
    void run(Exchange& exchange) {
        std::array<pollfd, 2> waits{pollfd{.fd = drivers::process::servo_fd, .events = POLLIN, .revents = 0},
                                    pollfd{.fd = signals_, .events = POLLIN, .revents = 0}};
        poll(waits.data(), waits.size(), -1);
        exchange.leave();
        signalfd_siginfo info{};
        if (waits[1].revents != 0 && read(signals_, &info, sizeof info) < 0) return;
        for (int waited = 0; waited < farewell_ms && !done_.load(); waited += 5) poll(nullptr, 0, 5);
        if (!done_.load()) _exit(3);  // a call that never returns: the kernel takes the device from it
    }

    int signals_ = -1;
    std::atomic<bool> done_ = false;
    std::thread thread_;
};

std::unique_ptr<Backend> opened(const Arguments& arguments) {
    if (arguments.scheme == "dhd") return open_dhd(arguments);
    if (arguments.scheme == "hd") return open_hd(arguments);
    throw std::runtime_error("there is no scheme " + arguments.scheme);
}

int serve(const Arguments& arguments) {
    Exchange exchange(drivers::process::mapping_fd, arguments.lane);
    const Watch watch(exchange);
    try {
        const std::unique_ptr<Backend> backend = opened(arguments);
        become_real_time(arguments.priority);
        exchange.ready(backend->description());
        backend->run(exchange);
    } catch (const std::exception& error) {
        exchange.failed(error.what());
        return 1;
    }
    return 0;
}

int survey(const Arguments& arguments) {
    const drivers::VendorLibrary* library = drivers::vendor_library(arguments.scheme);
    if (library == nullptr)
        throw commandline::UsageError("--try: " + arguments.scheme + " needs no maker's library");
    std::string path = arguments.library;
    for (const drivers::FoundLibrary& found : drivers::find_library(*library)) {
        if (!path.empty()) break;
        if (!found.problem.empty())
            throw std::runtime_error("cannot use " + found.path + ": " + found.problem);
        path = found.path;
    }
    if (path.empty())
        throw std::runtime_error("there is no " + library->names.front() + " of the " + library->product +
                                 "; " + library->remedy);
    const Survey seen = arguments.scheme == "hd" ? survey_hd(path) : survey_dhd(path);
    std::printf("%s\t%s\n", seen.version.c_str(), path.c_str());
    for (const Seen& device : seen.devices)
        std::printf("device\t%s\t%s\t%s\n", device.name.c_str(), device.serial.c_str(),
                    device.problem.c_str());
    return 0;
}

int run(int argc, char** argv) {
    Arguments arguments;
    std::vector<std::string> settings;
    std::uint64_t lane = 0;
    bool only_try = false;
    commandline::Command program(
        "knurl-device", "Drives one device through its maker's library, for the knurld that starts it");
    program.option("scheme", arguments.scheme, "driver: dhd, hd").required();
    program.option("--library", arguments.library, "the maker's library").type_name("FILE");
    program.option("--name", arguments.name, "serial number, index or name of the device; else the first");
    program.option("--serial", arguments.serial, "this device alone");
    program.option("--set", settings, "a setting of the driver; may be repeated").type_name("NAME=NUMBER");
    program.option("--lane", lane, "of the memory shared with knurld").within(0, drivers::process::lanes - 1);
    program.option("--priority", arguments.priority, "SCHED_FIFO priority of its loop").within(0, 99);
    program.flag("--try", only_try,
                 "loads the library, prints its version and the devices that it sees, and ends");
    program.footer(
        "knurld starts it for addresses like dhd:, and hands it memory and a pidfd as descriptors 3 and 4. "
        "By hand only\n"
        "--try makes sense.");
    if (program.parse(argc, argv) == commandline::Command::Answer::nothing) return 0;
    for (const std::string& word : settings) put_setting(arguments, word);
    arguments.lane = static_cast<unsigned>(lane);
    return only_try ? survey(arguments) : serve(arguments);
}

}  // namespace

}  // namespace knurl::device

int main(int argc, char** argv) {
    return knurl::commandline::guarded([] { return std::string("knurl-device"); },
                                       [&] { return knurl::device::run(argc, argv); });
}
