#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include <knurl/client/client.hpp>
#include <knurl/dds/robot_side.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/view/rates.hpp>
#include <knurl/view/text.hpp>
#include <knurl/words/nearest.hpp>

#include "device_commands.hpp"
#include "device_topics.hpp"
#include "diagnostics.hpp"

namespace knurl::dds {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto retry = 250ms;         // between two tries to reach the servo
constexpr auto idle_look = 100ms;     // while nobody reads
constexpr auto command_tick = 10ms;   // while somebody holds something
constexpr auto command_idle = 200ms;  // while nobody does
constexpr auto gone_look = 200ms;     // for peers that have come or gone
constexpr auto linger = 1s;           // for which an observer is kept when nobody needs it any more

/// One device of the servo. It has observers only while somebody reads, or may command: an observer costs the servo some
/// instructions in each cycle, even if it never looks.
struct Device {
    DeviceDescription info;
    std::optional<Observer> reports;  // of the thread that writes
    std::optional<Observer> newest;   // of the thread that reads commands
    Clock::time_point commanded{};
    std::optional<DeviceTopics> topics;
    std::unique_ptr<DeviceCommands> commands;
    std::atomic<const char*> state{"DISABLED"};
    std::thread writer;
};

std::string word_of(const Report& report, const char* desk) {
    return report.state == DeviceState::fault          ? "FAULT"
           : report.state == DeviceState::disconnected ? "DISABLED"
                                                       : desk;
}

}  // namespace

struct RobotSide::Impl {
    Impl(Domain& to, RobotOptions said) : domain(to), options(std::move(said)), diagnostics(to, options) {
        keeper = std::thread([this] { keep(); });
    }
    ~Impl() {
        {
            const std::scoped_lock lock(mutex);
            stopping = true;
        }
        changed.notify_all();
        keeper.join();
    }

    bool wait(std::chrono::nanoseconds time) {
        std::unique_lock lock(mutex);
        return !changed.wait_for(lock, time, [this] { return stopping.load(); });
    }

    void keep();
    void open();
    void close();
    void write_of(Device& device);
    void write_one(Device& device);
    void read_commands();
    void look(Device& device);
    std::unique_ptr<DeviceCommands> commands_of(const Device& device);
    bool same_devices();
    void describe(ServoEntry& servo);

    Domain& domain;
    const RobotOptions options;
    Diagnostics diagnostics;
    std::atomic<bool> stopping{false};
    std::atomic<bool> closing{false};  // the threads of the devices end
    std::mutex mutex;
    std::condition_variable changed;
    std::thread keeper;

    std::optional<Client> client;
    std::vector<std::unique_ptr<Device>> devices;
    pid_t servo = 0;
    std::thread commander;
    std::atomic<bool> connected{false};

    // Of the thread that describes.
    std::optional<view::ServoWatch> watch;
    std::optional<view::ServoView> before;
    Clock::time_point looked{};
};

bool RobotSide::Impl::same_devices() {
    std::vector<DeviceDescription> now = client->devices();
    return std::equal(now.begin(), now.end(), devices.begin(), devices.end(),
                      [](const DeviceDescription& a, const auto& b) { return a.name == b->info.name; });
}

void RobotSide::Impl::keep() {
    do {
        try {
            if (!client) open();
            const pid_t now = client->servo_pid();
            connected = now != 0;
            if (connected && std::exchange(servo, now) != now && !same_devices()) close();
        } catch (const std::exception& error) {
            domain.say(error.what());
            close();
        }
    } while (wait(retry));
    close();
}

