#include "sweep.hpp"

#include <bit>

#include <fmt/format.h>

#include "bound.hpp"
#include "cases.hpp"
#include "servo_stroke.hpp"
#include "stroke.hpp"

namespace stability {

Table wall_table(Seeds seeds) {
    Table table{.key = "wall",
                .title = "A flat wall, the hand at rest: largest stable stiffness, N/m",
                .unit = "N/m",
                .columns = {"k_max", "the same without dry friction", "b / (late + T/2)"},
                .rows = {}};
    const auto add = [&](const char* name, double rate, double answer, const char* how, bool servos = false) {
        Conditions c = with(at_rest(), method(how));
        c.update_rate = rate;
        c.answer = answer;
        c.rate_is_servos = servos;
        table.rows.push_back({name,
                              rate,
                              [c, seeds] {
                                  Conditions smooth = c;
                                  smooth.coulomb = 0;
                                  // A force from the application is late by its answer and half its interval.
                                  const double late = c.method.kind == Method::Kind::force
                                                          ? c.answer + c.interval() / 2
                                                          : c.period() / 2;
                                  return std::vector<Value>{largest(c, seeds),
                                                            largest(smooth, seeds),
                                                            {c.total_damping() / (late + c.lateness())}};
                              },
                              {}});
    };
    add("force at 20 Hz, 25 ms late", 20, 25e-3, way::force);
    add("force at 20 Hz, at once", 20, 0, way::force);
    add("force at 100 Hz, 5 ms late", 100, 5e-3, way::force);
    add("force at 1 kHz, at once", 1000, 0, way::force, true);
    add("plane at 20 Hz, 25 ms late", 20, 25e-3, way::planes);
    add("plane at 20 Hz, 25 ms late, default", 20, 25e-3, way::usual);
    add("plane at 100 Hz, 5 ms late", 100, 5e-3, way::planes);
    return table;
}

Table method_table(const char* key, const char* title, const Ridge& ridge, Seeds seeds) {
    Table table{.key = key,
                .title = title,
                .unit = "N/m",
                .columns = {"rise", "jump", "kick", "cycle", "power", "jump and kick", "all (stable)"},
                .rows = {}};
    for (const NamedMethod& m : methods()) {
        Conditions c = with({}, m.method);
        c.ridge = ridge;
        table.rows.push_back(
            {m.name,
             0,
             [c, seeds] {
                 return largest_of_each(c, seeds, {rise, jump, kick, cycle, power, goals, strict});
             },
             {}});
    }
    return table;
}

Table speed_table(Seeds seeds) {
    Table table{.key = "speeds",
                .title = "Jump <= 1 N and kick <= 0.3 m/s, by ridge and speed, N/m",
                .unit = "N/m",
                .columns = {"gentle .05", "gentle .10", "gentle .15", "harsh .05", "harsh .10", "harsh .15"},
                .rows = {}};
    for (const NamedMethod& m : methods()) {
        table.rows.push_back({m.name,
                              0,
                              [m, seeds] {
                                  std::vector<Value> values;
                                  for (const Ridge& ridge : {gentle_ridge, harsh_ridge}) {
                                      for (const double speed : {0.05, 0.10, 0.15}) {
                                          Conditions c = with({}, m.method);
                                          c.ridge = ridge;
                                          c.speed = speed;
                                          values.push_back(largest(c, seeds, goals));
                                      }
                                  }
                                  return values;
                              },
                              {}});
    }
    return table;
}

Table error_table(Seeds seeds) {
    Table table{.key = "error",
                .title =
                    "Force error (RMS) against the true surface, 0.10 m/s, k = 1000 N/m, answered after half "
                    "a period, N",
                .unit = "N",
                .digits = 3,
                .columns = {"gentle: planes", "gentle: default", "gentle: cap", "harsh: planes",
                            "harsh: default", "harsh: cap"},
                .rows = {}};
    for (const double rate : {5.0, 10.0, 20.0, 50.0, 100.0, 200.0}) {
        table.rows.push_back({fmt::format("{:g} Hz", rate),
                              rate,
                              [rate, seeds] {
                                  std::vector<Value> values;
                                  for (const Ridge& ridge : {gentle_ridge, harsh_ridge}) {
                                      for (const char* way : {way::planes, way::usual, way::cap}) {
                                          Conditions c = with({}, method(way));
                                          c.ridge = ridge;
                                          c.speed = 0.10;
                                          c.update_rate = rate;
                                          c.answer = 0.5 / rate;
                                          double sum = 0;
                                          for (unsigned seed = seeds.first; seed < seeds.end(); ++seed)
                                              sum += stroke(c, 1000, seed, 0, true).error;
                                          values.push_back({sum / seeds.count});
                                      }
                                  }
                                  return values;
                              },
                              {}});
    }
    return table;
}

Table device_table(Seeds seeds) {
    Table table{.key = "devices",
                .title = "The real servo on simulated devices, 1 kHz, to and fro over 120 mm, N/m",
                .unit = "N/m",
                .columns = {"bound", "wall", way::planes, way::paper, way::faded, way::usual, way::cap},
                .rows = {}};
    Conditions stroked;
    stroked.reach = 60e-3;
    const std::vector<std::string> ways(table.columns.begin() + 2, table.columns.end());
    for (const char* name : {"cartesian3", "premium15", "generic6"}) {
        table.rows.push_back({name,
                              0,
                              [name, stroked, ways, seeds] {
                                  std::vector<Value> values{{bound(with_profile(name, stroked))},
                                                            largest_on(name, at_rest(), seeds)};
                                  for (const std::string& way : ways)
                                      values.push_back(largest_on(name, with(stroked, method(way)), seeds));
                                  return values;
                              },
                              {}});
    }
    // The bench of all other tables, on the same stroke: how well it represents the real servo.
    table.rows.push_back({"the bench, as cartesian3",
                          0,
                          [stroked, ways, seeds] {
                              std::vector<Value> values{{bound(stroked)}, largest(at_rest(), seeds)};
                              for (const std::string& way : ways)
                                  values.push_back(largest(with(stroked, method(way)), seeds));
                              return values;
                          },
                          {}});
    return table;
}

Table paper_wall_table(Seeds seeds) {
    Table table{.key = "premium15",
                .title = "premium15 at 2100 N/m, the paper's figure: worst of all seeds",
                .unit = "",
                .digits = 3,
                .columns = {"jump, N", "rise, N", "kick, m/s", "limit cycle, mm", "power, W", "broken"},
                .rows = {}};
    const auto add = [&](std::string name, const Conditions& c) {
        table.rows.push_back(
            {std::move(name),
             0,
             [c, seeds] {
                 Figures worst;
                 for (unsigned seed = seeds.first; seed < seeds.end(); ++seed)
                     worst.worst_of(servo_stroke("premium15", c, 2100, seed, 0));
                 return std::vector<Value>{
                     {worst.jump},  {worst.rise},
                     {worst.kick},  {worst.cycle * 1e3},
                     {worst.power}, {static_cast<double>(std::popcount(worst.broken() & strict))}};
             },
             {}});
    };
    add("wall, at rest", at_rest());
    for (const double speed : {0.05, 0.15}) {
        for (const char* way : {way::planes, way::paper, way::usual, way::cap}) {
            Conditions c = with({}, method(way));
            c.reach = 60e-3;
            c.speed = speed;
            add(fmt::format("gentle {:.2f} m/s, {}", speed, way), c);
        }
    }
    return table;
}

}  // namespace stability
