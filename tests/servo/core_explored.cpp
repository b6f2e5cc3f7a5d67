// Every sequence of events that leads to something new, up to a length: the states of the device, of two claims
// and of the guardian, explored over the real servo. A servo cannot be copied, so each sequence runs from the
// start. A monitor that knows only what was asked and what reached the device judges each cycle. Wrong twins, in
// which one message is lost or made up, must be found.
//
// KNURL_LONG: longer sequences.

#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <knurl/reps/plane.hpp>

#include "core_support.hpp"

namespace knurl::servo::core_explored_tests {
namespace {

using namespace testing;
using protocol::RefusalReason;

constexpr Nanoseconds period = 1'000'000;
constexpr int ramp_cycles = 2;  // of device and claims

enum class Event : std::uint8_t {
    tick,
    arm_a,
    disarm_a,
    arm_b,
    disarm_b,
    reset,       // by B
    a_dies,      // the death watch sees it
    a_released,  // the broker does, or A gives its claim back
    unplug,      // and plugs in again
    guardian_acts,
    guardian_stands_still,  // and goes on
    clock_jumps,
    stall,
    hand_fast,  // and slow again
    count,
};
constexpr std::array<const char*, static_cast<std::size_t>(Event::count)> names{
    "tick",     "arm A",  "disarm A",      "arm B",          "disarm B",    "reset", "A dies",
    "A leaves", "unplug", "guardian acts", "guardian still", "clock jumps", "stall", "fast hand"};

/// What a wrong twin does wrong.
enum class Wrong {
    nothing,
    deaths_lost,
    releases_lost,
    still_lost,
    acts_lost,
    reset_arms,
    arms_by_itself,
    deaf_device
};

/// Names it in the list of tests.
void PrintTo(Wrong wrong, std::ostream* out) {
    constexpr std::array words{"nothing",   "deaths_lost", "releases_lost",  "still_lost",
                               "acts_lost", "reset_arms",  "arms_by_itself", "deaf_device"};
    *out << words[static_cast<std::size_t>(wrong)];
}

struct Client {
    OfflineMemory memory;
    OfflineClaim claim;
    bool gone = false, dead = false;
    bool may = false;  // it was armed, and nothing has taken that back
    explicit Client(const ClaimTerms& terms)
        : memory(protocol::claim_layout(terms.capacity).total), claim(terms, memory.data(), nullptr) {}
};

class World {
  public:
    explicit World(Wrong wrong) : wrong_(wrong) {
        device_.tip = {0, 0, -1e-3};
        ClaimTerms terms;
        terms.capacity = {.representations = 1, .batch_bytes = 512};
        terms.frame = frame_for(device_.link(), {});
        terms.limits = limits_for(device_.link(), 1000, terms.frame);
        terms.shared = true;
        for (auto& client : clients_) {
            client = std::make_unique<Client>(terms);
            servo_.adopt(&client->claim.servo_side());
            client->claim.add(Plane{.stiffness = 500, .recovery = 0});
        }
        for (int i = 0; i < 3; ++i) cycle(period);
    }

    /// What is wrong with the cycle of this event; empty: nothing.
    std::string happen(Event event) {
        const DeviceState before = state();
        was_reset_ = jumped_ = acted_ = false;
        Nanoseconds gap = period;
        switch (event) {
            case Event::arm_a:
                arm(a());
                break;
            case Event::arm_b:
                arm(b());
                break;
            case Event::disarm_a:
                disarm(a());
                break;
            case Event::disarm_b:
                disarm(b());
                break;
            case Event::reset:
                b().claim.reset_fault();
                resets_ = true;
                if (wrong_ == Wrong::reset_arms) b().claim.arm();
                break;
            case Event::a_dies:
                if (a().gone || a().dead) break;
                a().dead = true;
                a().may = false;
                if (wrong_ != Wrong::deaths_lost) servo_.abandon(&a().claim.servo_side());
                break;
            case Event::a_released:
                if (a().gone) break;
                a().gone = true;
                a().may = false;
                if (wrong_ != Wrong::releases_lost) servo_.drop(&a().claim.servo_side());
                break;
            case Event::unplug:
                unplugged_ = !unplugged_;
                device_.status = unplugged_ ? drivers::ReadStatus::unplugged : drivers::ReadStatus::ok;
                break;
            case Event::guardian_acts:
                acted_ = true;
                if (wrong_ != Wrong::acts_lost) servo_.guardian_acted();
                break;
            case Event::guardian_stands_still:
                still_ = !still_;
                if (wrong_ != Wrong::still_lost) servo_.guardian_is_still(still_);
                break;
            case Event::clock_jumps:
                jumped_ = true;
                servo_.clock_jumped();
                break;
            case Event::stall:
                gap = 25 * period;
                break;
            case Event::hand_fast:
                fast_ = !fast_;
                device_.has_velocity = true;
                device_.velocity = {fast_ ? 2.0 : 0.0, 0, 0};
                break;
            default:
                break;
        }
        if (wrong_ == Wrong::arms_by_itself && state() == DeviceState::idle && !b().gone) b().claim.arm();
        cycle(gap);
        return judged(before);
    }

