#include "dock.hpp"

#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <knurl/measure/grip.hpp>

#include "pull_bound.hpp"

namespace dock {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;

constexpr int most_at_once = 64;                    // frames
constexpr std::size_t most_cycles = 3'600'000;      // an hour's
constexpr auto patience = 15s;                      // for a first frame, a hand at rest, and an active device
constexpr double pn_per_kcal_per_angstrom = 69.48;  // 1 kcal/mol/A in pN
constexpr double longest_look = 5e-3;               // s between two looks
constexpr double cooled = 0.95;                     // share of the largest temperature below which the atom
                                                    // is pulled again

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Removes the jumps of an atom that leaves a periodic box on one side and re-enters on the other.
class Unwrapped {
  public:
    explicit Unwrapped(double box) : box_(box) {}
    Vector3d operator()(const Eigen::Vector3f& atom) {
        Vector3d at = atom.cast<double>();
        if (box_ > 0 && last_)
            for (int i = 0; i < 3; ++i) at[i] -= box_ * std::round((at[i] - (*last_)[i]) / box_);
        last_ = at;
        return at;
    }
    void forget() { last_.reset(); }

  private:
    double box_;  // A
    std::optional<Vector3d> last_;
};

/// Computes the steps between frames, at the engine's present speed.
class Pace {
  public:
    Pace(Imd& simulation, double rate) : simulation_(simulation), rate_(rate) { set(steps_); }
    void frame(std::int64_t step, double now) {
        if (step < 0) return;
        if (first_step_ < 0 || step < first_step_) {
            first_step_ = step;
            first_time_ = now;
        }
        if (now - first_time_ < 0.5 || step == first_step_) return;
        steps_per_second = static_cast<double>(step - first_step_) / (now - first_time_);
        first_step_ = step;
        first_time_ = now;
        const int wanted = static_cast<int>(std::clamp(std::round(steps_per_second / rate_), 1.0, 1e6));
        if (std::abs(wanted - steps_) > 0.1 * steps_) set(wanted);
    }
    int steps() const { return steps_; }
    double steps_per_second = 0;

  private:
    void set(int steps) { simulation_.set_rate(steps_ = steps); }

    Imd& simulation_;
    double rate_;
    int steps_ = 10;
    std::int64_t first_step_ = -1;
    double first_time_ = 0;
};

class Session {
  public:
    Session(knurl::Client& client, Imd& simulation, const DockOptions& options, const std::atomic<bool>& stop,
            const std::function<char()>& key)
        : simulation_(simulation),
          options_(options),
          stop_(stop),
          key_(key),
          pace_(simulation, options.rate),
          unwrapped_(10 * options.box),
          pull_bound_(options.greatest_temperature,
                      options.box > 0 ? 10 * options.box : std::numeric_limits<double>::infinity()),
          coupling_({.scale = scale_of(options),
                     .stiffness = options.stiffness,
                     .interval = 1 / options.rate,
                     .frames_late = 1,  // the answer to a frame is read with the next one
                     .greatest_force = options.greatest_force,
                     .keep_account = options.keep_account}),
          hand_(client.claim(options.device, {.shared = options.share, .update_interval = 10ms})),
          spring_(hand_.add(coupling_.spring())) {}

    Docked run(const std::function<void(const std::string&)>& told) {
        get_ready();
        double told_at = 0;
        if (!stop_ && options_.at_once) take();
        while (!over()) {
            feel();
            if (simulation_.let_go_meanwhile()) was_stopped();
            take_frames();
            watch();
            spring_.set(coupling_.spring());
            hand_.commit();
            if (now_ >= told_at + 1) {
                told_at = now_;
                told(line());
            }
        }
        return finish();
    }

