#include "outcome.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include <knurl/measure/output_file.hpp>

namespace surface {

namespace {

/// Root mean square over the cycles with contact or force. N.
std::optional<double> own_error(const Recording& r, const Span& span) {
    double squares = 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < r.own_force.size() && r.cycles[i].t <= span.end && r.cycles[i].faults == 0;
         ++i) {
        if (!r.own_force[i].allFinite() || (r.own_force[i].isZero(0) && r.cycles[i].force.isZero(0)))
            continue;
        squares += (r.cycles[i].force - r.own_force[i]).squaredNorm();
        ++n;
    }
    return n > 0 ? std::optional(std::sqrt(squares / static_cast<double>(n))) : std::nullopt;
}

}  // namespace

Outcome judged(Recording recording, const Terrain& terrain, const Span& span) {
    Outcome outcome{.recording = std::move(recording)};
    const Recording& r = outcome.recording;
    outcome.feet.reserve(r.cycles.size());
    for (const Cycle& cycle : r.cycles) outcome.feet.push_back(terrain.foot(cycle.position));
    outcome.judgement = judge(r.cycles, outcome.feet, {r.stiffness, r.greatest_force}, span);
    outcome.judgement.own_force_error = own_error(r, span);
    outcome.judgement.missed += r.unread;
    outcome.ages = ages_at_use(r);
    return outcome;
}

double quantile(std::vector<double> values, double p) {
    if (values.empty()) return 0;
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(p * static_cast<double>(values.size()))) - 1;
    const auto at = values.begin() + std::clamp<std::ptrdiff_t>(rank, 0, std::ssize(values) - 1);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

std::string machine_sentence(const knurl::measure::Machine& m) {
    return fmt::format("{}, {} CPUs, Linux {}, load {}, {}", m.processor, m.cpus, m.kernel, m.load, m.build);
}

std::string table(const std::vector<Outcome>& outcomes, const RunText& text) {
    std::string out;
    const auto line = [&](const std::string& name, const std::function<std::string(const Outcome&)>& cell) {
        out += fmt::format("{:<33}", name);
        for (const Outcome& outcome : outcomes) out += fmt::format("{:>19}", cell(outcome));
        out += '\n';
    };
    static const auto head = [](Way way) -> std::pair<const char*, const char*> {
        switch (way) {
            case Way::force:
                return {"force from", "the application"};
            case Way::planes:
                return {"planes", "as they come"};
            case Way::paper:
                return {"planes, paper's", "recovery 50 ms"};
            case Way::knurl:
                return {"planes, predicted", "+ faded (Knurl)"};
            case Way::caps:
                return {"caps, predicted", "+ faded (Knurl)"};
            case Way::mesh:
                return {"a mesh, sent", "once (Knurl)"};
            case Way::field:
                return {"a height field,", "sent once (Knurl)"};
        }
        return {"", ""};
    };
    out += fmt::format("{}: {}\n", text.model, text.scale);
    if (!outcomes.empty()) {
        const Recording& r = outcomes.front().recording;
        out += fmt::format(
            "{}, servo {:g} Hz, application {:g} Hz answering {:g} ms late, {:.0f} N/m (k_max {:.0f} N/m)\n",
            text.device, text.servo_rate, text.rate, text.think * 1e3, r.stiffness, r.max_stiffness);
    }
    out += '\n';
    line("", [](const Outcome& o) { return head(o.recording.way).first; });
    line("", [](const Outcome& o) { return head(o.recording.way).second; });
    line("cycles run", [](const Outcome& o) { return fmt::format("{}", o.judgement.cycles); });
    line("late cycles / servo stalls",
         [](const Outcome& o) { return fmt::format("{} / {}", o.judgement.late, o.judgement.stalls); });
    line("reports missed", [](const Outcome& o) { return fmt::format("{}", o.judgement.missed); });
    line("updates", [](const Outcome& o) { return fmt::format("{}", o.recording.updates.size()); });
    line("age of update at use, p50 / max", [](const Outcome& o) {
        return o.ages.empty() ? std::string("none used")
                              : fmt::format("{:.1f} / {:.1f} ms", quantile(o.ages, 0.5) * 1e3,
                                            quantile(o.ages, 1) * 1e3);
    });
    line("largest force jump in a cycle",
         [](const Outcome& o) { return fmt::format("{:.2f} N", o.judgement.jump); });
    line("RMS force error, true surface",
         [](const Outcome& o) { return fmt::format("{:.2f} N", o.judgement.force_error); });
    line("RMS force error, what was sent", [](const Outcome& o) {
        return o.judgement.own_force_error ? fmt::format("{:.2g} N", *o.judgement.own_force_error)
                                           : std::string("-");
    });
    line("largest speed off the surface",
         [](const Outcome& o) { return fmt::format("{:.2f} m/s", o.judgement.kick); });
    line("limit cycle at rest", [](const Outcome& o) {
        return o.judgement.limit_cycle ? fmt::format("{:.3f} mm", *o.judgement.limit_cycle * 1e3)
                                       : std::string("-");
    });
    out += '\n';
    for (const Outcome& o : outcomes)
        out += fmt::format("{:<58}{}{}\n", title_of(o.recording.way, text.rate),
                           o.recording.interrupted ? "interrupted; until then " : "", o.judgement.verdict());
    out += fmt::format(
        "\nstable = jump <= 1 N a cycle, speed off the surface <= 0.3 m/s, limit cycle < 0.1 mm; forces are "
        "the scene's,\nbefore the supervisor. {}, {}\n",
        machine_sentence(text.machine), text.machine.date);
    return out;
}