    /// The events after which the device is on again, whatever was before.
    std::string recovers() {
        if (unplugged_) happen(Event::unplug);
        if (still_) happen(Event::guardian_stands_still);
        if (fast_) happen(Event::hand_fast);
        // The filter of the velocity and the ramps need some cycles.
        for (int i = 0; i < 100; ++i) cycle(period);
        if (state() == DeviceState::fault) happen(Event::reset);
        happen(Event::arm_b);
        for (int i = 0; i < 4 * ramp_cycles; ++i) cycle(period);
        return state() == DeviceState::active && force() > 0.49 ? "" : "B cannot switch it on again";
    }

    /// What tells one place in the exploration from another.
    std::string key(Event last) const {
        std::string key;
        const Report& report = servo_.last();
        for (const double part :
             {static_cast<double>(report.state), static_cast<double>(report.faults),
              std::round(in_effect_.z() * 1e6), static_cast<double>(since_may_), static_cast<double>(last)})
            key += std::to_string(static_cast<long>(part)) + ' ';
        for (const auto& client : clients_)
            key += {client->gone ? 'g' : '-', client->dead ? 'd' : '-', client->may ? 'm' : '-'};
        return key + (unplugged_ ? 'u' : '-') + (still_ ? 's' : '-') + (fast_ ? 'f' : '-');
    }

    DeviceState state() const { return servo_.last().state; }
    double force() const { return in_effect_.norm(); }

  private:
    Client& a() { return *clients_[0]; }
    Client& b() { return *clients_[1]; }

    void arm(Client& client) {
        if (client.gone || client.dead) return;
        client.claim.arm();
        arming_ = &client;
    }
    void disarm(Client& client) {
        if (client.gone || client.dead) return;
        client.claim.disarm();
        client.may = false;
    }

    void cycle(Nanoseconds gap) {
        clock_.time += gap;
        servo_.step(clock_.time, clock_.time);
        servo_.took(period / 10);
        if (wrong_ != Wrong::deaf_device || !device_.force().isZero(0)) in_effect_ = device_.force();
        if (unplugged_) in_effect_.setZero();  // it hears nothing, and has no power
        for (const auto& client : clients_) {
            for (const protocol::Reply& reply : client->claim.replies()) {
                const bool taken =
                    static_cast<RefusalReason>(reply.reason) == RefusalReason::none && reply.code == 0;
                if (client.get() == arming_ && taken) client->may = true;
                if (client.get() == clients_[1].get() && resets_ && taken) was_reset_ = true;
            }
        }
        arming_ = nullptr;
        resets_ = false;
        while (servo_.released() != nullptr) {
        }
        // Armed claims are so until the device is off.
        const bool off = state() == DeviceState::idle || state() == DeviceState::fault ||
                         state() == DeviceState::disconnected;
        if (off)
            for (const auto& client : clients_) client->may = false;
        since_may_ = a().may || b().may ? 0 : std::min(since_may_ + 1, ramp_cycles + 2);
        since_still_ = still_ ? std::min(since_still_ + 1, ramp_cycles + 3) : 0;
    }

    std::string judged(DeviceState before) const {
        const DeviceState now = state();
        const bool powered =
            now == DeviceState::ramp_up || now == DeviceState::active || now == DeviceState::ramp_down;
        if (force() > 0 && !powered) return "force in a state without";
        if (force() > 0 && since_may_ > ramp_cycles + 1) return "force that nobody has armed, or no longer";
        if (force() > 0 && since_still_ > ramp_cycles + 2) return "force without a guardian";
        if (acted_ && force() > 1.0 / ramp_cycles + 1e-9) return "the old force after the guardian has acted";
        if (jumped_ && force() > 0) return "force over a jump of the clock";
        if (unplugged_ && powered) return "an unplugged device is on";
        if (before == DeviceState::fault && now != DeviceState::fault && now != DeviceState::disconnected &&
            !was_reset_ && (servo_.last().faults != 0 || now != DeviceState::idle))
            return "a fault ends without a reset";
        if (force() > 1.0 + 1e-9) return "more force than the planes'";
        return "";
    }

