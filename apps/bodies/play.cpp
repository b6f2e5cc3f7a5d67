#include "play.hpp"

#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include "simulation.hpp"

namespace bodies {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto patience = 10s;

void arm_when_slow(knurl::Claim& hand, const std::atomic<bool>& stop) {
    const auto begin = Clock::now();
    for (int slow = 0; slow < 100 && !stop;) {
        const auto report = hand.next_report(100ms);
        hand.commit();
        if (report) slow = knurl::to_eigen(report->velocity).norm() < 0.1 ? slow + 1 : 0;
        if (Clock::now() - begin > patience)
            throw std::runtime_error(
                "the hand does not come to rest, so the device is not armed; hold it still");
    }
    if (!stop) hand.arm();
}

std::vector<std::uint32_t> send_skins(knurl::Claim& hand, const World& world) {
    std::vector<std::uint32_t> assets;
    for (const Body& body : world.bodies()) {
        const Skin skin = skin_of(body);
        assets.push_back(hand.send({.vertices = skin.vertices, .triangles = skin.triangles}).asset);
    }
    return assets;
}

void add_tray(knurl::Claim& hand, const Tray& tray, double stiffness, std::size_t fingers) {
    for (std::uint32_t finger = 0; finger < fingers; ++finger) {
        const auto wall = [&](const knurl::Vec3& normal, double offset) {
            hand.add(knurl::Plane{.normal = normal, .offset = offset, .stiffness = stiffness},
                     {.probe = finger});
        };
        wall({0, 0, 1}, tray.floor);
        for (const double side : {1.0, -1.0}) {
            wall({side, 0, 0}, -tray.reach);
            wall({0, side, 0}, -tray.reach);
        }
    }
}

/// When it is to take and to let go: by the script, or by the device's first button.
class Grip {
  public:
    explicit Grip(const Script* script) : script_(script) {}
    std::optional<bool> changes(const knurl::Report& report, double t) {
        if (!script_) {
            const bool pressed = report.buttons & 1;
            if (pressed == pressed_) return {};
            return pressed_ = pressed;
        }
        if (event_ == script_->events().size() || t < script_->events()[event_].t) return {};
        return script_->events()[event_++].take;
    }

  private:
    const Script* script_;
    std::size_t event_ = 0;
    bool pressed_ = false;
};

}  // namespace

Played play(knurl::Client& client, World& world, const PlayOptions& options, const std::atomic<bool>& stop,
            const std::function<void(const std::string&)>& told) {
    const double dt = 1 / options.rate;
    knurl::Claim hand = client.claim(
        options.device, {.update_interval = std::chrono::nanoseconds(static_cast<std::int64_t>(dt * 1e9))});
    Coupled<knurl::Claim> coupled(hand, world, send_skins(hand, world), options.coupled);
    for (std::uint32_t i = 0; i < options.coupled.fingers.size(); ++i)
        hand.place_probe(i, {.offset = knurl::to_plain(options.coupled.fingers[i]), .radius = 0});
    add_tray(hand, world.tray(), options.coupled.touch.stiffness, options.coupled.fingers.size());
    arm_when_slow(hand, stop);

    Played played;
    Grip grip(options.script);
    const double period = 1 / hand.device().rate, energy = world.energy();
    double first = -1, due = 0, shown = 0, interval = dt;
    std::uint64_t last = 0;
    bool stepping = false, waited = false, said_slow = false;
    Simulation simulation(world, options.slow);
    while (!stop) {
        const auto report = hand.next_report(50ms);
        if (!report) {
            if (!hand.connected()) throw std::runtime_error("the servo has gone; start it again");
            continue;
        }
        const double now = static_cast<double>(report->deadline_ns) * 1e-9;
        if (report->state == knurl::DeviceState::active && first < 0) first = now;
        const std::uint64_t cycles = last > 0 ? report->cycle - last : 1;
        last = report->cycle;
        // What goes between the hand and the simulation.
        coupled.feel(*report, static_cast<double>(cycles) * period);
        if (stepping && simulation.done()) {
            stepping = false;
            if (shown > 0)
                interval = std::max(dt, 0.8 * interval + 0.2 * std::min(now - shown, 4 * interval));
            coupled.show(world, interval, now);
            shown = now;
            hand.commit();
            played.frames.push_back({.t = now - first,
                                     .bodies = {},
                                     .gained = world.energy() - energy,
                                     .hand = coupled.account().hand});
            for (std::size_t i = 0; i < world.bodies().size(); ++i)
                played.frames.back().bodies.push_back(world.after(i).position);
        }
        if (!stepping) {
            if (const auto take = grip.changes(*report, first < 0 ? -1 : now - first)) {
                if (!*take)
                    coupled.let_go(now);
                else if (!coupled.take(world))
                    told("there is nothing within reach to take");
            }
            if (now >= due) {
                due = std::max(due + dt, now);
                simulation.begin(dt, coupled.orders(world, dt, interval));
                stepping = true;
            }
        }
        const bool waits = shown > 0 && now - shown > 1.5 * interval;
        played.late += waits && !waited;
        waited = waits;
        if (waits) {
            coupled.wait(now);
            hand.commit();
        }
        if (interval > 1.2 * dt && !said_slow) {
            said_slow = true;
            told(
                fmt::format("the simulation is slower than real time: its frames of {:.1f} ms take longer, "
                            "and are felt as "
                            "slow as they are",
                            dt * 1e3));
        }
        if (first < 0) continue;
        played.faults = report->faults;
        const Vector3d force = knurl::to_eigen(report->scene_force);
        if (cycles == 1 && !played.cycles.empty())
            played.jump = std::max(played.jump, (force - played.cycles.back().force).norm());
        played.cycles.push_back({now - first, knurl::to_eigen(report->position), force});
        if (report->faults != 0 || (options.seconds > 0 && now - first > options.seconds)) break;
    }
    played.account = coupled.account();
    played.unread = hand.missed();
    hand.release();
    return played;
}

}  // namespace bodies
