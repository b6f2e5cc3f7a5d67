#include "summary.hpp"

#include <cmath>

#include <fmt/format.h>

#include <knurl/json/json.hpp>
#include <knurl/measure/output_file.hpp>

namespace dock {

namespace {

constexpr double kj_per_kcal = 4.184;

}  // namespace

Summary summarise(const Docked& docked, const DockOptions& options) {
    Summary s;
    double squares = 0, lengths = 0;
    std::size_t held = 0;
    const Cycle *before = nullptr, *first = nullptr;
    for (const Cycle& cycle : docked.cycles) {
        // After a long stop of the servo the hand has moved on: that step is not counted.
        if (before != nullptr && cycle.number == before->number + 1 && cycle.on_time && cycle.told &&
            before->told) {
            const double step = (cycle.force - before->force).norm();
            s.step = std::max(s.step, step);
            s.end_step = std::max(s.end_step, step - options.stiffness * (cycle.hand - before->hand).norm());
        }
        before = &cycle;
        s.peak_force = std::max(s.peak_force, cycle.force.norm());
        if (cycle.frame == 0) continue;
        if (first == nullptr) first = &cycle;
        ++held;
        squares += cycle.force.squaredNorm();
        lengths += (cycle.atom - cycle.hand).squaredNorm();
        s.moved = std::max(s.moved, (cycle.atom - first->atom).norm() * 1e3 / options.scale);
    }
    if (held > 0) {
        s.rms_force = std::sqrt(squares / static_cast<double>(held));
        s.rms_length = std::sqrt(lengths / static_cast<double>(held));
        s.seconds = static_cast<double>(held) * 1e-3;
    }
    const auto& a = docked.account;
    s.hand_in = a.hand_in, s.hand = a.hand, s.body = a.body, s.lost = a.lost, s.spring = a.spring;
    s.created = a.created, s.most_created = a.most_created;
    s.created_share = a.hand_in > 0 ? a.created / a.hand_in : 0;
    const double kj = docked.energy_scale * kj_per_kcal;
    s.hand_kj = a.hand * kj, s.body_kj = a.body * kj;
    const FrameSeen *begin = nullptr, *end = nullptr;
    std::size_t warm = 0;
    for (const FrameSeen& frame : docked.frames) {
        if (frame.step < 0) continue;
        if (begin == nullptr) begin = &frame;
        end = &frame;
        ++warm;
        s.temperature += frame.temperature;
        s.peak_temperature = std::max(s.peak_temperature, frame.temperature);
    }
    if (warm > 1) {
        s.temperature /= static_cast<double>(warm);
        s.frames_per_second = static_cast<double>(warm - 1) / std::max(1e-3, end->t - begin->t);
        s.simulation_tells = true;
        s.simulation_kj = end->total_energy - begin->total_energy;
        // The account of a frame is stored before that frame is counted in it.
        s.body_kj = (a.body - begin->account.body) * kj;
    }
    return s;
}

std::string text_of(const Summary& s, const Docked& d, const DockOptions& o) {
    std::string text;
    const auto line = [&]<class... T>(fmt::format_string<T...> form, T&&... values) {
        text += "  " + fmt::format(form, std::forward<T>(values)...) + "\n";
    };
    if (d.frames.empty()) return "  no atom was held\n";
    line("{:.1f} s, {} frames ({:.1f} a second, each {} steps; {:.0f} steps/s)", s.seconds, d.frames.size(),
         s.frames_per_second, d.steps_per_frame, d.steps_per_second);
    line("force on the hand {:.2f} N rms, {:.2f} N at most; largest step {:.3f} N in a cycle", s.rms_force,
         s.peak_force, s.step);
    line("hand to atom {:.1f} mm rms, where the spring alone would be {:.1f} mm; the atom went {:.2f} nm",
         s.rms_length * 1e3, s.rms_force / o.stiffness * 1e3, s.moved);
    line(
        "the hand put in {:.3f} J and got {:.3f} J back; {:.3f} J went to the atom, {:.3f} J were lost "
        "between",
        s.hand_in, s.hand_in - s.hand, s.body, s.lost);
    line(
        "the coupling created {:.2g} J, {:.2f} % of what the hand put in (while a frame was under way {:.2g} "
        "J)",
        s.created, 100 * s.created_share, s.most_created);
    line(
        "in the simulation's units: {:.1f} kJ/mol by the hand, {:.1f} kJ/mol on the atom (sum of force times "
        "way)",
        s.hand_kj, s.body_kj);
    if (s.simulation_tells) {
        line(
            "the simulation says: total energy {:+.1f} (kJ/mol from GROMACS; a thermostat takes out what is "
            "put in), "
            "{:.0f} K mean, {:.0f} K at most",
            s.simulation_kj, s.temperature, s.peak_temperature);
    } else {
        line("the simulation does not report its energy");
    }
    const auto note = [&](std::uint64_t count, const std::string& what) {
        if (count > 0) line("in {} of {} frames {}", count, d.counts.frames, what);
    };
    note(d.counts.bounded,
         fmt::format("the force on the atom was bounded: to {:g} kcal/mol/A, so that it stays below {:g} K{}",
                     o.greatest_force, o.greatest_temperature,
                     o.box > 0 ? ", or so that one can tell where in its box it goes" : ""));
    note(d.hot, fmt::format("the atom was not pulled: above {:g} K", o.greatest_temperature));
    note(d.counts.short_of,
         "the spring was shorter than the way to the atom: its account could not pay for more");
    note(d.counts.jumps, "the atom jumped, which counts as no work");
    if (d.counts.stops > 0) line("the simulation stopped {} times; the spring faded", d.counts.stops);
    if (d.unread > 0) line("{} reports were not read", d.unread);
    return text;
}

std::string json_of(const Summary& s, const Docked& d, const DockOptions& o) {
    const knurl::Json json = {
        {"rate", o.rate},
        {"stiffness", o.stiffness},
        {"scale_mm_per_nm", o.scale},
        {"force_scale_mn_per_pn", o.force_scale},
        {"keep_account", o.keep_account},
        {"atoms", d.atoms},
        {"atom", d.atom < 0 ? knurl::Json(nullptr) : knurl::Json(d.atom)},
        {"held_s", s.seconds},
        {"frames", d.frames.size()},
        {"frames_per_second", s.frames_per_second},
        {"steps_per_second", d.steps_per_second},
        {"rms_force", s.rms_force},
        {"peak_force", s.peak_force},
        {"step", s.step},
        {"end_step", s.end_step},
        {"rms_length", s.rms_length},
        {"moved_nm", s.moved},
        {"hand_in", s.hand_in},
        {"hand", s.hand},
        {"body", s.body},
        {"lost_between", s.lost},
        {"created", s.created},
        {"most_created", s.most_created},
        {"created_share", s.created_share},
        {"hand_kj_per_mol", s.hand_kj},
        {"body_kj_per_mol", s.body_kj},
        {"simulation_kj_per_mol", s.simulation_tells ? knurl::Json(s.simulation_kj) : nullptr},
        {"temperature", s.simulation_tells ? knurl::Json(s.temperature) : nullptr},
        {"peak_temperature", s.simulation_tells ? knurl::Json(s.peak_temperature) : nullptr},
        {"bounded", d.counts.bounded},
        {"hot", d.hot},
        {"short_of", d.counts.short_of},
        {"jumps", d.counts.jumps},
        {"stops", d.counts.stops},
        {"unread", d.unread},
        {"late", d.late},
        {"faults", d.faults},
        {"ended", d.ended.empty() ? knurl::Json(nullptr) : knurl::Json(d.ended)},
    };
    return json.dump(1) + "\n";
}

void write_csv(const std::string& path, const Docked& docked) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(
        out, "t,hand_x,hand_y,hand_z,fx,fy,fz,atom_x,atom_y,atom_z,push_x,push_y,push_z,frame,cycle,told\n");
    for (const Cycle& c : docked.cycles)
        fmt::format_to(out,
                       "{:.6f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{"
                       ":.9g},{},{},{}\n",
                       c.t, c.hand.x(), c.hand.y(), c.hand.z(), c.force.x(), c.force.y(), c.force.z(),
                       c.atom.x(), c.atom.y(), c.atom.z(), c.atom_force.x(), c.atom_force.y(),
                       c.atom_force.z(), c.frame, c.number, c.told ? 1 : 0);
    knurl::measure::write_file(path, fmt::to_string(text));
}

}  // namespace dock