    struct FixedClock final : Clock {
        Nanoseconds time = 1'000'000'000;
        Nanoseconds now() noexcept override { return time; }
    };

    static std::byte* reports() {
        static const OfflineMemory memory(protocol::device_layout().total);
        return memory.data();
    }
    static ServoOptions options() {
        ServoOptions options = live_options();
        options.silence = false;
        options.supervisor.ramp_up = options.supervisor.ramp_down = options.supervisor.claim_ramp =
            ramp_cycles * 1e-3;
        return options;
    }

    Wrong wrong_;
    PuppetDevice device_;
    Eigen::Vector3d in_effect_ = Eigen::Vector3d::Zero();  // of a deaf device not what it was told last
    FixedClock clock_;
    std::array<std::unique_ptr<Client>, 2> clients_;
    Servo servo_{device_, clock_, reports(), options()};
    const Client* arming_ = nullptr;
    bool resets_ = false, was_reset_ = false, jumped_ = false, acted_ = false;
    bool unplugged_ = false, still_ = false, fast_ = false;
    int since_may_ = 0, since_still_ = 0;
};

#if defined(__SANITIZE_THREAD__)
constexpr bool worth_it = false;  // there is one thread, and each new world costs this sanitizer milliseconds
#else
constexpr bool worth_it = true;
#endif

struct Explored {
    std::size_t places = 0, sequences = 0;
    std::string wrong;  // with the events that lead there
};

Explored explore(Wrong wrong, std::size_t length) {
    Explored result;
    std::set<std::string> seen;
    std::deque<std::vector<Event>> open{{}};
    while (!open.empty()) {
        const std::vector<Event> path = open.front();
        open.pop_front();
        for (std::uint8_t e = 0; e < static_cast<std::uint8_t>(Event::count); ++e) {
            const auto event = static_cast<Event>(e);
            World world(wrong);
            for (const Event earlier : path) world.happen(earlier);
            std::string what = world.happen(event);
            ++result.sequences;
            const bool fresh = seen.insert(world.key(event)).second;
            if (fresh && path.size() + 1 < length) {
                open.push_back(path);
                open.back().push_back(event);
            }
            if (what.empty() && fresh && wrong == Wrong::nothing) what = world.recovers();
            if (what.empty()) continue;
            for (const Event earlier : path)
                result.wrong += std::string(names[static_cast<std::size_t>(earlier)]) + ", ";
            result.wrong += std::string(names[e]) + ": " + what;
            result.places = seen.size();
            return result;
        }
    }
    result.places = seen.size();
    return result;
}

TEST(Explored, NoSequenceOfEventsLeavesAForceOnThatShouldEndNorADeviceThatCannotBeSwitchedOn) {
    if (!worth_it) GTEST_SKIP() << "nothing for ThreadSanitizer to find";
    const std::size_t length = std::getenv("KNURL_LONG") != nullptr ? 40 : 6;
    const Explored all = explore(Wrong::nothing, length);
    std::cout << all.places << " places by " << all.sequences << " sequences of up to " << length
              << " events\n";
    EXPECT_EQ(all.wrong, "");
    EXPECT_GT(all.places, 1000u);
}

class WrongTwin : public ::testing::TestWithParam<Wrong> {};
INSTANTIATE_TEST_SUITE_P(Each, WrongTwin,
                         ::testing::Values(Wrong::deaths_lost, Wrong::releases_lost, Wrong::still_lost,
                                           Wrong::acts_lost, Wrong::reset_arms, Wrong::arms_by_itself,
                                           Wrong::deaf_device));

TEST_P(WrongTwin, IsFound) {
    if (!worth_it) GTEST_SKIP() << "nothing for ThreadSanitizer to find";
    const Explored all = explore(GetParam(), 9);
    EXPECT_NE(all.wrong, "") << all.places << " places";
    std::cout << all.wrong << '\n';
}

}  // namespace
}  // namespace knurl::servo::core_explored_tests