void RobotSide::Impl::open() {
    client.emplace(Client::connect(options.servo, {.name = "knurl-dds", .wait = 0ms, .hints = false}));
    const view::ServoView seen = view::ServoWatch(protocol::servo_address(options.servo)).look();
    for (const DeviceDescription& info : client->devices()) {
        auto device = std::make_unique<Device>();
        device->info = info;
        const auto row =
            std::find_if(seen.devices.begin(), seen.devices.end(),
                         [&](const view::DeviceView& each) { return info.name == each.info.name; });
        device->topics.emplace(domain, options, info.name, row == seen.devices.end() ? 0 : row->info.joints);
        device->commands = commands_of(*device);
        if (device->commands) device->state = "ENABLED";
        devices.push_back(std::move(device));
    }
    for (const CommandRule& rule : options.commands)
        if (std::none_of(devices.begin(), devices.end(),
                         [&](const auto& each) { return each->info.name == rule.device; })) {
            std::vector<std::string> names;
            for (const auto& each : devices) names.push_back(each->info.name);
            domain.say(fmt::format("device '{}', which may be commanded, is none of this servo's; {}",
                                   rule.device, protocol::instead_of_device(rule.device, names)));
        }
    servo = client->servo_pid();
    closing = false;
    for (auto& device : devices) device->writer = std::thread([this, raw = device.get()] { write_of(*raw); });
    commander = std::thread([this] { read_commands(); });
}

void RobotSide::Impl::close() {
    connected = false;
    closing = true;
    changed.notify_all();
    for (auto& device : devices)
        if (device->writer.joinable()) device->writer.join();
    if (commander.joinable()) commander.join();
    devices.clear();
    client.reset();
}

std::unique_ptr<DeviceCommands> RobotSide::Impl::commands_of(const Device& device) {
    for (const CommandRule& rule : options.commands) {
        if (rule.device != device.info.name) continue;
        CommandOptions desk;
        desk.servo = options.servo;
        desk.device = rule.device;
        desk.base_frame = messages::base_frame(rule.device);
        desk.tip_frame = messages::hand_frame(rule.device);
        desk.deadline = rule.deadline;
        desk.lifespan = rule.lifespan;
        desk.from = rule.from;
        desk.enabled = rule.enabled;
        desk.log = [this](const std::string& line) { domain.options().log(line); };
        return std::make_unique<DeviceCommands>(domain, options, rule, std::move(desk));
    }
    return nullptr;
}

void RobotSide::Impl::write_of(Device& device) {
    auto read = Clock::now();
    while (!closing) {
        if (const auto now = Clock::now(); device.topics->wanted(now)) {
            read = now;
        } else {
            if (now > read + linger) device.reports.reset();
            std::unique_lock lock(mutex);
            changed.wait_for(lock, idle_look, [this] { return closing.load(); });
            continue;
        }
        try {
            if (!device.reports) device.reports.emplace(client->observe(device.info.name));
            write_one(device);
        } catch (const Error&) {  // the servo is away
            std::unique_lock lock(mutex);
            changed.wait_for(lock, idle_look, [this] { return closing.load(); });
        }
    }
}

/// Sleeps on the servo's reports only where somebody reads as many of them: else on a clock of its own, which costs the
/// servo no wake-up.
void RobotSide::Impl::write_one(Device& device) {
    std::optional<Report> report;
    if (device.topics->highest_rate() >= 0.9 * device.info.rate) {
        if (const auto frame = device.reports->newest(50ms)) report = *frame;
    } else {
        std::this_thread::sleep_until(std::min(device.topics->next_due(), Clock::now() + idle_look));
        if (const auto latest = device.reports->latest())
            report = *latest;
        else
            std::this_thread::sleep_for(idle_look);
    }
    if (report) device.topics->write(Clock::now(), *report, word_of(*report, device.state));
}

/// Shows the desk the newest report, while somebody commands or may.
void RobotSide::Impl::look(Device& device) {
    if (Clock::now() > device.commanded + linger) {
        device.newest.reset();
        device.commands->desk().look_away();
        return;
    }
    try {
        if (!device.newest) {
            device.newest.emplace(client->observe(device.info.name));
            device.newest->newest(
                50ms);  // it has no report before the next cycle, and the first command needs one
        }
        if (const auto report = device.newest->latest()) device.commands->desk().look(*report);
    } catch (const Error&) {  // the servo is away: the last report counts
    }
}

