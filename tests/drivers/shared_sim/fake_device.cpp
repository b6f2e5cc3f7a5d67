// knurl-fake-device FILE: a simulated device in a separate process, for the chaos runner. It outlives the
// servo and records, by its own clock, every effort that reaches it.

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <new>
#include <stdexcept>
#include <string>

#include <Eigen/LU>
#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/sim_device.hpp>

#include "layout.hpp"

namespace {

using namespace knurl::drivers;
using namespace knurl::drivers::shared_sim;

volatile std::sig_atomic_t leaving = 0;

struct Arguments {
    std::string path, profile = "premium15", hand;
    std::int64_t period_us = 200;
    std::uint64_t capacity = 1 << 18;
    bool outlive = false;  // continue when the parent dies
};

Arguments parse(int argc, char** argv) {
    Arguments arguments;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto next = [&]() -> std::string {
            if (i + 1 >= argc) {
                throw std::runtime_error(word + " needs a value");
            }
            return argv[++i];
        };
        if (word == "--profile") {
            arguments.profile = next();
        } else if (word == "--hand") {
            arguments.hand = next();
        } else if (word == "--period-us") {
            arguments.period_us = std::stol(next());
        } else if (word == "--capacity") {
            arguments.capacity = std::stoul(next());
        } else if (word == "--outlive") {
            arguments.outlive = true;
        } else if (arguments.path.empty() && !word.starts_with('-')) {
            arguments.path = word;
        } else {
            throw std::runtime_error("unknown argument " + word);
        }
    }
    if (arguments.path.empty() || arguments.period_us < 20 || arguments.period_us > 1000 ||
        arguments.capacity == 0) {
        throw std::runtime_error(
            "usage: knurl-fake-device FILE [--profile premium15,...] [--hand FILE.csv] "
            "[--period-us 20..1000] [--capacity RECORDS] [--outlive]");
    }
    return arguments;
}

/// The file under a temporary name, sparse and mapped.
Shared* make_file(const std::string& path, const Arguments& arguments) {
    const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const std::size_t size = file_size(arguments.capacity);
    if (fd < 0 || ftruncate(fd, static_cast<off_t>(size)) != 0) {
        throw std::runtime_error(path + ": " + std::strerror(errno));
    }
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    if (memory == MAP_FAILED) {
        throw std::runtime_error(path + ": " + std::strerror(errno));
    }
    auto* shared = new (memory) Shared;
    shared->capacity = arguments.capacity;
    if (arguments.profile.size() >= shared->profile.size()) {
        throw std::runtime_error("the profile's name is too long");
    }
    std::memcpy(shared->profile.data(), arguments.profile.data(), arguments.profile.size());
    return shared;
}

class Loop {
  public:
    Loop(SimDevice& device, Shared& shared) : device_(device), shared_(shared) {}

    void once(std::int64_t now) {
        obey(shared_.control.load(std::memory_order_acquire), now);
        const std::uint64_t notice = shared_.notice.load(std::memory_order_acquire);
        if (notice != notice_) {
            notice_ = notice;
            const bool begins = (notice & 1U) != 0;
            device_.notify(begins ? Notice::claim_active : Notice::disabled);
            record(now, begins ? Event::hand_begins : Event::hand_rests, 0);
        }
        const std::uint64_t word = shared_.effort.load(std::memory_order_acquire);
        if (word != word_ && !unplugged_) {
            take(word, now);
        }
        device_.read(now, sample_);
        if (device_.state().watchdog_trips != trips_) {
            trips_ = device_.state().watchdog_trips;
            efforts_ = {};
            record(now, Event::watchdog, 0);
        }
        if (!stalled_) {
            std::array<std::int64_t, joints> counts{};
            for (std::size_t i = 0; i < joints; ++i) {
                counts[i] = std::llround(sample_.position[i] / device_.link().radians_per_count[i]);
            }
            shared_.sample.store(pack_counts(counts, sample_.calibrated), std::memory_order_relaxed);
            shared_.steps.fetch_add(1, std::memory_order_release);
        }
    }

  private:
    void obey(std::uint64_t control, std::int64_t now) {
        stalled_ = (control & control_stall) != 0;
        leaving = leaving != 0 || (control & control_leave) != 0;
        const bool unplug = (control & control_unplug) != 0;
        if (unplug != unplugged_) {
            unplugged_ = unplug;
            efforts_ = {};
            device_.write(now, {});
            // What was on the wire at the moment of unplugging never arrives.
            word_ = shared_.effort.load(std::memory_order_acquire);
            record(now, unplug ? Event::unplugged : Event::plugged, 0);
            shared_.state.store(unplug ? state_unplugged : state_running, std::memory_order_release);
        }
        shared_.obeyed.store(control, std::memory_order_release);
    }

