// The application on another host: how stiff may a wall be, depending on the network?

#include <fmt/format.h>

#include "cases.hpp"
#include "sweep.hpp"
#include "vary.hpp"

namespace stability {

namespace {

using Values = std::initializer_list<double>;

Conditions remote(Conditions c = {}) {
    c.remote = true;
    return c;
}

/// A row for each variant, a column for each method.
Table table_of(const char* key, std::string title, const std::vector<Variant>& variants,
               const std::vector<const char*>& ways, Seeds seeds) {
    Table table{.key = key, .title = std::move(title), .unit = "N/m", .columns = {}, .rows = {}};
    for (const char* name : ways) table.columns.emplace_back(name);
    for (const Variant& v : variants)
        table.rows.push_back({v.name,
                              v.x,
                              [v, ways, seeds] {
                                  std::vector<Value> values;
                                  for (const char* name : ways)
                                      values.push_back(largest(with(v.c, method(name)), seeds));
                                  return values;
                              },
                              {}});
    return table;
}

}  // namespace

std::vector<Table> network_tables(Seeds seeds) {
    const std::vector<const char*> on_a_wall = {way::force, way::planes, way::usual};
    const std::vector<const char*> compared = {way::force, way::planes, way::faded, way::usual, way::cap};
    const Values delays = {0, 1e-3, 5e-3, 10e-3, 20e-3, 50e-3, 100e-3};
    const auto set_delay = [](Conditions& c, double x) { c.network.delay = x; };
    std::vector<Table> tables;
    std::vector<Variant> v;

    vary(v, "", 1e3, " ms", delays, set_delay, remote(at_rest()));
    tables.push_back(table_of("network_wall",
                              "A flat wall, the hand at rest, by one-way delay: stable stiffness, N/m", v,
                              on_a_wall, seeds));
    v.clear();
    vary(v, "", 1e3, " ms", delays, set_delay, remote());
    tables.push_back(table_of("network_delay", "Gentle .15 m/s, by one-way delay: stable stiffness, N/m", v,
                              compared, seeds));
    v.clear();
    vary(
        v, "", 1e3, " ms", {0, 10e-3, 20e-3, 50e-3, 100e-3, 200e-3},
        [](Conditions& c, double x) { c.network.swing = x; }, remote());
    tables.push_back(table_of("network_swing", "Gentle .15 m/s, by a delay that swings between 0 and: N/m", v,
                              compared, seeds));
    v.clear();
    vary(
        v, "", 100, " %", {0, 0.05, 0.1, 0.2, 0.3},
        [](Conditions& c, double x) { c.network = {.loss = x, .delay = 5e-3, .jitter = 2e-3}; }, remote());
    tables.push_back(
        table_of("network_loss", "Gentle .15 m/s, 5 to 7 ms one way, by loss: N/m", v, compared, seeds));
    return tables;
}

}  // namespace stability