  private:
    // The whole coupling: input, answer, supervision.
    void feel() {
        auto report = hand_.next_report(1ms);
        // A fade continues while this process is stopped, but the simulation does not count as late then.
        const double looked = seconds_since(started_);
        own_time_ += std::min(looked - looked_, longest_look);
        looked_ = looked;
        for (; report; report = hand_.next_report(0ms)) {
            report_ = *report;
            now_ = static_cast<double>(report->deadline_ns - begin_) * 1e-9;
            const auto feedback = spring_.feedback();
            coupling_.feel(*report, feedback);
            record(*report, feedback);
        }
        // By the newest report: an older one has an outdated place of the hand.
        grip(grip_.button(report_.buttons));
    }

    /// At most so many at a time: a simulation that floods must not stop everything else.
    void take_frames() {
        auto frame = simulation_.next();
        for (int n = 1; frame; ++n) {
            auto next = n < most_at_once ? simulation_.next() : std::nullopt;
            answer(*frame, !next);
            frame = std::move(next);
        }
    }

    void answer(const ImdFrame& frame, bool newest) {
        see(frame);
        if (!holds()) return;
        const Vector3d place = unwrapped_(frame.atoms[static_cast<std::size_t>(docked_.atom)]);
        if (!newest) return coupling_.superseded(knurl::to_plain(place));
        // An atom that the hand makes too hot is not pulled until the bath has cooled it.
        if (frame.energies)  // NaN counts as too hot
            hot_ = !(frame.energies->temperature <= (hot_ ? cooled : 1) * options_.greatest_temperature);
        docked_.hot += hot_;
        coupling_.bound(hot_ ? 0 : std::min(options_.greatest_force, most_force(frame)));
        push_ = knurl::to_eigen(coupling_.frame(knurl::to_plain(place), clock()));
        simulation_.pull(static_cast<std::int32_t>(docked_.atom), push_);
        atom_ = knurl::to_eigen(coupling_.to_hand(knurl::to_plain(place)));
    }

    double most_force(const ImdFrame& frame) {
        return pull_bound_.force(
            {.temperature =
                 frame.energies ? frame.energies->temperature : std::numeric_limits<double>::quiet_NaN(),
             .atoms = frame.atoms.size(),
             .steps = pace_.steps(),
             .way = coupling_.compliance() * scale_of(options_).force / scale_of(options_).length,
             .pushed = push_.norm()});
    }

    void watch() {
        const auto before = coupling_.state(), state = coupling_.watch(clock());
        if (state == knurl::Coupling::State::stopped && before != state) {
            simulation_.let_go();
            push_.setZero();
        }
    }

    void grip(std::optional<bool> changes) {
        if (changes) *changes ? take() : release();
    }

    bool holds() const { return coupling_.state() != knurl::Coupling::State::idle; }

    void take() {
        if (holds()) return;
        const Vector3d hand = knurl::to_eigen(report_.position);
        if (options_.atom >= 0) {
            docked_.atom = options_.atom;
        } else {
            // The middle of all atoms is put at the middle of the hand's workspace.
            const Vector3d wanted = middle_ + (hand - centre()) / scale_of(options_).length;
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < newest_.atoms.size(); ++i) {
                const double away = (newest_.atoms[i].cast<double>() - wanted).norm();
                if (away < nearest) nearest = away, docked_.atom = static_cast<long>(i);
            }
        }
        pull_bound_.hold();
        unwrapped_.forget();
        const Vector3d place = unwrapped_(newest_.atoms[static_cast<std::size_t>(docked_.atom)]);
        coupling_.hold(knurl::to_plain(place), report_.position);
        atom_ = hand;
    }

    void release() {
        if (!holds()) return;
        coupling_.let_go(clock());
        simulation_.let_go();
        push_.setZero();
    }

