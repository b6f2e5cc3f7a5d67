#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>
#include <set>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/drivers/motion.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/servo/daemon.hpp>
#include <knurl/servo/guardian.hpp>
#include <knurl/servo/loop.hpp>
#include <knurl/servo/realtime.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/counters.hpp>

#include "door.hpp"

namespace knurl::servo {

namespace {

constexpr double longest_hold = 50e-3;  // s: the longest stop by real-time throttling or a host
constexpr double impulse_bound = 0.1;   // N s into the hand during such a stop, if the device has no watchdog
constexpr int lateness_samples = 32;

void say(const std::string& line) {
    std::fputs((line + "\n").c_str(), stdout);
    std::fflush(stdout);
}

void complain(const std::string& line) {
    std::fputs(("knurld: " + line + "\n").c_str(), stderr);
}

/// Signals arrive through a descriptor, in the broker's thread only. Call this before any thread is created.
shm::UniqueFd take_signals() {
    sigset_t set;
    sigemptyset(&set);
    for (int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGPIPE, SIG_IGN);  // a closed terminal must not end a servo
    shm::UniqueFd fd(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
    if (!fd) throw std::runtime_error(fmt::format("signalfd: {}", std::strerror(errno)));
    return fd;
}

/// Each client costs four descriptors, and the usual soft limit is 1024.
void raise_descriptor_limit() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = std::max(limit.rlim_cur, std::min<rlim_t>(limit.rlim_max, 8192));
    setrlimit(RLIMIT_NOFILE, &limit);
}

/// 0: this process runs without real-time priority.
int raised(int priority, int by) {
    return priority == 0 ? 0 : priority + by;
}

/// A thread that runs something until it is told to stop.
template <class What>
struct Runs {
    What& what;
    Thread thread;
    ~Runs() { what.stop(); }
};

/// One device and the threads and objects that run it.
struct Station {
    DeviceConfig config;
    std::unique_ptr<drivers::Device> device;
    shm::Segment segment;
    MonotonicClock clock;
    std::unique_ptr<Servo> servo;
    std::unique_ptr<Loop> loop;
    std::unique_ptr<Thread> thread;