    void take(std::uint64_t word, std::int64_t now) {
        const EffortWord before = EffortWord::unpack(word_), after = EffortWord::unpack(word);
        word_ = word;
        const std::uint32_t apart = (after.count - before.count) & 0x3fffU;
        const std::uint32_t missed = after.writer == before.writer && apart > 0 ? apart - 1 : 0;
        shared_.writes.fetch_add(missed + 1, std::memory_order_relaxed);
        efforts_ = {};
        for (std::size_t i = 0; i < joints; ++i) {
            efforts_[i] = after.share[i] / 32767.0 * device_.link().effort_limit[i];
        }
        device_.write(now, efforts_);
        if (after.share != before.share || after.writer != before.writer || missed > 0) {
            record(now, after.writer == Writer::guardian ? Event::guardian_write : Event::servo_write,
                   missed);
        }
    }

    void record(std::int64_t now, Event event, std::uint32_t missed) {
        const std::uint64_t index = shared_.records.load(std::memory_order_relaxed);
        if (index >= shared_.capacity) {
            shared_.lost.fetch_add(1, std::memory_order_relaxed);
            return;
        }
        const SimState& truth = device_.state();
        TipPose pose;
        Jacobian jacobian;
        device_.mechanism().forward(truth.joints, pose, jacobian);
        const Eigen::Vector3d force = jacobian.topLeftCorner<3, 3>().transpose().inverse() *
                                      Eigen::Vector3d(efforts_[0], efforts_[1], efforts_[2]);
        Record& entry = log_of(&shared_)[index];
        entry.t = now;
        entry.event = event;
        entry.missed = missed;
        for (std::size_t i = 0; i < joints; ++i) {
            const auto axis = static_cast<Eigen::Index>(i);
            entry.effort[i] = efforts_[i];
            entry.force[i] = force[axis];
            entry.position[i] = truth.position[axis];
            entry.velocity[i] = truth.velocity[axis];
        }
        shared_.records.store(index + 1, std::memory_order_release);
    }

    SimDevice& device_;
    Shared& shared_;
    JointSample sample_;
    JointEfforts efforts_ = {};
    std::uint64_t word_ = 0, notice_ = 0, trips_ = 0;
    bool unplugged_ = false, stalled_ = false;
};

std::int64_t monotonic() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

void run(const Arguments& arguments) {
    std::optional<Motion> hand;
    if (!arguments.hand.empty()) {
        hand = load_motion(arguments.hand);
    }
    SimDevice device(sim_profile(arguments.profile), hand);
    if (device.link().sensed_joints != joints || !(device.profile().quantum > 0)) {
        throw std::runtime_error(
            "the fake device needs a profile of three joints with encoders (quantum not 0)");
    }
    const std::string being_made = arguments.path + ".new";
    Shared& shared = *make_file(being_made, arguments);
    Loop loop(device, shared);

    // Real-time priority, if allowed: then it looks on time, and no page that it writes first, or that was
    // taken from it, makes it wait. (A hypervisor may take tens of milliseconds to find a page.)
    const sched_param priority{.sched_priority = 60};
    sched_setscheduler(0, SCHED_FIFO, &priority);
    mlockall(MCL_CURRENT);
    std::int64_t next = monotonic();
    loop.once(next);
    if (std::rename(being_made.c_str(), arguments.path.c_str()) != 0) {
        throw std::runtime_error(arguments.path + ": " + std::strerror(errno));
    }
    while (leaving == 0) {
        next = std::max(next + arguments.period_us * 1000, monotonic() - 1'000'000);
        const timespec until{.tv_sec = next / 1'000'000'000, .tv_nsec = next % 1'000'000'000};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
        loop.once(monotonic());
    }
    shared.state.store(state_gone, std::memory_order_release);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Arguments arguments = parse(argc, argv);
        struct sigaction action = {};
        action.sa_handler = [](int) { leaving = 1; };
        sigaction(SIGTERM, &action, nullptr);
        sigaction(SIGINT, &action, nullptr);
        if (!arguments.outlive) {
            prctl(PR_SET_PDEATHSIG, SIGTERM);
        }
        run(arguments);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl-fake-device: %s\n", error.what());
        return 1;
    }
    return 0;
}