void write_csv(const std::filesystem::path& file, const std::vector<Outcome>& outcomes,
               const Terrain& terrain) {
    std::string out =
        "way,t,x,y,z,vx,vy,vz,fx,fy,fz,true_fx,true_fy,true_fz,sent_fx,sent_fy,sent_fz,surface_z,height,"
        "faults\n";
    for (const Outcome& outcome : outcomes) {
        const std::string way = key_of(outcome.recording.way);
        const Ideal ideal{outcome.recording.stiffness, outcome.recording.greatest_force};
        for (std::size_t i = 0; i < outcome.recording.cycles.size(); ++i) {
            const Cycle& c = outcome.recording.cycles[i];
            const Terrain::Foot& foot = outcome.feet[i];
            const Eigen::Vector3d wanted = true_force(foot, ideal);
            const auto end = std::back_inserter(out);
            fmt::format_to(end, "{},{:.6f}", way, c.t);
            const Eigen::Vector3d sent =
                outcome.recording.own_force.empty()
                    ? Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())
                    : outcome.recording.own_force[i];
            for (const auto& v : {c.position, c.velocity, c.force, wanted, sent})
                fmt::format_to(end, ",{:.7g},{:.7g},{:.7g}", v.x(), v.y(), v.z());
            fmt::format_to(end, ",{:.7g},{:.7g},{}\n", terrain.height(c.position.x(), c.position.y()),
                           foot.distance, c.faults);
        }
    }
    knurl::measure::write_file(file, out);
}

void write_relief(const std::filesystem::path& file, const Terrain& terrain) {
    const HeightGrid& grid = terrain.grid();
    std::string out = fmt::format(
        "ncols {}\nnrows {}\nxllcenter {:.6g}\nyllcenter {:.6g}\ncellsize {:.6g}\nNODATA_value -9999\n",
        grid.columns, grid.rows, -terrain.half_width() * 1e3, -terrain.half_length() * 1e3, grid.cell * 1e3);
    for (int r = 0; r < grid.rows; ++r)
        for (int c = 0; c < grid.columns; ++c)
            fmt::format_to(std::back_inserter(out), "{:.5g}{}",
                           1e3 * terrain.height(c * grid.cell - terrain.half_width(),
                                                terrain.half_length() - r * grid.cell),
                           c + 1 == grid.columns ? '\n' : ' ');
    knurl::measure::write_file(file, out);
}

}  // namespace surface