    void see(const ImdFrame& frame) {
        newest_ = frame;
        ++frames_;
        Eigen::AlignedBox3f box;
        for (const auto& atom : frame.atoms) box.extend(atom);
        middle_ = box.center().cast<double>();
        const std::int64_t step = frame.energies ? frame.energies->step : -1;
        pace_.frame(step, seconds_since(started_));
        if (!holds()) return;
        docked_.frames.push_back({.t = now_,
                                  .step = step,
                                  .temperature = frame.energies ? frame.energies->temperature : 0,
                                  .total_energy = frame.energies ? frame.energies->total : 0,
                                  .account = coupling_.account()});
    }

    void record(const knurl::HandReport& report, const std::optional<knurl::HandFeedback>& feedback) {
        docked_.faults |= report.faults;
        if (report.state != knurl::DeviceState::active) return;
        // The report has the sum of all claims on the device. The spring's own force comes from the feedback
        // of the newest cycle.
        const bool told = !options_.share || (feedback && feedback->cycle == report.cycle);
        if (told)
            own_ = options_.share ? feedback->share * knurl::to_eigen(feedback->force)
                                  : knurl::to_eigen(report.scene_force);
        if (docked_.cycles.size() < most_cycles)
            docked_.cycles.push_back({.number = report.cycle,
                                      .t = now_,
                                      .on_time = report.read_ns - read_ns_ < 1'500'000,
                                      .told = told,
                                      .hand = knurl::to_eigen(report.position),
                                      .force = own_,
                                      .atom = atom_,
                                      .atom_force = push_,
                                      .frame = holds() ? frames_ : 0});
        read_ns_ = report.read_ns;
    }

    void get_ready() {
        const auto begin = Clock::now();
        wait_for_frame(begin + patience);
        wait_for_rest(begin + 2 * patience);
        hand_.arm();
        wait_until_active(begin + 3 * patience);
    }

    void wait_for_frame(Clock::time_point limit) {
        while (!stop_ && newest_.atoms.empty()) {
            simulation_.wait(20ms);
            if (auto frame = simulation_.next()) see(*frame);
            hand_.commit();
            if (simulation_.ended()) throw ImdError("the simulation ended before its first frame");
            if (Clock::now() > limit)
                throw ImdError("the simulation sends no frame; is it paused, or has it no IMD-group?");
        }
        if (options_.atom >= static_cast<long>(newest_.atoms.size()))
            throw ImdError(fmt::format("there is no atom {}: the simulation sends {}, counted from 0",
                                       options_.atom, newest_.atoms.size()));
        docked_.atoms = newest_.atoms.size();
    }

    void wait_for_rest(Clock::time_point limit) {
        hand_.latest();  // earlier reports are out of date
        for (int slow = 0; slow < 100 && !stop_;) {
            const auto report = hand_.next_report(100ms);
            keep_up();
            if (report) slow = knurl::to_eigen(report->velocity).norm() < 0.1 ? slow + 1 : 0;
            if (Clock::now() > limit)
                throw std::runtime_error(
                    "the hand does not come to rest, so the device is not armed; hold it still");
        }
    }

    void wait_until_active(Clock::time_point limit) {
        while (!stop_) {
            // A shared device may have been active for long.
            auto report = hand_.next_report(100ms);
            if (const auto newest = hand_.latest()) report = newest;
            keep_up();
            if (report && report->state == knurl::DeviceState::active) {
                begin_ = report->deadline_ns;
                report_ = *report;
                return;
            }
            if (Clock::now() > limit)
                throw std::runtime_error(
                    "the device did not become active; look at `knurl devices` and the servo's log");
        }
    }

    void keep_up() {
        hand_.commit();
        while (auto frame = simulation_.next()) see(*frame);
    }

    bool over() {
        const char key = key_();
        if (key == 'q') return true;
        grip(grip_.key(key, holds()));
        if (simulation_.ended()) docked_.ended = "the simulation has ended";
        if (!hand_.connected()) docked_.ended = "the servo has gone";
        if (docked_.faults != 0)
            docked_.ended = fmt::format("the device faulted (mask {:#x})", docked_.faults);
        return stop_ || !docked_.ended.empty() || (options_.seconds > 0 && now_ >= options_.seconds);
    }

