// Walls at rest: the bound, virtual damping, released devices.

#include <fmt/format.h>

#include "bound.hpp"
#include "cases.hpp"
#include "sweep.hpp"
#include "vary.hpp"

namespace stability {

Table bound_table(Seeds seeds) {
    Table table{.key = "bound",
                .title = "Static limit against b / (T/2 + tau), N/m",
                .unit = "N/m",
                .digits = 2,
                .columns = {"bound", "eigenvalue", "measured, no dry friction", "measured, 0.05 N",
                            "measured / bound"},
                .rows = {}};
    std::vector<Variant> variants;
    const Conditions centre = at_rest();
    vary(
        variants, "servo ", 1, " Hz", {500, 1000, 4000, 10'000}, [](auto& c, double v) { c.rate = v; },
        centre);
    vary(
        variants, "hand ", 1, " N s/m", {1, 2, 5, 8}, [](auto& c, double v) { c.hand_damping = v; }, centre);
    vary(
        variants, "lag ", 1, " Hz", {50, 100, 1000}, [](auto& c, double v) { c.lag = v; }, centre);
    vary(
        variants, "delay ", 1e3, " ms", {0.5e-3, 1e-3, 2e-3, 5e-3}, [](auto& c, double v) { c.delay = v; },
        centre);
    vary(
        variants, "mass ", 1, " kg", {0.05, 0.2, 0.4}, [](auto& c, double v) { c.mass = v; }, centre);
    vary(
        variants, "encoder ", 1e6, " um", {0, 10e-6, 100e-6}, [](auto& c, double v) { c.quantum = v; },
        centre);
    vary(
        variants, "grip ", 1, "", {0.25, 0.5}, [](auto& c, double v) { c.grip = v; }, centre);
    for (const Variant& v : variants) {
        table.rows.push_back({v.name,
                              bound(v.c),
                              [c = v.c, seeds] {
                                  Conditions smooth = c;
                                  smooth.coulomb = 0;
                                  const Value free = largest(smooth, seeds, cycle | power);
                                  return std::vector<Value>{{bound(c)},
                                                            {eigenvalue_limit(c)},
                                                            free,
                                                            largest(c, seeds, cycle | power),
                                                            {free.value / bound(c)}};
                              },
                              {}});
    }
    return table;
}

Table damping_table(Seeds seeds) {
    Table table{.key = "damping",
                .title = "Virtual damping of the wall, not counted and counted, no dry friction, N/m",
                .unit = "N/m",
                .columns = {"not counted: b/(T/2+tau)", "counted: (b+bv)/(T/2+tau)", "0.7 (b+bv)/(T/2+tau)",
                            "eigenvalue", "measured"},
                .rows = {}};
    for (const double mass : {0.05, 0.10}) {
        for (const double bv : {0.0, 2.0, 5.0, 10.0, 20.0, 40.0}) {
            Conditions c = at_rest();
            c.mass = mass;
            c.finger = mass == 0.05 ? 0 : c.finger;
            c.coulomb = 0;
            c.virtual_damping = bv;
            table.rows.push_back({fmt::format("{:g} kg, bv {:g} N s/m", c.total_mass(), bv),
                                  bv,
                                  [c, seeds] {
                                      const double counted = bound(c) *
                                                             (c.total_damping() + c.virtual_damping) /
                                                             c.total_damping();
                                      return std::vector<Value>{{bound(c)},
                                                                {counted},
                                                                {0.7 * counted},
                                                                {eigenvalue_limit(c)},
                                                                largest(c, seeds, cycle | power)};
                                  },
                                  {}});
        }
    }
    return table;
}

Table released_table(Seeds seeds) {
    Table table{
        .key = "released",
        .title = "Hand present and released (the device lies on the wall with 1 N of its own weight), N/m",
        .unit = "N/m",
        .columns = {"bound", "eigenvalue", "no dry friction", "0.02 N", "0.05 N", "0.1 N"},
        .rows = {}};
    for (const double grip : {1.0, 0.5, 0.2, 0.0}) {
        Conditions c = at_rest();
        c.grip = grip;
        c.weight = grip == 0 ? 1 : 0;
        table.rows.push_back({grip == 0 ? "released" : fmt::format("grip {:g}", grip),
                              grip,
                              [c, seeds] {
                                  std::vector<Value> values{{bound(c)}, {eigenvalue_limit(c)}};
                                  for (const double coulomb : {0.0, 0.02, 0.05, 0.1}) {
                                      Conditions dry = c;
                                      dry.coulomb = coulomb;
                                      values.push_back(largest(dry, seeds, cycle | power));
                                  }
                                  return values;
                              },
                              {}});
    }
    return table;
}

}  // namespace stability
