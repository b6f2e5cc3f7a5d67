#include "claims.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "cases.hpp"
#include "servo_stroke.hpp"
#include "stroke.hpp"
#include "sweep.hpp"

namespace stability {
namespace {

using way::cap, way::paper, way::planes, way::usual;

constexpr const char* both = "jump and kick";

const Table& named(const std::vector<Table>& tables, const std::string& key) {
    const auto found =
        std::find_if(tables.begin(), tables.end(), [&](const Table& t) { return t.key == key; });
    if (found == tables.end()) throw std::out_of_range("no table " + key);
    return *found;
}

/// `more` at least `factor` times `less`.
Claim times(std::string text, double more, double less, double factor, bool goal) {
    return {std::move(text), fmt::format("{:.0f} / {:.0f} N/m = x{:.1f}", more, less, more / less),
            more >= factor * less, goal};
}
Claim at_least(std::string text, double value, double least, const char* unit, bool goal) {
    return {std::move(text), fmt::format("{:.0f} {}", value, unit), value >= least, goal};
}
Claim at_most(std::string text, double value, double most, const char* unit, bool goal) {
    return {std::move(text), fmt::format("{:.3f} {}", value, unit), value <= most, goal};
}

/// What a quick run can see as well: the tables "wall", "gentle", "harsh" with fewer rows.
void directions(const Table& wall, const Table& gentle, const Table& harsh, std::vector<Claim>& claims) {
    claims.push_back(
        times("a plane at 20 Hz on the servo against forces at 20 Hz, 25 ms late: ten times at least",
              wall.at("plane at 20 Hz, 25 ms late", "k_max"), wall.at("force at 20 Hz, 25 ms late", "k_max"),
              10, false));
    const double limit = wall.at("plane at 20 Hz, 25 ms late", "the same without dry friction");
    const double bound = wall.at("plane at 20 Hz, 25 ms late", "b / (late + T/2)");
    claims.push_back({"without dry friction the wall's limit is b/(T/2+tau) within 10 %",
                      fmt::format("{:.0f} N/m, bound {:.0f}", limit, bound),
                      std::abs(limit / bound - 1) <= 0.10, false});
    claims.push_back(
        times("recovery of 50 ms, read as the paper reads it (rises alone), harsh: eight times at least",
              harsh.at(paper, "rise"), harsh.at(planes, "rise"), 8, false));
    claims.push_back({"the same, read strictly (jumps both ways, kick): no gain",
                      fmt::format("{}{:.0f} / {:.0f} N/m",
                                  harsh.row(paper).values[5].kind == Value::Kind::below ? "< " : "",
                                  harsh.at(paper, both), harsh.at(planes, both)),
                      harsh.at(paper, both) <= harsh.at(planes, both), false});
    claims.push_back(times("the default against planes as they come, gentle, strictly: eight times at least",
                           gentle.at(usual, both), gentle.at(planes, both), 8, false));
    claims.push_back(times("the default against planes as they come, harsh, strictly: ten times at least",
                           harsh.at(usual, both), harsh.at(planes, both), 10, false));
    claims.push_back(times("caps against planes as they come, harsh, strictly: ten times at least",
                           harsh.at(cap, both), harsh.at(planes, both), 10, false));
}

Table only(Table table, std::initializer_list<const char*> names) {
    std::erase_if(table.rows, [&](const Row& row) {
        return std::none_of(names.begin(), names.end(), [&](const char* name) { return row.name == name; });
    });
    return table;
}

}  // namespace

std::vector<Claim> claims_of(const std::vector<Table>& tables) {
    const Table &wall = named(tables, "wall"), &gentle = named(tables, "gentle"),
                &harsh = named(tables, "harsh");
    std::vector<Claim> claims;
    directions(wall, gentle, harsh, claims);
    const Table& hand = named(tables, "premium15");
    claims.push_back(
        {"2100 N/m, the paper's figure, on premium15: wall and slow gentle stroke with the default are "
         "stable",
         fmt::format("{:.0f} and {:.0f} criteria broken", hand.at("wall, at rest", "broken"),
                     hand.at(std::string("gentle 0.05 m/s, ") + usual, "broken")),
         hand.at("wall, at rest", "broken") + hand.at(std::string("gentle 0.05 m/s, ") + usual, "broken") ==
             0,
         false});
    claims.push_back(times("x10 of stiffness by recovery, as the paper reads it", harsh.at(paper, "rise"),
                           harsh.at(planes, "rise"), 10, true));
    claims.push_back(times("gentle .15, strictly: x12 with planes", gentle.at(usual, both),
                           gentle.at(planes, both), 12, true));
    claims.push_back(times("harsh .15, strictly: x20 with planes", harsh.at(usual, both),
                           harsh.at(planes, both), 20, true));
    claims.push_back(
        times("harsh .15, strictly: x25 with caps", harsh.at(cap, both), harsh.at(planes, both), 25, true));
    claims.push_back(at_least("gentle .15: 4500 N/m with planes", gentle.at(usual, both), 4500, "N/m", true));
    claims.push_back(at_least("harsh .15: 2300 N/m with caps", harsh.at(cap, both), 2300, "N/m", true));
    const Table& error = named(tables, "error");
    claims.push_back(at_most("force error gentle .10, 20 Hz, 1000 N/m, planes: 0.05 N",
                             error.at("20 Hz", "gentle: default"), 0.05, "N", true));
    claims.push_back(at_most("the same, caps: 0.015 N", error.at("20 Hz", "gentle: cap"), 0.015, "N", true));
    return claims;
}

std::vector<Claim> network_claims(const std::vector<Table>& tables) {
    if (tables.size() < 4) return {};  // --only
    const Table &wall = named(tables, "network_wall"), &delay = named(tables, "network_delay"),
                &loss = named(tables, "network_loss");
    std::vector<Claim> claims;
    claims.push_back(
        {"a wall that the servo evaluates does not know how far the application is: 0 and 100 ms",
         fmt::format("{:.0f} and {:.0f} N/m", wall.at(" 0 ms", usual), wall.at(" 100 ms", usual)),
         wall.at(" 0 ms", usual) <= wall.at(" 100 ms", usual), false});
    claims.push_back(
        times("a plane from 50 ms away against a force from here, gentle .15: ten times at least",
              delay.at(" 50 ms", usual), delay.at(" 0 ms", way::force), 10, false));
    claims.push_back(times("30 % lost against nothing lost: nine tenths at least", loss.at(" 30 %", usual),
                           loss.at(" 0 %", usual), 0.9, false));
    claims.push_back(times("to 20 ms the default is stiffer than the plain cross-fade",
                           delay.at(" 20 ms", usual), delay.at(" 20 ms", way::faded), 1, false));
    claims.push_back(times("at 100 ms the plain cross-fade is the stiffer one",
                           delay.at(" 100 ms", way::faded), delay.at(" 100 ms", usual), 1, false));
    return claims;
}

std::vector<Claim> quick_claims() {
    constexpr Seeds seeds{.first = 1, .count = 2};
    std::vector<Table> tables = {
        only(wall_table(seeds), {"force at 20 Hz, 25 ms late", "plane at 20 Hz, 25 ms late"}),
        only(method_table("gentle", "gentle", gentle_ridge, seeds), {planes, usual}),
        only(method_table("harsh", "harsh", harsh_ridge, seeds), {planes, paper, usual, cap})};
    fill(tables, 2, {});
    std::vector<Claim> claims;
    directions(tables[0], tables[1], tables[2], claims);
    return claims;
}

std::vector<Claim> world_claims() {
    constexpr double worlds[] = {0.01, 1000}, within = 0.05;
    std::vector<Claim> claims;
    for (const char* name : {way::force, planes, usual, cap}) {
        for (const bool real : {false, true}) {
            Conditions c = with({}, method(name));
            c.reach = 60e-3;
            const double stiffness = name == std::string(way::force) ? 50 : 1000;  // N/m, of the device
            const auto figures = [&](double world) {
                c.world = world;
                return real ? servo_stroke("premium15", c, stiffness, 1, 0, true)
                            : stroke(c, stiffness, 1, 0, true);
            };
            const Figures here = figures(1);
            for (const double world : worlds) {
                const Figures there = figures(world);
                double most = 0;
                for (const auto& [a, b] : {std::pair{there.jump, here.jump},
                                           {there.kick, here.kick},
                                           {there.error, here.error},
                                           {there.peak, here.peak}})
                    most = std::max(most, std::abs(a / b - 1));
                claims.push_back(
                    {fmt::format(
                         "a metre of the device is {:g}, {}, {}: jump, kick, error and peak within 5 %",
                         world, name, real ? "the real servo on premium15" : "the bench"),
                     fmt::format("jump {:.3f} N, kick {:.3f} m/s, error {:.4f} N; {:.2g} % off", there.jump,
                                 there.kick, there.error, 100 * most),
                     most <= within && std::isfinite(here.jump), false});
            }
        }
    }
    return claims;
}

std::string markdown(const std::vector<Claim>& claims) {
    std::string text = "\n### Claims and goals\n\n| claim | measured | |\n|---|---|---|\n";
    for (const Claim& c : claims)
        text += fmt::format("| {}{} | {} | {} |\n", c.goal ? "goal: " : "", c.text, c.measured,
                            c.holds ? (c.goal ? "reached" : "holds") : (c.goal ? "NOT reached" : "FAILED"));
    return text;
}

bool sound(const std::vector<Claim>& claims) {
    return std::all_of(claims.begin(), claims.end(), [](const Claim& c) { return c.goal || c.holds; });
}

}  // namespace stability