    Station(const DeviceConfig& stated, const DaemonConfig& daemon) : config(stated) {
        device =
            drivers::open_device(config.address, {.hand_file = config.hand_file,
                                                  .seed = config.seed,
                                                  .io_priority = raised(daemon.priority, io_above_servo)});
        const drivers::LinkConfig& link = device->link();
        if (config.rate == 0) config.rate = daemon.rate;
        if (config.rate == 0) config.rate = std::min(default_rate, link.nominal_rate);
        if (config.name.empty()) {
            config.name = link.name;
            require_name(config.name, "the profile's name");
        }
        check_limits(config.limits, link, fmt::format("device \"{}\"", config.name));

        const protocol::DeviceLayout layout = protocol::device_layout();
        segment = shm::Segment::create("knurl-reports", layout.total);
        auto& info = *reinterpret_cast<protocol::DeviceInfo*>(segment.data() + layout.info);
        info.magic = protocol::segment_magic;
        info.layout_hash = protocol::wire_hash();
        protocol::put_text(info.servo, daemon.name);
        protocol::put_text(info.name, config.name);
        protocol::put_text(info.address, config.address);
        protocol::put_text(info.profile, link.name);
        protocol::put_text(info.serial, link.serial);
        info.joints = static_cast<std::uint32_t>(link.sensed_joints);
        info.renders_torque = link.renders_torque ? 1 : 0;
        info.senses_orientation = link.senses_orientation ? 1 : 0;
        info.servo_pid = static_cast<std::uint32_t>(getpid());
        info.rate = config.rate;
        info.workspace_centre = {link.workspace_centre[0], link.workspace_centre[1],
                                 link.workspace_centre[2]};
        info.workspace_radius = link.workspace_radius;
        info.peak_force = peak_force();
        info.peak_torque = peak_torque();
        info.max_stiffness = max_stiffness(link, config.rate);
        info.damping = link.damping;
        info.lag = link.lag;
        timespec now{};
        clock_gettime(CLOCK_REALTIME, &now);
        info.started_ns = now.tv_sec * Nanoseconds{1'000'000'000} + now.tv_nsec;
        shm::broadcast_init(segment.data() + layout.reports);
        segment.seal_against_new_writers();
        segment.hold_pages();
    }

    shm::Counters counters() {
        return {segment.data() + protocol::device_layout().counters, protocol::count_names};
    }

    double peak_force() const {
        return config.limits.peak_force > 0 ? config.limits.peak_force : device->link().peak_force;
    }
    double peak_torque() const {
        return config.limits.peak_torque > 0 ? config.limits.peak_torque : device->link().peak_torque;
    }

    void stop() noexcept {
        if (loop) loop->stop();
        if (thread) thread->join();
    }

    std::string description() const {
        const drivers::LinkConfig& link = device->link();
        const double impulse = peak_force() * longest_hold;
        std::string rule;
        if (link.has_watchdog) {
            rule = fmt::format("its watchdog switches off after {:g} ms", link.watchdog_time * 1e3);
        } else if (impulse <= impulse_bound) {
            rule = "within the 0.1 N s for a device without a watchdog";
        } else {
            rule = fmt::format(
                "more than the 0.1 N s for a device without a watchdog; limits.peak_force = {:g} keeps it",
                impulse_bound / longest_hold);
        }
        std::string lines = fmt::format(
            "  {}: {} at {:g} Hz, k_max {:.0f} N/m, peak {:g} N; held for {:g} ms that is {:.3g} N s, {}",
            config.name, config.address, config.rate, max_stiffness(link, config.rate), peak_force(),
            longest_hold * 1e3, impulse, rule);
        if (!link.has_watchdog)
            lines +=
                "\n    without a watchdog it keeps its last force while knurld and its guardian are both "
                "stopped";
        if (!link.description.empty()) lines += "\n    " + link.description;
        return lines;
    }
};

/// Ends the loops on every path before the memory of their claims is freed.
struct StopLoops {
    std::vector<std::unique_ptr<Station>>& stations;
    ~StopLoops() {
        for (const auto& station : stations) station->stop();
        for (const auto& station : stations) station->device->make_safe();
    }
};

std::vector<std::unique_ptr<Station>> open_stations(const DaemonConfig& config) {
    std::vector<std::unique_ptr<Station>> stations;
    for (const DeviceConfig& device : config.devices) {
        stations.push_back(std::make_unique<Station>(device, config));
        const std::string& name = stations.back()->config.name;
        const auto same = [&](const auto& other) { return other->config.name == name; };
        if (std::count_if(stations.begin(), stations.end(), same) > 1) {
            throw ConfigError(
                fmt::format("two devices are called \"{}\"; name one of them otherwise: --device left={}",
                            name, device.address));
        }
    }
    return stations;
}

int servo_cpu(const DaemonConfig& config) {
    const std::vector<int> cpus = allowed_cpus();
    if (config.cpu < 0) return cpus.back();  // interrupts prefer the first CPU
    if (std::find(cpus.begin(), cpus.end(), config.cpu) == cpus.end()) {
        throw ConfigError(
            fmt::format("cpu = {}; this process may use: {}", config.cpu, fmt::join(cpus, ", ")));
    }
    return config.cpu;
}

std::string lateness_line(const DaemonConfig& config, int cpu, bool polling) {
    const auto measured = [&] {
        const WakeLateness late = measure_wake_lateness(config.priority, cpu, lateness_samples);
        return fmt::format("p50 {:.0f} us, max {:.0f} us", static_cast<double>(late.p50) * 1e-3,
                           static_cast<double>(late.max) * 1e-3);
    };
    std::string line = fmt::format("wake-ups late by {} of {} with idle = \"{}\"", measured(),
                                   lateness_samples, polling ? "poll" : "sleep");
    if (config.idle == Idle::sleep) {
        Shortfalls unasked;
        const shm::UniqueFd polling_now = hold_idle_polling(unasked);
        if (polling_now) line += fmt::format(" (with \"poll\": {})", measured());
    }
    return fmt::format("{}, spin {:g} us", line, config.spin * 1e6);
}

std::uint64_t memory_budget(const DaemonConfig& config) {
    return config.memory > 0 ? static_cast<std::uint64_t>(config.memory * (1 << 20))
                             : default_memory_budget();
}

ServoOptions servo_options(const DeviceConfig& device) {
    ServoOptions options;
    options.rate = device.rate;
    options.supervisor = device.limits;
    return options;
}

/// Among loops that share a CPU, the faster one has priority (rate-monotonic: Liu & Layland 1973).
int loop_priority(const DaemonConfig& config, const std::vector<std::unique_ptr<Station>>& stations,
                  const Station& station) {
    std::set<double> faster;
    for (const auto& other : stations)
        if (other->config.rate > station.config.rate) faster.insert(other->config.rate);
    return raised(config.priority, -static_cast<int>(faster.size()));
}

}  // namespace

int run_daemon(const DaemonConfig& config) {
    check(config);
    ::umask(::umask(0) | 027);  // sockets say otherwise, explicitly
    tame_malloc();
    shm::UniqueFd signals = take_signals();
    raise_descriptor_limit();
    const int cpu = servo_cpu(config);

    Closer closer;  // outlives whoever has sockets of clients
    // first: a second servo with this name must not touch the devices
    Door door(config.name, config.socket_group, closer);
    std::vector<std::unique_ptr<Station>> stations = open_stations(config);

    Shortfalls missing;
    const shm::UniqueFd idle_polling =
        config.idle == Idle::poll ? hold_idle_polling(missing) : shm::UniqueFd();

    std::vector<GuardedDevice> guarded;
    for (const auto& station : stations) guarded.push_back({station->device.get(), station->segment.data()});
    std::vector<int> not_for_the_guardian{door.socket().get(), signals.get(), closer.socket()};
    if (idle_polling) not_for_the_guardian.push_back(idle_polling.get());
    Guardian guardian(guarded, {.priority = raised(config.priority, guardian_above_servo),
                                .servo_cpu = cpu,
                                .stall = config.guardian_stall,
                                .state_directory = protocol::state_directory(),
                                .close = std::move(not_for_the_guardian)});

    const std::string lateness = lateness_line(config, cpu, static_cast<bool>(idle_polling));
    shm::Waker far_waker, waker;
    waker.leave_untrusted_to(far_waker);
    std::vector<HostedDevice> hosted;
    for (std::size_t i = 0; i < stations.size(); ++i) {
        Station& station = *stations[i];
        station.servo = std::make_unique<Servo>(*station.device, station.clock, station.segment.data(),
                                                servo_options(station.config));
        station.loop = std::make_unique<Loop>(
            *station.servo, waker, station.counters(), guardian.signs(i),
            LoopOptions{.rate = station.config.rate,
                        .spin = static_cast<Nanoseconds>(config.spin * 1e9),
                        .guardian_patience = guardian.real_time() ? GuardianWatch::patience
                                                                  : GuardianWatch::ordinary_patience});
        hosted.push_back({.name = station.config.name,
                          .link = station.device->link(),
                          .servo = *station.servo,
                          .segment = station.segment,
                          .rate = station.config.rate,
                          .input_log = {.layout = input_log_layout(),
                                        .device_figures = figures_of(*station.device),
                                        .options = servo_options(station.config)}});
    }
    lock_memory(missing);
    DeathWatch deaths;
    Broker broker({.servo_name = config.name,
                   .listener = shm::UniqueFd(fcntl(door.socket().get(), F_DUPFD_CLOEXEC, 0)),
                   .signals = std::move(signals),
                   .guardian_pidfd = guardian.pidfd(),
                   .closer = closer,
                   .deaths = deaths,
                   .memory = memory_budget(config)},
                  std::move(hosted), waker);

    // Destroyed in reverse order: loops, then the waker, then the claims that both used, then servos and
    // devices.
    const int waker_priority = raised(config.priority, -waker_below_servo);
    // Waking clients of other users may take long with preemption off (WakeTarget::trusted).
    const Runs<shm::Waker> far_waker_thread{far_waker, Thread(
                                                           {.name = "knurl-farwaker",
                                                            .priority = waker_priority,
                                                            .cpu = -1,
                                                            .stack_bytes = small_stack_bytes},
                                                           [&far_waker, cpu] {
                                                               keep_off_cpu(cpu);
                                                               far_waker.run();
                                                           },
                                                           missing)};
    const Runs<DeathWatch> death_watch_thread{deaths,
                                              Thread(
                                                  {.name = "knurl-deaths",
                                                   .priority = raised(config.priority, -deaths_below_servo),
                                                   .cpu = -1,
                                                   .stack_bytes = small_stack_bytes},
                                                  [&deaths, cpu] {
                                                      keep_off_cpu(cpu);
                                                      deaths.run();
                                                  },
                                                  missing)};
    const Runs<shm::Waker> waker_thread{
        waker,
        Thread(
            {.name = "knurl-waker", .priority = waker_priority, .cpu = cpu, .stack_bytes = small_stack_bytes},
            [&waker] { waker.run(); }, missing)};
    Broker::End end = Broker::End::at_once;
    {
        const StopLoops stop_loops{stations};
        become_real_time(raised(config.priority, -broker_below_servo), "knurl-broker", missing);
        for (const auto& station : stations) {
            station->thread = std::make_unique<Thread>(
                ThreadOptions{
                    .name = "knurl-servo", .priority = loop_priority(config, stations, *station), .cpu = cpu},
                [loop = station->loop.get()] { loop->run(); }, missing);
        }

        say(fmt::format("knurld {}: servo \"{}\" at {}, pid {}, guardian {}", KNURL_VERSION, config.name,
                        door.path(), getpid(), guardian.pid()));
        say(fmt::format("  on CPU {}, {}", cpu, lateness));
        for (const auto& station : stations) say(station->description());
        for (const std::string& line : missing.report()) complain(line);
        for (const auto& station : stations) {
            const std::string& hand = station->config.hand_file;
            if (hand.empty()) continue;
            if (const auto doubt = drivers::unit_doubt(drivers::load_motion(hand)))
                complain(fmt::format("{}: {}", hand, *doubt));
        }
        say("knurld: ready");

        end = broker.run();
    }
    guardian.goodbye();

    for (const auto& station : stations) {
        const LoopCounts& counts = station->loop->seen();
        say(
            fmt::format("  {}: {} cycles, {} of them late; {} ended after the next deadline, "
                        "{} of these by more than guardian_stall; the latest began {:.0f} us late, the "
                        "longest took {:.0f} us",
                        station->config.name, counts.cycles, station->servo->last().late_count,
                        counts.ended_late, counts.restarts, static_cast<double>(counts.worst_lateness) * 1e-3,
                        static_cast<double>(counts.longest) * 1e-3));
    }
    if (end == Broker::End::guardian_died) {
        complain(
            "the guardian died; a motor is not run unguarded, so every device was ramped down; start knurld "
            "again");
    }
    return end == Broker::End::asked ? 0 : 1;
}

}  // namespace knurl::servo
