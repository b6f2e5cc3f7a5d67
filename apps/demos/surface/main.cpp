// knurl-surface: a hand strokes a real relief through an application of 20 Hz, in several ways, which are
// judged.

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/client/address.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/measure/output_file.hpp>
#include <knurl/measure/script.hpp>

#include "outcome.hpp"
#include "relief.hpp"
#include "stroke.hpp"
#include "ways.hpp"

namespace {

using knurl::commandline::stop;

struct Options {
    std::string model, connect = "knurl:default", device;
    double wait = 2;  // s
    std::string write_stroke, json, csv, relief_file;
    std::vector<std::string> ways = {"force", "planes", "paper", "knurl", "caps", "mesh", "field"};
    surface::ReliefOptions relief;
    surface::StrokeOptions stroke;
    surface::StrokeRun run;
};

void describe(knurl::commandline::Command& app, Options& w) {
    app.option("MODEL", w.model, "elevation model: 16-bit greyscale PNG, 16-bit PGM, ESRI ASCII grid")
        .required();
    app.servo(
           w.connect,
           "the servo that has the device; or knurl://HOST:PORT of a knurl-bridge (its key: KNURL_KEY=FILE)")
        .shows_default()
        .checked(knurl::check_address);
    app.option("--device", w.device, "the servo's device; may be left out if it has one");
    app.option("--wait", w.wait, "s to wait for a servo that is still starting")
        .shows_default()
        .within(0.0, 3600.0);
    app.option("--ways", w.ways, "which of force, planes, paper, knurl, caps, mesh, field")
        .separated_by(',')
        .shows_default();
    app.option("--rate", w.run.rate, "Hz of this application's updates").shows_default().within(1.0, 1000.0);
    app.option("--think", w.run.think, "s from reading the hand to answering")
        .shows_default()
        .within(0.0, 1.0);
    app.option("--stiffness", w.run.stiffness, "N/m, or the device's k_max if that is less")
        .shows_default()
        .positive();
    app.option("--json", w.json, "FILE for the judgement");
    app.option("--csv", w.csv, "FILE for every cycle");
    app.option("--relief", w.relief_file, "FILE for the felt surface (ESRI ASCII grid, mm)");
    app.option("--write-stroke", w.write_stroke,
               "write the motion for `knurld --hand` to this FILE, and end");
    app.option("--speed", w.stroke.speed, "m/s of the stroke").shows_default().within(0.005, 1.0);
    app.option("--press", w.stroke.press, "m by which the hand's path runs below the broad shape")
        .shows_default()
        .within(0.0, 0.05);
    app.option("--cell", w.relief.cell, "m under the hand per cell of the model")
        .shows_default()
        .within(1e-5, 0.05);
    app.option("--exaggeration", w.relief.exaggeration, "of heights").shows_default().positive();
    app.option("--smoothing", w.relief.smoothing, "m under the hand, standard deviation; 0: none")
        .shows_default()
        .within(0.0, 0.05);
    app.option("--metres-per-count", w.relief.metres_per_count, "overrides the model's own").positive();
    app.option("--metres-per-cell", w.relief.metres_per_cell, "overrides the model's own").positive();
    app.footer(
        "Example:\n"
        "  knurl-surface --write-stroke stroke.csv hills.png\n"
        "  knurld --device sim:premium15 --hand stroke.csv &\n"
        "  knurl-surface hills.png --json out.json --csv out.csv --relief relief.asc\n"
        "  " +
        knurl::measure::script("plot_surface.py") +
        " out.json out.csv relief.asc out.png\n"
        "Exit code 1: some way has no verdict (the hand never touched, did not move, ...).\n");
}

int run(const Options& options) {
    std::vector<surface::Way> ways;
    for (const auto& key : options.ways) ways.push_back(surface::way_of(key));

    const auto model = surface::load_elevation(options.model);
    for (const auto& line : model.notes) fmt::print(stderr, "knurl-surface: {}: {}\n", options.model, line);
    const auto relief = surface::make_relief(model, options.relief);
    const surface::Terrain terrain(relief.grid);
    const auto path = surface::make_stroke(terrain, options.stroke);
    if (!options.relief_file.empty()) surface::write_relief(options.relief_file, terrain);
    if (!options.write_stroke.empty()) {
        surface::write_stroke(path, options.write_stroke);
        fmt::print("{}: {}\n", model.name, relief.statement);
        fmt::print("{}: a stroke of {:.1f} s at {:g} m/s\n", options.write_stroke, path.end,
                   options.stroke.speed);
        return 0;
    }

    // Fails before a minute of measuring, not after it.
    if (!options.csv.empty()) knurl::measure::require_writable(options.csv);
    if (!options.json.empty()) knurl::measure::require_writable(options.json);
    auto client = knurl::Client::connect(
        options.connect,
        {.name = "knurl-surface", .wait = std::chrono::milliseconds(static_cast<int>(options.wait * 1e3))});
    surface::RunText text{.model = model.name,
                          .scale = relief.statement,
                          .machine = knurl::measure::this_machine(),
                          .rate = options.run.rate,
                          .think = options.run.think};
    for (const auto& device : client.devices())
        if (options.device.empty() || device.name == options.device) {
            text.device = fmt::format("{} ({})", device.name, device.address);
            text.servo_rate = device.rate;
            break;
        }

    surface::StrokeRun stroke = options.run;
    stroke.device = options.device;
    stroke.span = {
        .rest_at = path.rest_at, .end = path.end, .period = text.servo_rate > 0 ? 1 / text.servo_rate : 1e-3};
    std::vector<surface::Outcome> outcomes;
    for (const auto way : ways) {
        if (stop) break;
        fmt::print("{} ... ", surface::title_of(way, stroke.rate));
        std::fflush(stdout);
        outcomes.push_back(
            surface::judged(surface::stroke(client, way, terrain, stroke, stop), terrain, stroke.span));
        fmt::print("{}\n", stop ? "interrupted" : outcomes.back().judgement.verdict());
    }
    if (outcomes.empty()) return 130;
    fmt::print("\n{}", surface::table(outcomes, text));
    if (!options.csv.empty()) surface::write_csv(options.csv, outcomes, terrain);
    if (!options.json.empty()) surface::write_json(options.json, outcomes, text);
    if (stop) return 130;
    const bool all_judged = std::all_of(outcomes.begin(), outcomes.end(), [](const surface::Outcome& o) {
        return o.judgement.stable().has_value();
    });
    return all_judged ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    knurl::commandline::Command app(
        "knurl-surface",
        "knurl-surface: a hand strokes a real relief through an application of 20 Hz, in several ways.");
    describe(app, options);
    app.action([&] {
        knurl::commandline::stop_on_signals();
        return run(options);
    });
    return knurl::commandline::run(app, argc, argv);
}
