// Devices, and the rates of all events.

#include <cmath>

#include <knurl/measure/sleeper.hpp>
#include <knurl/reps/plane.hpp>

#include "lab.hpp"
#include "rig.hpp"

namespace knurl::servo::scaling {

namespace {

using measure::Growth;

/// One application that changes the plane that it holds the hand with.
struct Application {
    Rig rig;
    OfflineClaim& claim;
    Plane plane{.offset = 1, .stiffness = 20};
    RepresentationId id;

    Application(double rate, double settling)
        : rig(rate), claim(rig.claim(16)), id(claim.add(plane, kept())) {
        rig.settle(settling);
    }
    void update() {
        plane.offset = plane.offset > 1 ? 1 : 1 + 1e-4;
        claim.update(id, plane);
        claim.commit();
    }

  private:
    static AddOptions kept() { return {.on_silence = OnSilence::hold}; }
};

}  // namespace

std::vector<Series> devices(Lab& lab) {
    std::vector<Series> axis = {{.name = "devices",
                                 .axis = "devices, a cycle of each",
                                 .design = Growth::linear,
                                 .why = "a servo each, which share nothing",
                                 .points = {}}};
    for (const double n : {1, 2, 3, 4, 6, 8}) {
        auto all = std::make_shared<std::vector<std::unique_ptr<Application>>>();
        for (int i = 0; i < static_cast<int>(n); ++i)
            all->push_back(std::make_unique<Application>(1000, lab.settling()));
        const auto round = [all] {
            for (const auto& one : *all) one->rig.step();
        };
        axis[0].points.push_back(
            {.n = n, .sample = lab.in_a_row(round, lab.options().quick ? 50 : 200), .samples = 5});
    }
    lab.measure(axis);
    return axis;
}

std::vector<Series> updates(Lab& lab) {
    constexpr double fast = 10'000, usual = 1000;  // Hz, of the servo
    std::vector<Series> axis = {{.name = "updates.to_10_kHz",
                                 .axis = "updates a second, servo at 10 kHz",
                                 .design = Growth::linear,
                                 .why = "an update costs the cycles that take and fade it",
                                 .mean = true,
                                 .points = {}},
                                {.name = "updates.merged",
                                 .axis = "updates a second, servo at 1 kHz",
                                 .design = Growth::constant,
                                 .why = "what comes between two cycles is merged: one batch is taken",
                                 .points = {}}};
    for (const double n : geometric(1, fast, std::sqrt(10.0))) {
        const auto one = std::make_shared<Application>(fast, lab.settling());
        const auto update = lab.elsewhere([one] { one->update(); });
        const auto when_due = [update, share = n / fast, due = 0.0]() mutable {
            due += share;
            if (due < 1 - 1e-9) return;
            due -= 1;
            update();
        };
        axis[0].points.push_back({.n = n,
                                  .sample = lab.alone([one] { one->rig.step(); }, when_due),
                                  .samples = lab.options().quick ? 100 : 600});
    }
    for (const double n : {1, 2, 3, 5, 7, 10}) {
        const auto one = std::make_shared<Application>(usual, lab.settling());
        axis[1].points.push_back({.n = n * usual,
                                  .sample = lab.alone([one] { one->rig.step(); }, lab.elsewhere([one, n] {
                                      for (int i = 0; i < static_cast<int>(n); ++i) one->update();
                                  })),
                                  .samples = lab.options().quick ? 12 : 40});
    }
    lab.measure(axis);
    return axis;
}

std::vector<Series> servo_rates(Lab& lab) {
    std::vector<Series> axis = {{.name = "servo_rate",
                                 .axis = "servo's rate, Hz; sleeps included",
                                 .design = Growth::constant,
                                 .why = "a cycle does not know how soon the next one comes",
                                 .points = {}}};
    for (const double rate : {1e3, 1.5e3, 2e3, 3e3, 5e3, 7e3, 10e3, 14e3, 20e3}) {
        const auto one = std::make_shared<Application>(rate, lab.settling());
        // In real time: a cycle's share of sleeping and waking is included, in user and kernel time.
        const auto window = [one, rate, length = lab.options().quick ? 0.01 : 0.05] {
            const auto cycles = static_cast<int>(std::lround(rate * length));
            const auto period = static_cast<Nanoseconds>(1e9 / rate);
            Nanoseconds deadline = measure::now_ns() + period;
            const double begin = thread_ns();
            for (int i = 0; i < cycles; ++i) {
                measure::sleep_until(deadline);
                one->rig.step();
                deadline += period * (std::max<Nanoseconds>(0, measure::now_ns() - deadline) / period + 1);
            }
            return (thread_ns() - begin) / cycles;
        };
        axis[0].points.push_back({.n = rate, .sample = window, .samples = 1});
    }
    lab.measure(axis);
    return axis;
}

}  // namespace knurl::servo::scaling