void RobotSide::Impl::read_commands() {
    const Entity waitset(dds_create_waitset(domain.participant()), "waitset");
    const bool any = std::any_of(devices.begin(), devices.end(),
                                 [](const auto& each) { return each->commands != nullptr; });
    if (!any) return;
    for (auto& device : devices)
        if (device->commands) device->commands->attach(waitset.get());
    auto next_look = Clock::now();
    bool held = false;
    while (!closing) {
        const auto patience =
            std::chrono::nanoseconds(held ? std::chrono::nanoseconds(command_tick) : command_idle);
        const bool came = dds_waitset_wait(waitset.get(), nullptr, 0, patience.count()) > 0;
        held = false;
        const bool look_now = Clock::now() >= next_look;
        if (look_now) next_look = Clock::now() + gone_look;
        for (auto& device : devices) {
            if (!device->commands) continue;
            CommandDesk& desk = device->commands->desk();
            if (!desk.peers().empty() || ((came || look_now) && device->commands->anybody_there()))
                device->commanded = Clock::now();
            look(*device);
            device->commands->take();
            if (look_now) device->commands->look_for_gone();
            desk.tick();
            device->state = desk.state().data();
            held = held || !desk.peers().empty();
        }
    }
}

void RobotSide::Impl::describe(ServoEntry& servo) {
    servo.state = connected ? "running" : "gone";
    servo.devices.clear();
    if (!connected) {
        watch.reset();
        before.reset();
        return;
    }
    try {
        if (!watch) watch.emplace(protocol::servo_address(options.servo));
        view::ServoView now = watch->look();
        const auto reports = watch->new_reports();
        const auto then = std::exchange(looked, Clock::now());
        const bool moved = before && before->pid == now.pid && before->devices.size() == now.devices.size();
        for (std::size_t i = 0; i < now.devices.size(); ++i) {
            const view::DeviceView& device = now.devices[i];
            DeviceEntry entry{.name = device.info.name,
                              .profile = device.info.profile,
                              .state = std::string(view::state_name(view::state_of(device))),
                              .faults = view::fault_names(view::faults_of(device)),
                              .rate = device.info.rate,
                              .peak_force = device.info.peak_force,
                              .force = view::force_of(device),
                              .max_stiffness = device.info.max_stiffness,
                              .renders_torque = device.info.renders_torque != 0,
                              .senses_orientation = device.info.senses_orientation != 0,
                              .holders = static_cast<std::uint32_t>(std::count_if(
                                  device.clients.begin(), device.clients.end(),
                                  [](const view::ClientView& client) { return !client.observer; })),
                              .cycles = device.counters.at("cycles"),
                              .late_cycles = device.counters.at("late_cycles")};
            entry.commanded_by_dds =
                std::any_of(options.commands.begin(), options.commands.end(),
                            [&](const CommandRule& rule) { return rule.device == entry.name; });
            if (moved)
                entry.measured_rate =
                    view::rates_between(before->devices[i], device,
                                        std::chrono::duration<double>(looked - then).count(), reports[i])
                        .rate;
            servo.devices.push_back(std::move(entry));
        }
        // A servo that came in the place of another has other memory.
        const bool stands =
            moved && std::all_of(servo.devices.begin(), servo.devices.end(),
                                 [](const DeviceEntry& device) { return device.measured_rate == 0; });
        before = std::move(now);
        if (stands) watch.reset();
    } catch (const std::exception& error) {
        watch.reset();
        before.reset();
        domain.say(error.what());
    }
}

RobotSide::RobotSide(Domain& domain, RobotOptions options)
    : impl_(std::make_unique<Impl>(domain, std::move(options))) {}
RobotSide::~RobotSide() = default;

void RobotSide::describe(ServoEntry& servo) {
    impl_->describe(servo);
    impl_->diagnostics.write(servo);
}

}  // namespace knurl::dds
