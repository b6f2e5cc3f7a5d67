// What a trial's figures mean for the owner of the device.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <knurl/servo/servo.hpp>

#include "device_trial.hpp"

namespace knurl::cli {

namespace {

double largest_delay(const Trial& trial) {
    double delay = 0;
    for (const PushTrial& push : trial.pushes) delay = std::max(delay, push.delay);
    return delay;
}

}  // namespace

std::string axis_name(const PushTrial& push) {
    return push.axis.x() != 0 ? "x" : push.axis.y() != 0 ? "y" : "z";
}

double promised_alone(const drivers::LinkConfig& link, double rate) {
    drivers::LinkConfig alone = link;
    alone.grip_damping = alone.measured_max_stiffness = 0;
    return alone.damping > 0 ? servo::max_stiffness(alone, rate) : 0;
}

std::vector<std::string> findings(const Trial& trial) {
    std::vector<std::string> lines;
    const RestTrial& rest = trial.rest;
    const double share = static_cast<double>(rest.fresh) / static_cast<double>(rest.cycles);
    if (share < bounds::fresh)
        lines.push_back(
            fmt::format("only {:.1f} % of the cycles had a new sample: lower the rate, or look at the cable",
                        100 * share));
    if (rest.bad > 0)
        lines.push_back(fmt::format("{} samples were garbage: another cable or port", rest.bad));
    for (std::size_t j = 0; j < rest.counts_apart.size(); ++j) {
        if (rest.counts_apart[j] > 4)
            lines.push_back(fmt::format(
                "joint {} wanders by {:.0f} counts at rest: is it held? else its encoder is noisy", j + 1,
                rest.counts_apart[j]));
    }
    for (const PushTrial& push : trial.pushes) {
        if (push.cosine == 0)
            lines.push_back(
                fmt::format("a push along {} moves nothing: motors off, or friction above the push (--push)",
                            axis_name(push)));
        else if (push.cosine < 0)
            lines.push_back(
                fmt::format("a push along {} moves it the other way: a motor's or encoder's sign is wrong",
                            axis_name(push)));
        else if (push.cosine < bounds::push_cosine)
            lines.push_back(fmt::format(
                "a push along {} goes {:.0f} degrees astray: wrong link lengths, or one motor weaker",
                axis_name(push), std::acos(push.cosine) * 180 / M_PI));
        else if (push.size > 0 && (push.size < bounds::least_size || push.size > bounds::greatest_size))
            lines.push_back(
                fmt::format("a push along {} is {:.2f} times as strong as it should be ({:g} to {:g}): "
                            "calibrate the force",
                            axis_name(push), push.size, bounds::least_size, bounds::greatest_size));
    }
    for (const PushTrial& turn : trial.turns) {
        if (turn.cosine == 0)
            lines.push_back(
                fmt::format("a torque about {} turns nothing: motors off, or friction above it (--push)",
                            axis_name(turn)));
        else if (turn.cosine < 0)
            lines.push_back(
                fmt::format("a torque about {} turns it the other way: a motor's or encoder's sign is wrong",
                            axis_name(turn)));
        else if (turn.cosine < bounds::turn_cosine)
            lines.push_back(fmt::format(
                "a torque about {} turns it {:.0f} degrees astray: one motor weaker, or a lopsided handle",
                axis_name(turn), std::acos(turn.cosine) * 180 / M_PI));
    }
    if (largest_delay(trial) > 2 * trial.link.lag + 1 / trial.rate)
        lines.push_back(
            fmt::format("motion begins {:.2f} ms late, its description says {:.2f} ms: walls can be less "
                        "stiff than it promises",
                        largest_delay(trial) * 1e3, trial.link.lag * 1e3));
    if (trial.link.actuated_joints > 0 && trial.wall.stiffness == 0)
        lines.push_back("no wall at all is stable: do not use it with force");
    else if (trial.wall.stiffness < bounds::wall * trial.wall.predicted)
        lines.push_back(fmt::format(
            "walls hum above {:.0f} N/m, {:.0f} were promised: lower damping or raise lag in its description",
            trial.wall.stiffness, trial.wall.predicted));
    return lines;
}

}  // namespace knurl::cli
