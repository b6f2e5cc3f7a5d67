#include "relief_stroke.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <surface/relief.hpp>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/servo/offline.hpp>

#include "application.hpp"
#include "cases.hpp"

namespace stability {
namespace {

constexpr double demo_stiffness = 2000;  // N/m
constexpr double patience = 2;           // s, for the device to become active

knurl::SurfaceModel model_of(const surface::Terrain& terrain) {
    return [&terrain](const knurl::Vec3& near) {
        const auto foot = terrain.foot(knurl::to_eigen(near));
        return knurl::SurfacePoint{knurl::to_plain(foot.point), knurl::to_plain(foot.normal)};
    };
}

knurl::drivers::Motion motion_of(const surface::Stroke& path) {
    std::vector<knurl::drivers::MotionRow> rows;
    for (const auto& row : path.rows) rows.push_back({.t = row.t, .position = row.position});
    return knurl::drivers::Motion(std::move(rows));
}

}  // namespace

ReliefStroke ReliefStroke::of(const std::filesystem::path& model) {
    surface::Terrain terrain(surface::make_relief(surface::load_elevation(model), {}).grid);
    surface::Stroke path = make_stroke(terrain, {});
    return {std::move(terrain), std::move(path)};
}

surface::Judgement relief_stroke(const ReliefStroke& stroke, const Conditions& conditions, double stiffness,
                                 double phase) {
    Conditions c = conditions;
    const knurl::drivers::SimProfile profile = knurl::drivers::sim_profile("premium15");
    c.peak_force = profile.peak_force;
    knurl::drivers::SimDevice device(profile, motion_of(stroke.path));
    knurl::servo::ServoOptions options;
    options.rate = c.rate;
    options.silence = false;
    knurl::servo::Offline servo(device, options);
    knurl::servo::ClaimTerms terms;
    terms.limits = knurl::servo::limits_for(device.link(), c.rate, terms.frame);
    terms.update_interval = c.interval();
    knurl::servo::OfflineClaim& claim = servo.claim(std::move(terms));

    // The demo's model knows no curvatures; for caps it computes them as the manual says.
    const knurl::SurfaceModel model = model_of(stroke.terrain);
    Application application(c, stiffness, phase,
                            c.method.kind == Method::Kind::cap ? knurl::curved(model) : model);
    std::vector<knurl::RepresentationId> there;
    const auto add = [&](const auto& params) { return claim.add(params); };
    const auto update = [&](knurl::RepresentationId id, const auto& params) { claim.update(id, params); };
    put(application.first(stroke.path.rows.front().position), there, add, update);
    claim.arm();
    const surface::Span span{.rest_at = stroke.path.rest_at, .end = stroke.path.end, .period = c.period()};
    std::vector<surface::Cycle> cycles;
    std::vector<surface::Terrain::Foot> feet;
    double begun = 0;
    for (long i = 0; cycles.empty() || cycles.back().t <= span.end; ++i) {
        const double t = static_cast<double>(i) / c.rate;
        if (application.due(t)) {
            put(application.answer(), there, add, update);
            claim.commit();
        }
        const knurl::Report& report = servo.step();
        application.read(t, knurl::to_eigen(report.position), knurl::to_eigen(report.slow_velocity));
        const bool lives = report.state == knurl::DeviceState::active;
        if (cycles.empty() && !lives) {
            if (t > patience) throw std::runtime_error("the simulated device did not become active");
            continue;
        }
        if (cycles.empty()) begun = t;
        cycles.push_back({.number = report.cycle,
                          .t = t - begun,
                          .position = knurl::to_eigen(report.position),
                          .velocity = knurl::to_eigen(report.velocity),
                          .force = knurl::to_eigen(report.scene_force),
                          .faults = report.faults,
                          .active = lives});
        feet.push_back(stroke.terrain.foot(cycles.back().position));
        if (report.faults != 0) break;
    }
    return judge(cycles, feet, {.stiffness = stiffness, .greatest_force = c.peak_force}, span);
}

Table relief_table(const ReliefStroke& stroke, unsigned phases) {
    Table table{.key = "relief",
                .title = fmt::format("The demo's stroke at {:g} N/m, {} phases", demo_stiffness, phases),
                .unit = "N, m/s, N",
                .digits = 3,
                .columns = {"error, N", "worst", "demo's phase", "off the surface, m/s", "worst ",
                            "demo's phase ", "jump, N", "worst  ", "demo's phase  "},
                .rows = {}};
    for (const char* name : {way::planes, way::faded, way::usual, way::cap})
        table.rows.push_back({name,
                              0,
                              [&stroke, name, phases] {
                                  std::vector<Value> values(9);
                                  for (unsigned i = 0; i < phases; ++i) {
                                      const surface::Judgement judged =
                                          relief_stroke(stroke, with({}, method(name)), demo_stiffness,
                                                        static_cast<double>(i) / phases);
                                      const double figures[] = {judged.force_error, judged.kick, judged.jump};
                                      for (std::size_t k = 0; k < 3; ++k) {
                                          values[3 * k].value += figures[k] / phases;
                                          values[3 * k + 1].value =
                                              std::max(values[3 * k + 1].value, figures[k]);
                                          if (i == 0) values[3 * k + 2].value = figures[k];
                                      }
                                  }
                                  return values;
                              },
                              {}});
    return table;
}

}  // namespace stability
