// knurl-bodies: a rigid-body scene in the hand.

#include <cstdio>

#include <fmt/format.h>

#include <knurl/client/address.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/measure/grip.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/measure/private_servo.hpp>
#include <knurl/measure/temporary_file.hpp>

#include "compare.hpp"
#include "picture.hpp"
#include "play.hpp"

namespace {

using knurl::commandline::stop;

struct Options {
    std::string connect = "knurl:default", picture, csv;
    bool demo = false, compare = false;
    int fingers = 1;
    double wait = 2;
    bodies::PlayOptions play;
};

void describe(knurl::commandline::Command& app, Options& w) {
    auto& touch = w.play.coupled.touch;
    auto& hold = w.play.coupled.hold;
    app.option("--rate", w.play.rate, "Hz of the simulation's frames").shows_default().within(20.0, 500.0);
    app.option("--stiffness", touch.stiffness,
               "N/m of the bodies' surfaces, or what device and body admit if that is less")
        .shows_default()
        .within(1.0, 1e5);
    app.option("--damping", touch.damping, "N s/m of the bodies' surfaces").shows_default().within(0.0, 1e3);
    app.option("--friction", touch.friction, "Coulomb coefficient of finger on body")
        .shows_default()
        .within(0.0, 10.0);
    app.option("--spring", hold.stiffness, "N/m of each of the four springs that hold a body")
        .shows_default()
        .within(1.0, 5000.0);
    app.option("--fingers", w.fingers, "1: the hand; 3: two more, 12 mm to its left and right")
        .shows_default()
        .one_of({"1", "3"});
    app.option("--slow", w.play.slow, "s that are added to each step of the simulation")
        .shows_default()
        .within(0.0, 10.0);
    app.option("--lose-at", w.play.lose_at,
               "s after which the engine loses the held body, or the first one, to try that error")
        .within(0.0, 1e6);
    app.option("--seconds", w.play.seconds, "s to play; 0: until Ctrl-C").shows_default().not_negative();
    app.servo(w.connect, "the servo that has the device").shows_default().checked(knurl::check_address);
    app.option("--device", w.play.device,
               "the servo's device; may be left out if it has one. With --demo: what is simulated, else "
               "sim:premium15");
    app.option("--wait", w.wait, "s to wait for a servo that is still starting")
        .shows_default()
        .within(0.0, 3600.0);
    app.flag("--demo", w.demo,
             "a servo of its own with a simulated device, whose hand pushes a box, takes it and sets it "
             "on another");
    app.flag("--compare", w.compare,
             "instead: the stiffest stable contact at --rate, with forces from the engine's loop and with "
             "surfaces, on a virtual clock");
    app.option("--picture", w.picture, "PNG of the tray, the bodies' ways and the force");
    app.option("--csv", w.csv, "FILE for every cycle");
    app.footer(
        "Space (or the device's first button, while pressed) takes a body within 15 mm and lets go, r puts "
        "all\n"
        "bodies where they were, q ends.\n"
        "Examples:\n"
        "  knurl-bodies --rate 120                    on the device of knurl:default\n"
        "  knurl-bodies --demo --picture bodies.png   without a device\n"
        "  knurl-bodies --demo --device sim:generic6  with one that gives torque\n");
}

void say(const bodies::World& world, const bodies::Played& played) {
    for (std::size_t i = 0; i < world.bodies().size(); ++i) {
        const Eigen::Vector3d from = world.bodies()[i].position, to = world.after(i).position;
        if ((to - from).norm() > 1e-3)
            fmt::print("  {}: from ({:+.0f}, {:+.0f}, {:+.0f}) to ({:+.0f}, {:+.0f}, {:+.0f}) mm\n",
                       world.bodies()[i].name, 1e3 * from.x(), 1e3 * from.y(), 1e3 * from.z(), 1e3 * to.x(),
                       1e3 * to.y(), 1e3 * to.z());
    }
    const auto& a = played.account;
    const double gained = played.frames.empty() ? 0 : played.frames.back().gained;
    fmt::print(
        "  {} cycles, {} reports missed; largest change of the force in a cycle {:.2f} N; torque up to "
        "{:.3f} N "
        "m\n",
        played.cycles.size(), played.unread, played.jump, played.torque);
    fmt::print(
        "  {} frames, {} of them late; of {} with a force on a body {} were made smaller by the account\n",
        played.frames.size(), played.late, played.pushed, played.short_of);
    fmt::print("  the hand put in {:.1f} mJ, the bodies got {:.1f} and have {:.1f} more than before\n",
               1e3 * a.hand, 1e3 * a.body, 1e3 * gained);
    if (played.pushed == 0) fmt::print("  no body was touched: these figures say nothing of a contact\n");
    if (played.jumps > 0) fmt::print("  bodies were put elsewhere {} times\n", played.jumps);
    if (played.faults != 0) fmt::print("  the device faulted (mask {:#x}); see `knurl ls`\n", played.faults);
}

int run_compare(double rate) {
    fmt::print("the stiffest stable contact at {:g} frames a second, N/m, in steps of 1.4\n", rate);
    fmt::print("{:50} {:>12} {:>26} {:>26}\n", "", "force sent", "surface", "as admitted");
    const auto figure = [](double stable, double most) {
        return stable >= most ? fmt::format("{:.0f} or more", stable) : fmt::format("{:.0f}", stable);
    };
    const auto surface = [&](const bodies::Stiffest::Surface& of, double most) {
        return fmt::format("{}, felt {:.0f}", figure(of.wish, most), of.felt);
    };
    for (const bodies::Stiffest& row : bodies::compare(rate))
        fmt::print("{:50} {:>12} {:>26} {:>26}\n", row.what, figure(row.in_loop, row.most),
                   surface(row.as_wished, row.most), surface(row.held_to, row.most));
    fmt::print("on a virtual clock, without chance: twice the same\n");
    return 0;
}

/// If the program's own servo does not start, the error says why.
knurl::Client connect(const Options& w, knurl::measure::PrivateServo* servo) {
    const double at_once = servo != nullptr ? 0.2 : w.wait;
    const auto wait = std::chrono::milliseconds(static_cast<int>(at_once * 1e3));
    for (double waited = at_once;; waited += at_once) try {
            return knurl::Client::connect(w.connect, {.name = "knurl-bodies", .wait = wait});
        } catch (const knurl::Error&) {
            if (servo == nullptr || waited > w.wait) throw;
            servo->require_running();
        }
}

int run(Options& w) {
    if (w.compare) return run_compare(w.play.rate);
    if (!w.picture.empty()) knurl::measure::require_writable(w.picture);
    if (!w.csv.empty()) knurl::measure::require_writable(w.csv);
    if (w.fingers == 3) w.play.coupled.fingers = {{0, 0, 0}, {0, 0.012, 0}, {0, -0.012, 0}};
    bodies::World world(bodies::usual_bodies());
    const bodies::Script script = bodies::push_take_and_stack();
    const knurl::measure::TemporaryFile path("knurl-bodies");  // the way of the simulated hand
    std::unique_ptr<knurl::measure::PrivateServo> servo;
    if (w.demo) {
        script.write(path.name);
        w.play.script = &script;
        if (!(w.play.seconds > 0)) w.play.seconds = script.end();
        servo = std::make_unique<knurl::measure::PrivateServo>(std::vector<std::string>{
            "--device", w.play.device.empty() ? "sim:premium15" : w.play.device, "--hand", path.name});
        w.play.device.clear();
        w.connect = servo->address();
        w.wait = 10;
    }
    auto client = connect(w, servo.get());
    knurl::measure::Keys keys;
    const bodies::Played played = bodies::play(
        client, world, w.play, stop,
        [](const std::string& line) { fmt::print(stderr, "knurl-bodies: {}\n", line); },
        [&keys] { return keys.next(); });
    say(world, played);
    if (!w.csv.empty()) bodies::write_csv(w.csv, world, played);
    if (!w.picture.empty()) {
        const knurl::measure::Machine machine = knurl::measure::this_machine();
        bodies::draw(w.picture, world, played,
                     fmt::format("rigid bodies at {:g} Hz, from the side (first place pale)", w.play.rate),
                     fmt::format("{}, Linux {}, {}", machine.processor, machine.kernel, machine.date));
        fmt::print("  {}\n", w.picture);
    }
    return played.faults != 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    knurl::commandline::Command app("knurl-bodies", "knurl-bodies: a rigid-body scene in the hand.");
    describe(app, options);
    app.action([&] {
        knurl::commandline::stop_on_signals();
        return run(options);
    });
    return knurl::commandline::run(app, argc, argv);
}
