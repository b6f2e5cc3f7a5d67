// One factor at a time about the centre, and all combinations.

#include <array>

#include <fmt/format.h>

#include "cases.hpp"
#include "sweep.hpp"
#include "vary.hpp"

namespace stability {

std::vector<Table> factor_tables(Seeds seeds) {
    std::vector<Table> tables;
    const std::vector<const char*> compared = {way::force, way::planes, way::paper,
                                               way::faded, way::usual,  way::cap};
    const auto add = [&](const char* key, const char* title, const std::vector<Variant>& variants,
                         bool recoveries = false) {
        Table table{.key = key,
                    .title = std::string("Stable stiffness by ") + title + ", gentle .15 m/s, N/m",
                    .unit = "N/m",
                    .columns = {},
                    .rows = {}};
        for (const char* name : compared) table.columns.emplace_back(name);
        for (const Variant& v : variants) {
            table.rows.push_back({v.name,
                                  v.x,
                                  [v, compared, seeds, recoveries] {
                                      std::vector<Value> values;
                                      for (const char* name : compared) {
                                          Conditions c = with(v.c, method(name));
                                          if (recoveries && (c.method.recovery != 0)) c.method.recovery = v.x;
                                          values.push_back(largest(c, seeds));
                                      }
                                      return values;
                                  },
                                  {}});
        }
        tables.push_back(std::move(table));
    };
    std::vector<Variant> v;
    vary(v, "", 1, " Hz", {500, 1000, 4000, 10'000}, [](auto& c, double x) { c.rate = x; });
    add("servo_rate", "servo rate", v);
    v.clear();
    vary(v, "", 1e3, " ms", {0.002, 0.005, 0.01, 0.02, 0.05, 0.1}, [](auto&, double) {});
    add("recovery", "recovery or fade time", v, true);
    v.clear();
    vary(v, "", 1e6, " um", {0, 10e-6, 30e-6, 100e-6, 300e-6}, [](auto& c, double x) { c.quantum = x; });
    add("encoder", "encoder resolution", v);
    v.clear();
    vary(v, "", 1e3, " ms", {0, 0.5e-3, 1e-3, 2e-3}, [](auto& c, double x) { c.delay = x; });
    add("delay", "delay of the device", v);
    v.clear();
    vary(v, "", 1e3, " ms", {1e-3, 10e-3, 25e-3, 50e-3, 100e-3}, [](auto& c, double x) { c.answer = x; });
    add("answer", "delay of the application", v);
    v.clear();
    vary(v, "", 1, "", {0.25, 0.5, 1, 2}, [](auto& c, double x) { c.grip = x; });
    add("grip", "grip (scales the hand)", v);
    v.clear();
    vary(v, "", 1, " Hz", {5, 10, 20, 50, 100, 200}, [](auto& c, double x) {
        c.update_rate = x;
        c.answer = std::min(0.5 / x, 25e-3);
    });
    add("update_rate", "application rate", v);
    v.clear();
    vary(v, "", 1, " kg", {0.05, 0.10, 0.20, 0.40}, [](auto& c, double x) { c.mass = x; });
    add("mass", "mass of the device", v);
    return tables;
}

Table full_grid(Seeds seeds) {
    Table table{.key = "grid",
                .title = "The full grid: stable stiffness, N/m",
                .unit = "N/m",
                .columns = {},
                .rows = {}};
    const std::array chosen = {way::force, way::planes, way::paper, "last depth kept, 50 ms",
                               way::faded, way::usual,  way::cap,   "planes, passivity control"};
    for (const char* name : chosen) table.columns.emplace_back(name);
    for (const double mass : {0.10, 0.25})
        for (const double rate : {500.0, 1000.0, 4000.0, 10'000.0})
            for (const double recovery : {0.005, 0.01, 0.05})
                for (const double quantum : {10e-6, 30e-6, 100e-6})
                    for (const double delay : {0.0, 1e-3})
                        for (const double grip : {0.5, 1.0})
                            for (const double update_rate : {10.0, 20.0, 50.0})
                                for (const double damping : {0.0, 2.0})
                                    for (const bool rough : {false, true}) {
                                        Conditions c;
                                        c.mass = mass, c.rate = rate, c.quantum = quantum, c.delay = delay,
                                        c.grip = grip;
                                        c.update_rate = update_rate, c.answer = 0.5 / update_rate,
                                        c.virtual_damping = damping;
                                        c.ridge = rough ? harsh_ridge : gentle_ridge;
                                        table.rows.push_back(
                                            {fmt::format("{:g} kg, {:g} Hz, {:g} ms, {:g} um, delay {:g} ms, "
                                                         "grip {:g}, {:g} Hz, bv {:g}, {}",
                                                         mass, rate, recovery * 1e3, quantum * 1e6,
                                                         delay * 1e3, grip, update_rate, damping,
                                                         rough ? "harsh" : "gentle"),
                                             0,
                                             [c, recovery, chosen, seeds] {
                                                 std::vector<Value> values;
                                                 for (const char* name : chosen) {
                                                     Conditions one = with(c, method(name));
                                                     if (one.method.recovery != 0)
                                                         one.method.recovery = recovery;
                                                     values.push_back(largest(one, seeds));
                                                 }
                                                 return values;
                                             },
                                             {}});
                                    }
    return table;
}

}  // namespace stability
