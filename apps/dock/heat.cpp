#include "heat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dock {

namespace {

constexpr double k = 0.0019872;       // kcal/mol/K
constexpr double unknown = 1;         // A for 1 kcal/mol/A: a few ps in water
constexpr std::uint64_t learnt = 10;  // frames
constexpr double forget = 0.97;       // as Coupling does, in a frame

}  // namespace

double HeatBound::force(const Frame& frame) {
    usual_steps_ = usual_steps_ > 0 ? forget * usual_steps_ + (1 - forget) * frame.steps : frame.steps;
    double way = frame.way * std::max(1.0, frame.steps / usual_steps_);
    if (++frames_ <= learnt) way = std::max(way, unknown);
    if (!(way > 0)) return std::numeric_limits<double>::infinity();
    const double room = std::max(0.0, greatest_ - frame.temperature);
    const double energy = 1.5 * k * static_cast<double>(frame.atoms) * room / 2;
    return std::sqrt(std::max(0.0, energy - way * frame.pushed * frame.pushed) / way);
}

}  // namespace dock
