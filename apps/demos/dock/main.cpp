// knurl-dock: an atom of a running simulation in the hand.

#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

#include <knurl/client/address.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/measure/grip.hpp>
#include <knurl/measure/measure.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/measure/private_servo.hpp>
#include <knurl/measure/sleeper.hpp>
#include <knurl/measure/temporary_file.hpp>

#include "dock.hpp"
#include "hand_path.hpp"
#include "picture.hpp"
#include "summary.hpp"

namespace {

using knurl::commandline::stop;

struct Options {
    std::string simulation, connect = "knurl:default", picture, csv, json;
    bool demo = false, no_account = false, kill = false;
    double wait = 5;
    dock::DockOptions dock;
    dock::HandPath path;
};

void describe(knurl::commandline::Command& app, Options& w) {
    dock::DockOptions& o = w.dock;
    app.option("HOST:PORT", w.simulation, "of a simulation that speaks IMD, version 2").required();
    app.option("--atom", o.atom, "to hold, counted from 0 in the simulation's IMD group; else the nearest")
        .not_negative();
    app.option("--rate", o.rate, "frames a second that the simulation shall send")
        .shows_default()
        .within(1.0, 400.0);
    app.option("--stiffness", o.stiffness, "N/m of the spring, in the hand")
        .shows_default()
        .within(1.0, 5000.0);
    app.option("--scale", o.scale, "mm in the hand for 1 nm").shows_default().within(1.0, 1000.0);
    app.option("--force-scale", o.force_scale, "mN in the hand for 1 pN").shows_default().within(0.1, 1000.0);
    app.option("--greatest-force", o.greatest_force, "kcal/mol/A on the atom; 58 is 4 nN, which breaks bonds")
        .shows_default()
        .within(0.01, 30.0);
    app.option("--greatest-temperature", o.greatest_temperature, "K; above it the atom is not pulled")
        .shows_default()
        .positive();
    app.option("--box", o.box, "nm, edge of the simulation's cubic box, if its atoms come in again opposite")
        .not_negative();
    app.option("--seconds", o.seconds, "s; 0: until Ctrl-C").shows_default().not_negative();
    app.flag("--at-once", o.at_once, "holds an atom as soon as the device is active");
    app.flag("--no-account", w.no_account,
             "the spring alone, without the coupling's energy account, for comparison");
    app.servo(w.connect, "the servo that has the device; or knurl://HOST:PORT")
        .shows_default()
        .checked(knurl::check_address);
    app.option("--device", o.device, "the servo's device; may be left out if it has one");
    app.flag("--share", o.share, "other programs that share may hold the device as well");
    app.option("--wait", w.wait, "s to wait for simulation and servo").shows_default().within(0.0, 3600.0);
    app.flag("--demo", w.demo, "a servo of its own with a simulated device, whose hand pulls at random");
    app.option("--seed", w.path.seed, "of that hand").shows_default();
    app.option("--reach", w.path.reach, "m from the middle, its reach").shows_default().within(0.005, 0.08);
    app.flag("--rough", w.path.rough,
             "that hand moves fast, and lets go and takes hold again at random, by its seed");
    app.flag("--kill", w.kill, "ends the simulation as well (gmx mdrun -imdterm)");
    app.option("--picture", w.picture, "PNG of force, length, the atom's way and the energies");
    app.option("--csv", w.csv, "FILE for every cycle");
    app.option("--json", w.json, "FILE for the figures");
    app.footer(
        "Space (or the device's first button, while pressed) takes the atom and lets go, q ends.\n"
        "Examples:\n"
        "  knurl-dock localhost:8889 --atom 0                  on the device of knurl:default\n"
        "  knurl-dock localhost:8889 --demo --picture dock.png without a device\n");
}

int run(Options& w) {
    dock::DockOptions& o = w.dock;
    for (const std::string* file : {&w.picture, &w.csv, &w.json})
        if (!file->empty()) knurl::measure::require_writable(*file);
    if (const std::string why = dock::unfit(o); !why.empty()) throw std::runtime_error(why);
    o.keep_account = !w.no_account;
    const auto patience = std::chrono::milliseconds(static_cast<int>(w.wait * 1e3));

    dock::Imd simulation(w.simulation, patience);            // first: it forks
    const knurl::measure::TemporaryFile path("knurl-dock");  // the way of the simulated hand
    std::unique_ptr<knurl::measure::PrivateServo> servo;
    if (w.demo) {
        if (!(o.seconds > 0)) o.seconds = 60;
        w.path.seconds = o.seconds;
        dock::write_path(path.name, w.path);
        servo = std::make_unique<knurl::measure::PrivateServo>(
            std::vector<std::string>{"--device", "sim:premium15", "--hand", path.name});
        w.connect = servo->address();
        o.at_once = true;
        fmt::print("a simulated hand on a simulated device, seed {}\n", w.path.seed);
    }
    knurl::measure::Keys keys;
    dock::Restless restless(w.path.seed);
    fmt::print(
        "{}: 1 nm is {:g} mm in the hand, 1 pN {:g} mN: {:g} N/m are {:.3g} kcal/mol/A^2 on the atom\n",
        w.simulation, o.scale, o.force_scale, o.stiffness, dock::stiffness_on_atom(o));
    std::fflush(stdout);
    auto client = knurl::Client::connect(w.connect, {.name = "knurl-dock", .wait = patience});
    const bool terminal = isatty(STDOUT_FILENO) != 0;
    const dock::Docked docked = dock::dock(
        client, simulation, o, stop,
        [&](const std::string& line) {
            if (!terminal) return;
            fmt::print("\r  {:<90}", line);
            std::fflush(stdout);
        },
        [&] {
            const double now = 1e-9 * static_cast<double>(knurl::measure::now_ns());
            return w.path.rough && restless.changes_its_mind(now) ? ' ' : keys.next();
        });
    if (terminal) fmt::print("\n");
    if (w.kill) simulation.kill();
    fmt::print("  {} atoms, {} byte order; atom {}\n", docked.atoms,
               docked.swapped ? "the other" : "this machine's", docked.atom);
    if (docked.stopped > 0)
        fmt::print("  this program was stopped {} times; the atom was let go meanwhile\n", docked.stopped);
    const dock::Summary summary = dock::summarise(docked, o);
    fmt::print("{}", dock::text_of(summary, docked, o));
    if (!w.csv.empty()) dock::write_csv(w.csv, docked);
    if (!w.json.empty()) knurl::measure::write_file(w.json, dock::json_of(summary, docked, o));
    if (!w.picture.empty()) {
        const knurl::measure::Machine machine = knurl::measure::this_machine();
        dock::draw(
            w.picture, docked, o,
            fmt::format(
                "atom {} of {} atoms at {}, {:.0f} frames/s, {:g} N/m; 1 nm is {:g} mm, 1 pN is {:g} mN",
                docked.atom, docked.atoms, w.simulation, summary.frames_per_second, o.stiffness, o.scale,
                o.force_scale),
            fmt::format("{}, Linux {}, {}", machine.processor, machine.kernel, machine.date));
        fmt::print("  {}\n", w.picture);
    }
    // A demonstration of nothing is none.
    if (docked.ended.empty()) return w.demo && docked.frames.empty() && !stop ? 1 : 0;
    fmt::print(stderr, "knurl-dock: {}\n", docked.ended);
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    knurl::commandline::Command app("knurl-dock", "knurl-dock: an atom of a running simulation in the hand.");
    describe(app, options);
    app.action([&] {
        knurl::commandline::stop_on_signals();
        return run(options);
    });
    return knurl::commandline::run(app, argc, argv);
}
