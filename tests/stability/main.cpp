// knurl_stability: finds the largest stable stiffness of every method by simulation on the virtual clock, and
// prints it beside the theory's. README.md is its chapter.

#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/measure/output_file.hpp>

#include "claims.hpp"
#include "relief_stroke.hpp"
#include "sweep.hpp"

using namespace stability;

namespace {

constexpr const char* definition =
    R"(Stable, for every method, rate and device alike (worst of all seeds; forces are the scene's):
  jump   largest change of the force within 1 ms                               <= 1 N
  rise   the same where the force grows: all that the paper counts             <= 1 N
  kick   largest speed of the tip away from the true surface                   <= 0.3 m/s
  cycle  half of peak to peak of the tip's height over the surface, at rest    <  0.1 mm
  power  mean power that the motors gave the hand                              <= 0.1 W
"stable": jump, kick, cycle and power hold. "strictly" in the goals: jump and kick.
Each run: 1 s to come to rest, 5 s of stroke, 1.5 s to settle, 0.5 s in which a limit cycle is looked for.
)";

std::vector<Table> standard(Seeds seeds) {
    std::vector<Table> tables = {
        device_table(seeds),  // the longest first
        paper_wall_table(seeds),
        wall_table(seeds),
        method_table("gentle", "Gentle ridge (5 mm x 80 mm), 0.15 m/s: largest stiffness by criterion, N/m",
                     gentle_ridge, seeds),
        method_table("harsh", "Harsh ridge (3 mm x 40 mm), 0.15 m/s: largest stiffness by criterion, N/m",
                     harsh_ridge, seeds),
        speed_table(seeds),
        bound_table(seeds),
        damping_table(seeds),
        released_table(seeds),
        error_table(seeds)};
    for (Table& table : factor_tables(seeds)) tables.push_back(std::move(table));
    return tables;
}

}  // namespace

int main(int argc, char** argv) {
    knurl::commandline::Command app(
        "knurl_stability", "Largest stable stiffness of every method, by simulation on the virtual clock.");
    bool quick = false, full = false, network = false, worlds = false;
    Seeds seeds;
    int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::string file, only, relief;
    unsigned phases = 40;
    app.flag("--quick", quick,
             "the directions of the main claims alone, in a few seconds; fails if one does not hold");
    app.flag("--worlds", worlds,
             "some strokes in worlds of three sizes alone, in a few seconds; fails if they feel different");
    app.option("--world", stated_world, "metres of the application's world that one metre of the device is")
        .within(1e-3, 1e4);
    app.flag("--full", full, "the full grid instead: many hours");
    app.flag("--network", network,
             "the tables of a remote application instead, by the network's delay, swing and loss");
    app.option("--relief", relief,
               "the demo's stroke over this elevation model instead, at many phases of the application");
    app.option("--phases", phases, "of its interval, for --relief").within(1, 1000);
    app.option("--seeds", seeds.count, "runs of each case, the worst counts").within(1, 1000);
    app.option("--first-seed", seeds.first, "their seeds count up from this one").within(1, 1000000);
    app.option("--jobs", jobs, "threads").within(1, 256);
    app.option("--json", file, "write all tables to this file");
    app.option("--only", only, "the table of this key alone");
    app.action([&] {
        const knurl::measure::Machine machine = knurl::measure::this_machine();
        const auto begun = std::chrono::steady_clock::now();
        std::vector<Table> tables;
        std::vector<Claim> claims;
        std::optional<ReliefStroke> stroke;
        if (!file.empty()) knurl::measure::require_writable(file);
        if (!relief.empty()) stroke = ReliefStroke::of(relief);
        if (!stroke) fmt::print("{}", definition);
        if (quick || worlds) {
            claims = quick ? quick_claims() : world_claims();
        } else {
            tables = stroke    ? std::vector<Table>{relief_table(*stroke, phases)}
                     : full    ? std::vector<Table>{full_grid(seeds)}
                     : network ? network_tables(seeds)
                               : standard(seeds);
            if (!only.empty()) std::erase_if(tables, [&](const Table& t) { return t.key != only; });
            fill(tables, jobs, [](int done, int all) { fmt::print(stderr, "\r{} of {} rows", done, all); });
            fmt::print(stderr, "\n");
            for (const Table& table : tables) fmt::print("{}", markdown(table));
            if (network)
                claims = network_claims(tables);
            else if (!stroke && !full && only.empty())
                claims = claims_of(tables);
        }
        if (!claims.empty()) fmt::print("{}", markdown(claims));
        const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        if (!stroke)
            fmt::print("\n{} seeds, {} threads, {:.0f} s\n", quick ? 2 : seeds.count, quick ? 2 : jobs, took);
        if (!file.empty()) {
            knurl::measure::write_file(file, json(tables, {.machine = machine,
                                                           .of = stroke ? "phases" : "seeds",
                                                           .count = stroke ? phases : seeds.count,
                                                           .seconds = took}));
        }
        return sound(claims) ? 0 : 1;
    });
    return knurl::commandline::run(app, argc, argv);
}