    Docked finish() {
        docked_.account = coupling_.account();
        release();
        docked_.steps_per_second = pace_.steps_per_second;
        docked_.steps_per_frame = pace_.steps();
        docked_.swapped = simulation_.swapped();
        docked_.counts = coupling_.counts();
        docked_.compliance = coupling_.compliance();
        docked_.energy_scale = coupling_.energy_scale();
        docked_.unread = hand_.missed();
        docked_.late = report_.late_count;
        if (hand_.connected()) hand_.release();
        return std::move(docked_);
    }

    /// The atom was released, and the hand did not cause what happened since then.
    void was_stopped() {
        ++docked_.stopped;
        const bool held = holds();
        release();
        if (held && options_.at_once) take();
    }

    Vector3d centre() const { return knurl::to_eigen(hand_.device().workspace_centre); }
    double clock() const { return own_time_; }

    std::string line() const {
        const char* state[] = {"free", "held", "held; the simulation is late",
                               "the simulation has stopped: let go"};
        return fmt::format("{:5.0f} s  {:5.2f} N  {:4.1f} mm  {:4.0f} frames/s  {:3.0f} K{}  atom {} {}",
                           now_, own_.norm(),
                           holds() ? (atom_ - knurl::to_eigen(report_.position)).norm() * 1e3 : 0.0,
                           1 / coupling_.interval(), newest_.energies ? newest_.energies->temperature : 0.0F,
                           hot_ ? " too hot" : "", docked_.atom, state[static_cast<int>(coupling_.state())]);
    }

    Imd& simulation_;
    const DockOptions& options_;
    const std::atomic<bool>& stop_;
    const std::function<char()>& key_;
    const Clock::time_point started_ = Clock::now();
    Pace pace_;
    Unwrapped unwrapped_;
    PullBound pull_bound_;
    knurl::Coupling coupling_;
    knurl::Claim hand_;
    knurl::Handle<knurl::Spring> spring_;
    Docked docked_;
    knurl::HandReport report_;
    std::int64_t begin_ = 0, read_ns_ = 0;
    double now_ = 0;                    // s since the device was active
    double own_time_ = 0, looked_ = 0;  // s: stops while this process is stopped; s since the start
    ImdFrame newest_;
    std::uint64_t frames_ = 0;
    Vector3d middle_ = Vector3d::Zero();  // A, of all atoms
    Vector3d atom_ = Vector3d::Zero(), push_ = Vector3d::Zero();
    Vector3d own_ = Vector3d::Zero();  // N, of the spring on the hand
    bool hot_ = false;
    knurl::measure::Grip grip_;
};

}  // namespace

knurl::CouplingScale scale_of(const DockOptions& options) {
    return {.length = options.scale * 1e-4,  // mm for 1 nm: m for 1 A
            .force = options.force_scale * 1e-3 * pn_per_kcal_per_angstrom};
}

double stiffness_on_atom(const DockOptions& options) {
    return options.stiffness * scale_of(options).length / scale_of(options).force;
}

std::string unfit(const DockOptions& options) {
    // Above a tenth of a bond's stiffness the spring outweighs the atom's surroundings, and a force that is
    // one frame old makes the atom swing.
    constexpr double most = 30;  // kcal/mol/A^2
    const double k = stiffness_on_atom(options);
    if (!(k > most)) return {};
    return fmt::format(
        "{:g} N/m in the hand would be {:.3g} kcal/mol/A^2 on the atom, a tenth of a bond's stiffness is "
        "{:g}: a larger --force-scale or a smaller --scale makes it softer",
        options.stiffness, k, most);
}

Docked dock(knurl::Client& client, Imd& simulation, const DockOptions& options, const std::atomic<bool>& stop,
            const std::function<void(const std::string&)>& told, const std::function<char()>& key) {
    return Session(client, simulation, options, stop, key).run(told);
}

}  // namespace dock
