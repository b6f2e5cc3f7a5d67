#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/flight_recorder.hpp>
#include <knurl/servo/guardian.hpp>
#include <knurl/servo/realtime.hpp>

namespace knurl::servo {

namespace {

/// Memory shared by servo and guardian, written only by the guardian.
struct Board {
    std::array<std::atomic<std::uint64_t>, protocol::max_devices> acts;
    std::atomic<std::uint64_t> beat;
};

constexpr char goodbye_byte = 'G';
constexpr char watching_in_real_time = 'R', watching = 'W';  // the guardian's first and only word
// No device is enabled: a force takes far longer than this to ramp up.
constexpr int idle_tick_ms = GuardianWatch::idle_tick / 1'000'000;

shm::UniqueFd open_pidfd(pid_t pid) {
    return shm::UniqueFd(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
}

std::runtime_error system_error(const char* what) {
    return std::runtime_error(fmt::format("knurld: {}: {}", what, std::strerror(errno)));
}

/// One guarded device as the guardian sees it.
struct Watched {
    drivers::Device* device;
    const std::byte* segment;
    shm::BroadcastReader reports;
    StallWatch stall;

    bool enabled() const noexcept {
        // The newest report's number is one less than the count. The servo may publish between the two reads,
        // so try again.
        for (int attempt = 0; attempt < 4; ++attempt) {
            const std::uint64_t end = reports.published();
            Report report;
            if (end == 0) return false;
            if (!reports.at(end - 1, &report)) continue;
            return report.state == DeviceState::ramp_up || report.state == DeviceState::active ||
                   report.state == DeviceState::ramp_down;
        }
        return true;  // it publishes as fast as this reads: it is certainly alive, and the watch sees the
                      // beat
    }
};

/// Is the process that created this stopped, by a signal or a debugger: proc(5), "stat". Without /proc the
/// answer is never yes, and a stopped process counts as late. 4 us.
class StopWatch {
  public:
    bool stopped() const noexcept {
        std::array<char, 64> text;
        const ssize_t n = pread(stat_.get(), text.data(), text.size(), 0);
        // Skips the name, which is in parentheses and may contain some.
        const std::string_view begin(text.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
        const std::size_t name_end = begin.rfind(')');
        if (name_end == begin.npos || name_end + 2 >= begin.size()) return false;
        return begin[name_end + 2] == 'T' || begin[name_end + 2] == 't';
    }

  private:
    shm::UniqueFd stat_{open("/proc/self/stat", O_RDONLY | O_CLOEXEC)};  // the creator's, also after a fork
};

/// Zeroes the devices whose servo no longer publishes. True: a device is enabled. `stopped`: the servo is
/// stopped by a signal or a debugger.
bool zero_stalled(std::vector<Watched>& devices, Board& board, MonotonicClock& clock, bool stopped) {
    bool any_enabled = false;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        Watched& watched = devices[i];
        const bool enabled = watched.enabled();
        any_enabled |= enabled;
        if (watched.stall.tick(clock.now(), watched.reports.published(), enabled, stopped)) {
            // The word comes first, then the zero. A servo that continues in between finds the word, and its
            // gain is 0 before it writes again. Pairs with the acquire in Loop::run.
            board.acts[i].fetch_add(1, std::memory_order_release);
            watched.device->make_safe();
        }
    }
    return any_enabled;
}

enum class ServoState { runs, has_said_goodbye, has_died };

/// Waits for news of the servo, for one tick at most.
ServoState wait_for_news(int line, int servo_pidfd, int tick_ms) {
    std::array<pollfd, 2> waits{pollfd{.fd = line, .events = POLLIN, .revents = 0},
                                pollfd{.fd = servo_pidfd, .events = POLLIN, .revents = 0}};
    if (poll(waits.data(), waits.size(), tick_ms) <= 0) return ServoState::runs;

    // A goodbye in the socket counts even if the servo has ended since.
    char byte = 0;
    const ssize_t n = recv(line, &byte, 1, MSG_DONTWAIT);
    if (n == 1 && byte == goodbye_byte) return ServoState::has_said_goodbye;
    const bool hung_up = n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR);
    return hung_up || (waits[1].revents & POLLIN) != 0 ? ServoState::has_died : ServoState::runs;
}

/// Saves the last reports of a servo that died, and says so.
void save_last_reports(const std::vector<Watched>& devices, const std::string& state_directory) {
    std::string saved, not_saved;
    for (const Watched& watched : devices) {
        try {
            saved += fmt::format("{} {}", saved.empty() ? "; its last reports are in" : ",",
                                 write_flight_record(state_directory, watched.segment,
                                                     "killed, crashed or ended without saying goodbye"));
        } catch (const std::exception& error) {
            not_saved = fmt::format("; {}", error.what());
        }
    }
    std::fprintf(stderr, "knurl-guardian: the servo died; its devices are zeroed%s%s\n", saved.c_str(),
                 not_saved.c_str());
}

/// The guardian's main loop. Returns when nothing is left to guard.
void keep_watch(std::vector<Watched>& devices, Board& board, int line, int servo_pidfd,
                const StopWatch& servo, const std::string& state_directory) {
    MonotonicClock clock;
    bool any_enabled = false;
    ServoState state = ServoState::runs;
    while (state == ServoState::runs) {
        board.beat.fetch_add(1, std::memory_order_relaxed);
        any_enabled = zero_stalled(devices, board, clock, any_enabled && servo.stopped());
        const int tick_ms = any_enabled ? static_cast<int>(StallWatch::period / 1'000'000) : idle_tick_ms;
        state = wait_for_news(line, servo_pidfd, tick_ms);
    }
    if (state == ServoState::has_said_goodbye) return;

    for (Watched& watched : devices) watched.device->make_safe();
    // The devices are safe. Writing a file may take time, and must not delay real-time threads.
    const sched_param ordinary{};
    sched_setscheduler(0, SCHED_OTHER, &ordinary);
    save_last_reports(devices, state_directory);
}

}  // namespace

bool StallWatch::tick(Nanoseconds now, std::uint64_t beat, bool enabled, bool stopped) noexcept {
    const Nanoseconds ran = last_ == 0 ? 0 : std::min(now - last_, longest_tick);
    last_ = now;
    if (beat != beat_ || !enabled) {
        beat_ = beat;
        still_ = 0;
        acted_ = false;
        return false;
    }
    still_ += ran;
    // Two ticks without a beat are needed: a thread may have been stopped in the middle of its cycle.
    if (acted_ || still_ <= (stopped ? period : stall_)) return false;
    acted_ = true;
    return true;
}

bool GuardianWatch::still(Nanoseconds now, std::uint64_t beat) noexcept {
    const Nanoseconds ran = last_ == 0 ? 0 : std::min(now - last_, longest_cycle);
    last_ = now;
    still_for_ = beat == beat_ ? still_for_ + ran : 0;
    beat_ = beat;
    return still_for_ > patience_;
}

Guardian::Guardian(std::span<const GuardedDevice> devices, const GuardianOptions& options)
    : board_(shm::Segment::create("knurl-guardian", 4096)) {
    static_assert(sizeof(Board) <= 4096 && std::atomic<std::uint64_t>::is_always_lock_free);
    Board& board = *new (board_.data()) Board{};

    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw system_error("socketpair");
    line_ = shm::UniqueFd(ends[0]);
    shm::UniqueFd guardians_end(ends[1]);
    // Of this process, before the fork: in the child getppid() might already name another process.
    const shm::UniqueFd servo_pidfd = open_pidfd(getpid());
    if (!servo_pidfd) throw system_error("pidfd_open");
    const StopWatch servo;

    std::fflush(nullptr);  // else the child might print it again
    pid_ = fork();
    if (pid_ < 0) throw system_error("cannot fork the guardian");
    if (pid_ == 0) {
        // A process group of its own, so that ^C on the terminal reaches only the servo, which then says
        // goodbye.
        setpgid(0, 0);
        for (int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) std::signal(signal, SIG_IGN);
        prctl(PR_SET_NAME, "knurl-guardian");
        line_.reset();
        for (int fd : options.close) close(fd);
        try {
            Shortfalls reported_by_the_servo;
            if (options.servo_cpu >= 0) keep_off_cpu(options.servo_cpu);
            lock_memory(reported_by_the_servo);
            become_real_time(options.priority, "knurl-guardian", reported_by_the_servo);
            std::vector<Watched> watched;
            for (const GuardedDevice& device : devices) {
                watched.push_back({device.device, device.segment,
                                   shm::BroadcastReader(device.segment + protocol::device_layout().reports,
                                                        protocol::report_slots, sizeof(Report)),
                                   StallWatch(static_cast<Nanoseconds>(options.stall * 1e9))});
            }
            const char word = sched_getscheduler(0) == SCHED_FIFO ? watching_in_real_time : watching;
            send(guardians_end.get(), &word, 1, MSG_NOSIGNAL);
            keep_watch(watched, board, guardians_end.get(), servo_pidfd.get(), servo,
                       options.state_directory);
        } catch (const std::exception& error) {
            std::fprintf(stderr, "knurl-guardian: %s\n", error.what());
            _exit(1);
        }
        _exit(0);  // no destructors: the devices belong to the servo
    }
    pidfd_ = open_pidfd(pid_);
    if (!pidfd_) throw system_error("pidfd_open of the guardian");
    guardians_end.reset();
    char word = 0;
    ssize_t received = 0;
    do received = recv(line_.get(), &word, 1, 0);
    while (received < 0 && errno == EINTR);
    if (received != 1) throw std::runtime_error("knurld: the guardian ended before it watched");
    real_time_ = word == watching_in_real_time;
}

Guardian::~Guardian() {
    goodbye();
}

GuardianSigns Guardian::signs(std::size_t i) const {
    const Board& board = *reinterpret_cast<const Board*>(board_.data());
    return {.acts = board.acts[i], .beat = board.beat};
}

void Guardian::goodbye() noexcept {
    if (pid_ < 0) return;
    send(line_.get(), &goodbye_byte, 1, MSG_NOSIGNAL | MSG_DONTWAIT);
    line_.reset();
    pollfd wait{.fd = pidfd_.get(), .events = POLLIN, .revents = 0};
    constexpr int patience_ms = 1000;
    // Only a stopped guardian takes longer; it ends when it is continued.
    if (poll(&wait, 1, patience_ms) > 0) waitpid(pid_, nullptr, 0);
    pid_ = -1;
}

}  // namespace knurl::servo
