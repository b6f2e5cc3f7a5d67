#include "pull_bound.hpp"

#include <algorithm>
#include <cmath>

namespace dock {

namespace {

constexpr double k = 0.0019872;  // kcal/mol/K
// A for 1 kcal/mol/A until it is measured: in a frame, or in each of its steps if that is more (water's
// oxygen moves 0.7e-3 in 1 fs).
constexpr double unknown = 1, unknown_in_a_step = 1e-3;
constexpr std::uint64_t learnt = 10;  // frames
constexpr double forget = 0.97;       // per frame, as in Coupling
// Share of the box's edge by which a pull may move an atom in a frame. The rest of the half edge is for
// thermal motion: four standard deviations of water's oxygen in a frame of 2.3 ps in the box of 216.
constexpr double farthest = 0.2;

}  // namespace

double PullBound::force(const Frame& frame) {
    usual_steps_ = usual_steps_ > 0 ? forget * usual_steps_ + (1 - forget) * frame.steps : frame.steps;
    double way = frame.way * std::max(1.0, frame.steps / usual_steps_);
    if (++frames_ <= learnt) way = std::max({way, unknown, unknown_in_a_step * frame.steps});
    if (!(way > 0)) return std::numeric_limits<double>::infinity();
    const double tellable = farthest * box_ / way;
    if (std::isnan(frame.temperature)) return tellable;
    const double room = std::max(0.0, greatest_ - frame.temperature);
    const double energy = 1.5 * k * static_cast<double>(frame.atoms) * room / 2;
    return std::min(tellable, std::sqrt(std::max(0.0, energy - way * frame.pushed * frame.pushed) / way));
}

}  // namespace dock
