#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/protocol/report.hpp>

namespace surface {
namespace {

constexpr double settling = 0.4;  // s at the start of the rest in which the last oscillation may die away

}  // namespace

Eigen::Vector3d true_force(const Terrain::Foot& foot, const Ideal& ideal) {
    double size = ideal.stiffness * std::max(0.0, -foot.distance);
    if (ideal.greatest_force > 0) size = std::min(size, ideal.greatest_force);
    return size * foot.normal;
}

namespace {

/// What one cycle and the one before it say of the servo, and the step of force between them.
void judge_pair(const Cycle& before, const Cycle& cycle, const Span& span, const Thresholds& limits,
                Judgement& result) {
    result.missed += cycle.number - before.number - 1;
    result.stalls += before.active && !cycle.active;
    result.late += cycle.late_count - before.late_count;
    // A step of force always counts, also at the first touch.
    if (cycle.number != before.number + 1) return;
    const double periods = cycle.gap > 1.5 * span.period ? cycle.gap / span.period : 1;
    const double jump = (cycle.force - before.force).norm() / periods;
    result.jumps += jump > limits.jump;
    if (jump > result.jump) result.jump = jump, result.jump_at = cycle.t;
}

/// What is summed from the first touch on.
struct Touch {
    std::uint64_t judged = 0, inside = 0;  // cycles
    double squares = 0, forces = 0;        // N^2, N
    double lowest = 0, highest = 0;        // m, at rest
    bool resting = false;

    void add(const Cycle& cycle, const Terrain::Foot& foot, const Ideal& ideal, const Span& span,
             Judgement& result) {
        ++judged;
        inside += foot.distance < 0;
        const Eigen::Vector3d wanted = true_force(foot, ideal);
        squares += (cycle.force - wanted).squaredNorm();
        forces += wanted.norm();
        if (const double away = cycle.velocity.dot(foot.normal); away > result.kick)
            result.kick = away, result.kick_at = cycle.t;
        if (cycle.t < span.rest_at + settling) return;
        lowest = resting ? std::min(lowest, foot.distance) : foot.distance;
        highest = resting ? std::max(highest, foot.distance) : foot.distance;
        resting = true;
    }
    void sum_up(const Span& span, Judgement& result) const {
        if (judged > 0) {
            const auto n = static_cast<double>(judged);
            result.force_error = std::sqrt(squares / n);
            result.mean_force = forces / n;
            result.contact_share = static_cast<double>(inside) / n;
            result.contact = static_cast<double>(inside) * span.period;
        }
        if (resting) result.limit_cycle = 0.5 * (highest - lowest);
    }
};

}  // namespace

Judgement judge(const std::vector<Cycle>& cycles, const std::vector<Terrain::Foot>& feet, const Ideal& ideal,
                const Span& span, const Thresholds& limits) {
    if (feet.size() != cycles.size()) throw std::invalid_argument("judge: one foot per cycle");
    Judgement result;
    Touch touch;
    bool touched = false;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        const Cycle& cycle = cycles[i];
        if (cycle.t > span.end) break;
        if (cycle.faults != 0) {
            result.fault_at = cycle.t;
            result.faults = cycle.faults;
            break;
        }
        ++result.cycles;
        if (i > 0) judge_pair(cycles[i - 1], cycle, span, limits, result);
        const Terrain::Foot& foot = feet[i];
        touched = touched || foot.distance < 0;
        if (!touched) continue;
        if (i > 0 && foot.distance < 0 && feet[i - 1].distance < 0)
            result.travel += (foot.point - feet[i - 1].point).norm();
        touch.add(cycle, foot, ideal, span, result);
    }
    touch.sum_up(span, result);
    return result;
}

std::optional<bool> Judgement::stable(const Thresholds& limits) const {
    if (fault_at || jump > limits.jump || kick > limits.kick || limit_cycle.value_or(0) >= limits.limit_cycle)
        return false;
    return unseen().empty() ? std::optional(true) : std::nullopt;
}

std::string Judgement::unseen(const Seen& needed) const {
    constexpr const char* remedy = "does the servo play the stroke (knurld --hand, of --write-stroke)?";
    if (contact == 0) return fmt::format("the hand never touched the surface; {}", remedy);
    if (contact < needed.contact)
        return fmt::format("the hand touched the surface for {:.0f} ms only; {}", contact * 1e3, remedy);
    if (travel < needed.travel)
        return fmt::format("the hand went {:.1f} mm along the surface only; {}", travel * 1e3, remedy);
    if (!limit_cycle) return "the hand was not seen at rest";
    const double all = static_cast<double>(cycles + missed);
    if (static_cast<double>(missed) > needed.missed * all)
        return fmt::format("{} of {:.0f} reports were missed: a jump between them is not seen", missed, all);
    return "";
}

std::string Judgement::verdict(const Thresholds& limits) const {
    if (fault_at) return fmt::format("faulted at t = {:.2f} s ({})", *fault_at, fault_text(faults));
    const std::optional<bool> judged = stable(limits);
    if (!judged) return "no verdict: " + unseen();
    if (*judged) return "stable";
    std::string why;
    const auto add = [&](bool broken, const char* what) {
        if (broken) why += (why.empty() ? "" : ", ") + std::string(what);
    };
    add(jump > limits.jump, "jump");
    add(kick > limits.kick, "kick");
    add(limit_cycle.value_or(0) >= limits.limit_cycle, "limit cycle");
    return "not stable: " + why;
}

std::string fault_text(std::uint32_t faults) {
    static constexpr struct {
        std::uint32_t bit;
        const char* text;
    } names[] = {
        {knurl::fault::not_finite, "force not finite"},
        {knurl::fault::slew, "force changed too fast"},
        {knurl::fault::speed, "hand too fast"},
        {knurl::fault::power, "too much power into the hand"},
        {knurl::fault::unplugged, "device unplugged"},
        {knurl::fault::bad_samples, "bad samples"},
        {knurl::fault::encoder_jump, "encoder jump"},
        {knurl::fault::clock_jump, "clock jump"},
        {knurl::fault::kinematics, "no pose for the joints"},
        {knurl::fault::guardian, "servo stalled"},
        {knurl::fault::overload, "cycles longer than the period"},
        {knurl::fault::unguarded, "guardian stood still"},
    };
    std::string text;
    for (const auto& [bit, name] : names)
        if (faults & bit) text += (text.empty() ? "" : ", ") + std::string(name);
    return text.empty() ? fmt::format("fault {:#x}", faults) : text;
}

}  // namespace surface
