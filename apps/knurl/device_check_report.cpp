#include <map>

#include <fmt/format.h>

#include <knurl/json/json.hpp>

#include "device_check.hpp"

namespace knurl::cli {

namespace {

using Eigen::Vector3d;
using json = knurl::Json;

std::string at(const Vector3d& v) {
    return fmt::format("({:.3f} {:.3f} {:.3f})", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}
std::string along(const Vector3d& v) {
    return fmt::format("({:.2f} {:.2f} {:.2f})", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

json list(const Vector3d& v) {
    return json::array({v.x(), v.y(), v.z()});
}
json extreme(const Extreme& e, const char* place) {
    return {{"value", e.value}, {place, list(e.where)}};
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

/// What a user should know before using the arm.
std::vector<std::string> remarks(const CheckedArm& arm, const ArmCheck& c) {
    std::vector<std::string> all;
    if (!arm.unlimited.empty()) {
        all.push_back(
            fmt::format("limits of {} are not known: its reach is that of its links alone",
                        arm.unlimited.size() == arm.axis_names.size() ? "all axes" : joined(arm.unlimited)));
    }
    if (c.out_of_reach > 0) {
        all.push_back(
            fmt::format("{:.1f} % of the stated workspace is out of reach: {} stops it at {:.3f} m; make "
                        "radius smaller or move centre",
                        100 * c.out_of_reach, c.ball_stop, c.ball));
    }
    if (c.badly_conditioned > 0) {
        all.push_back(
            fmt::format("{:.1f} % of the workspace has a condition above 20: there the tip hardly moves in "
                        "one direction",
                        100 * c.badly_conditioned));
    }
    if (arm.profile.peak_force > c.weakest_anywhere.value * 1.001) {
        all.push_back(
            fmt::format("the stated peak force, {:.2f} N, is more than the motors hold everywhere "
                        "({:.2f} N at {} m): there all axes are scaled down together",
                        arm.profile.peak_force, c.weakest_anywhere.value, at(c.weakest_anywhere.where)));
    }
    return all;
}

}  // namespace

std::string report_text(const CheckedArm& arm, const ArmCheck& c) {
    const drivers::SimProfile& p = arm.profile;
    fmt::memory_buffer text;
    const auto line = [&text](const std::string& words) {
        fmt::format_to(std::back_inserter(text), "{}\n", words);
    };
    line(fmt::format("{}: {}", p.name, p.description));
    std::map<std::string, int> sources;
    for (const drivers::ArmFigure& figure : arm.figures) ++sources[figure.source];
    for (const auto& [source, count] : sources)
        line(fmt::format("  {:<22}{} ({} figure{})", "source", source, count, count == 1 ? "" : "s"));
    line(fmt::format("  {:<22}{} sensed, {} driven; {}", "axes", p.joints, p.joints - p.passive_joints,
                     p.renders_torque       ? "force and torque"
                     : p.senses_orientation ? "force; orientation is sensed, no torque"
                                            : "force; no orientation"));
    line("workspace (m, about its centre)");
    line(fmt::format("  {:<22}x {:.3f} to {:.3f}, y {:.3f} to {:.3f}, z {:.3f} to {:.3f}", "reach", c.low.x(),
                     c.high.x(), c.low.y(), c.high.y(), c.low.z(), c.high.z()));
    line(fmt::format("  {:<22}radius {:.3f}; towards {} {} stops it", "largest ball", c.ball,
                     along(c.ball_end), c.ball_stop.empty() ? "nothing" : c.ball_stop));
    line(fmt::format("  {:<22}radius {:.3f}, {}", "stated", p.workspace_radius,
                     c.out_of_reach > 0 ? fmt::format("{:.1f} % out of reach", 100 * c.out_of_reach)
                                        : std::string("all in reach")));
    line("Jacobian's condition over it (1: alike in all directions)");
    line(fmt::format("  {:<22}{:.2f}, median {:.2f}, {:.2f} at {}", "best, worst", c.best_condition.value,
                     c.median_condition.value, c.worst_condition.value, at(c.worst_condition.where)));
    line(fmt::format(
        "  {:<22}{}", "singular postures",
        c.singular ? fmt::format("the nearest {:.3f} m away, at {}", c.singular->value, at(c.singular->where))
                   : std::string("none within reach")));
    line("largest force (N, before the first motor is at its limit)");
    line(fmt::format("  {:<22}{:.2f} along {}, by {}", "weakest at the centre", c.weakest_at_centre.value,
                     along(c.weakest_at_centre.where), c.weakest_axis));
    line(fmt::format("  {:<22}x {:.2f}, y {:.2f}, z {:.2f}; most {:.2f} along {}", "there along",
                     c.along_axes.x(), c.along_axes.y(), c.along_axes.z(), c.strongest_at_centre.value,
                     along(c.strongest_at_centre.where)));
    line(fmt::format("  {:<22}{:.2f} at {}", "weakest anywhere", c.weakest_anywhere.value,
                     at(c.weakest_anywhere.where)));
    line(fmt::format("  {:<22}{:.2f} peak, {:.2f} for ever", "stated", p.peak_force,
                     p.continuous_force > 0 ? p.continuous_force : p.peak_force / 2));
    if (p.renders_torque) {
        line("largest torque (N m, likewise, at the centre)");
        line(fmt::format("  {:<22}x {:.3f}, y {:.3f}, z {:.3f}", "about", c.torque_about_axes.x(),
                         c.torque_about_axes.y(), c.torque_about_axes.z()));
        line(fmt::format("  {:<22}{:.3f} peak", "stated", p.peak_torque));
    }
    line("resolution (micrometres at the tip, one count of the coarsest axis)");
    line(fmt::format("  {:<22}{:.1f} at the centre, median {:.1f}, worst {:.1f} at {}", "encoders",
                     1e6 * c.resolution_at_centre, 1e6 * c.median_resolution, 1e6 * c.worst_resolution.value,
                     at(c.worst_resolution.where)));
    if (p.renders_torque) {
        line(fmt::format("  {:<22}{:.2f} mrad at the centre", "angular, encoders",
                         1e3 * c.angular_resolution));
    }
    if (!arm.assumed.empty()) line("assumed where the file says nothing (for simulation)");
    for (const std::string& each : arm.assumed) line("  " + each);
    for (const std::string& each : remarks(arm, c)) line("note: " + each);
    return fmt::to_string(text);
}

std::string report_json(const CheckedArm& arm, const ArmCheck& c) {
    const drivers::SimProfile& p = arm.profile;
    json figures = json::array();
    for (const drivers::ArmFigure& f : arm.figures)
        figures.push_back({{"name", f.name}, {"stated", f.value}, {"source", f.source}});
    json directions = json::array();
    for (const Extreme& way : c.every_way_at_centre) directions.push_back(extreme(way, "along"));
    const json report = {
        {"name", p.name},
        {"description", p.description},
        {"axes", {{"names", arm.axis_names}, {"sensed", p.joints}, {"driven", p.joints - p.passive_joints}}},
        {"workspace",
         {{"radius", p.workspace_radius},
          {"low", list(c.low)},
          {"high", list(c.high)},
          {"ball", c.ball},
          {"ball_direction", list(c.ball_end)},
          {"ball_stop", c.ball_stop.empty() ? json() : json(c.ball_stop)},
          {"out_of_reach", c.out_of_reach}}},
        {"condition",
         {{"best", c.best_condition.value},
          {"median", c.median_condition.value},
          {"worst", extreme(c.worst_condition, "at")},
          {"above_20", c.badly_conditioned},
          {"singular", c.singular ? extreme(*c.singular, "at") : json()}}},
        {"force",
         {{"weakest_at_centre", extreme(c.weakest_at_centre, "along")},
          {"weakest_axis", c.weakest_axis},
          {"along_axes", list(c.along_axes)},
          {"strongest_at_centre", extreme(c.strongest_at_centre, "along")},
          {"directions", directions},
          {"weakest", extreme(c.weakest_anywhere, "at")},
          {"peak", p.peak_force}}},
        {"torque", p.renders_torque ? json{{"about_axes", list(c.torque_about_axes)}, {"peak", p.peak_torque}}
                                    : json()},
        {"resolution",
         {{"centre", c.resolution_at_centre},
          {"median", c.median_resolution},
          {"worst", extreme(c.worst_resolution, "at")},
          {"angular", p.renders_torque ? json(c.angular_resolution) : json()}}},
        {"assumed", arm.assumed},
        {"notes", remarks(arm, c)},
        {"figures", figures}};
    return report.dump(1) + "\n";
}

}  // namespace knurl::cli
