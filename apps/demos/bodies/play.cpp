#include "play.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/measure/grip.hpp>

#include "simulation.hpp"

namespace bodies {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto patience = 10s;
constexpr double faded = 0.4;  // s after which a released body has no force any more

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

/// An application's life: one loop, in which the simulation's steps are begun and ended.
class Play {
  public:
    Play(knurl::Client& client, World& world, const PlayOptions& options,
         const std::function<void(const std::string&)>& told)
        : options_(options),
          told_(told),
          world_(world),
          hand_(client.claim(options.device, {.update_interval = std::chrono::nanoseconds(
                                                  static_cast<std::int64_t>(dt_ * 1e9))})),
          coupled_(hand_, world, send_skins(hand_, world), options.coupled, dt_) {
        for (std::uint32_t i = 0; i < options.coupled.fingers.size(); ++i)
            hand_.place_probe(i, {.offset = knurl::to_plain(options.coupled.fingers[i]), .radius = 0});
        add_tray(hand_, world.tray(), options.coupled.touch.stiffness, options.coupled.fingers.size());
    }

    Played run(const std::atomic<bool>& stop, const std::function<char()>& key) {
        arm_when_slow(hand_, stop);
        energy_ = world_.energy();
        Simulation simulation(world_, options_.slow);
        while (!stop) {
            const auto report = hand_.next_report(50ms);
            if (!report) {
                if (!hand_.connected()) throw std::runtime_error("the servo has gone; start it again");
                continue;
            }
            now_ = static_cast<double>(report->deadline_ns) * 1e-9;
            if (report->state == knurl::DeviceState::active && first_ < 0) first_ = now_;
            feel(*report);
            if (stepping_ && simulation.done()) show();
            const char pressed = key();
            if (pressed == 'q') break;
            reset_ |= pressed == 'r';
            grip(report->buttons, pressed);
            if (!stepping_ && now_ >= due_ && !world_.lost()) begin(simulation);
            watch();
            require_bodies();
            if (first_ >= 0 && !record(*report)) break;
        }
        return finish();
    }

  private:
    void feel(const knurl::Report& report) {
        cycles_ = last_ > 0 ? report.cycle - last_ : 1;
        last_ = report.cycle;
        coupled_.feel(report, static_cast<double>(cycles_) / hand_.device().rate);
    }

    void show() {
        stepping_ = false;
        coupled_.show(world_, now_);
        hand_.commit();
        Played::Frame frame{.t = now_ - first_,
                            .bodies = {},
                            .gained = world_.energy() - energy_,
                            .hand = coupled_.account().hand};
        for (std::size_t i = 0; i < world_.bodies().size(); ++i)
            frame.bodies.push_back(world_.after(i).position);
        played_.frames.push_back(std::move(frame));
    }

    /// The world is read and changed only between its steps.
    void begin(Simulation& simulation) {
        if (reset_) energy_ += world_.reset();
        reset_ = false;
        if (take_) take();
        if (options_.lose_at > 0 && first_ >= 0 && now_ - first_ > options_.lose_at)
            world_.kick(coupled_.held().value_or(0), Vector3d::Constant(NAN));
        due_ = std::max(due_ + dt_, now_);
        simulation.begin(dt_, coupled_.orders(world_, now_));
        stepping_ = true;
    }

    /// A body with an invalid place was released when its frame was shown, and no frame follows.
    void require_bodies() {
        if (stepping_ || !world_.lost()) return;
        if (lost_ < 0) lost_ = now_;
        if (now_ - lost_ < faded) return;
        throw std::runtime_error(fmt::format(
            "the engine has lost the {}: its place is not a number; the hand let go of everything. "
            "Start again, with "
            "less stiffness (--stiffness, --spring) or more frames (--rate)",
            world_.bodies()[*world_.lost()].name));
    }

    void watch() {
        const auto frames = coupled_.watch(now_);
        if (frames != Frames::on_time) hand_.commit();
        if (frames != frames_) {
            played_.late += frames == Frames::late;
            if (frames == Frames::stopped) told_("the simulation has stopped: all rests where it is");
            if (frames_ == Frames::stopped) told_("the simulation goes on");
        }
        frames_ = frames;
        if (holds_ && !coupled_.held()) told_(fmt::format("the {} has slipped out of the hand", *holds_));
        if (!coupled_.held()) holds_.reset();
        if (said_slow_ || coupled_.interval() < 1.2 * dt_) return;
        said_slow_ = true;
        told_(fmt::format(
            "the simulation is slower than real time: its frames of {:.1f} ms take longer, and are felt as "
            "slow as they are",
            dt_ * 1e3));
    }

    void grip(std::uint32_t buttons, char key) {
        const double t = first_ < 0 ? -1 : now_ - first_;
        const auto changes = options_.script ? scripted(t) : wished(buttons, key);
        if (!changes) return;
        take_ = *changes;
        if (take_ || !coupled_.held()) return;
        coupled_.let_go(now_);
        told_(fmt::format("lets go of the {}", *holds_));
        holds_.reset();
    }
    std::optional<bool> scripted(double t) {
        const auto& events = options_.script->events();
        if (event_ == events.size() || t < events[event_].t) return {};
        return events[event_++].take;
    }
    std::optional<bool> wished(std::uint32_t buttons, char key) {
        const auto by_button = grip_.button(buttons);
        return by_button ? by_button : grip_.key(key, take_ || coupled_.held());
    }
    void take() {
        take_ = false;
        if (coupled_.held()) return;
        if (!coupled_.take(world_, now_)) return told_("there is nothing within reach to take");
        hand_.commit();
        holds_ = world_.bodies()[*coupled_.held()].name;
        told_(fmt::format("holds the {}", *holds_));
    }

    bool record(const knurl::HandReport& report) {
        played_.faults = report.faults;
        const Vector3d force = knurl::to_eigen(report.scene_force);
        if (cycles_ == 1 && !played_.cycles.empty())
            played_.jump = std::max(played_.jump, (force - played_.cycles.back().force).norm());
        played_.torque = std::max(played_.torque, knurl::to_eigen(report.sent_torque).norm());
        played_.cycles.push_back({now_ - first_, knurl::to_eigen(report.position), force});
        return report.faults == 0 && !(options_.seconds > 0 && now_ - first_ > options_.seconds);
    }

    Played finish() {
        played_.account = coupled_.account();
        played_.pushed = coupled_.pushed();
        played_.short_of = coupled_.short_of();
        played_.jumps = coupled_.jumps();
        played_.unread = hand_.missed();
        hand_.release();
        return std::move(played_);
    }

    using Frames = Coupled<knurl::Claim>::Frames;

    const PlayOptions& options_;
    const std::function<void(const std::string&)>& told_;
    World& world_;
    const double dt_ = 1 / options_.rate;
    knurl::Claim hand_;
    Coupled<knurl::Claim> coupled_;
    Played played_;
    knurl::measure::Grip grip_;
    Frames frames_ = Frames::on_time;
    double now_ = 0, first_ = -1, lost_ = -1, due_ = 0, energy_ = 0;
    std::uint64_t last_ = 0, cycles_ = 1;
    std::size_t event_ = 0;
    bool stepping_ = false, take_ = false, reset_ = false, said_slow_ = false;
    std::optional<std::string> holds_;
};

}  // namespace

Played play(knurl::Client& client, World& world, const PlayOptions& options, const std::atomic<bool>& stop,
            const std::function<void(const std::string&)>& told, const std::function<char()>& key) {
    return Play(client, world, options, told).run(stop, key);
}

}  // namespace bodies
