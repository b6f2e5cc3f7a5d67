#include "compare.hpp"

#include <cmath>
#include <functional>

#include "trial.hpp"

namespace bodies {

namespace {

struct Case {
    std::string what;
    Body body;
    Script script;
    double from, until;  // s: the part in which the contact is steady
};

Case pressed() {
    Script script({0, 0, 0.02});
    script.rest(0.3).to({0, 0, -0.016}, 0.05).rest(1);
    const double from = script.end();
    script.rest(2);
    return {"a box of 200 g on the floor, pressed from above",
            {.name = "box", .half = {0.02, 0.02, 0.02}, .mass = 0.2, .position = {0, 0, -0.03}},
            script,
            from,
            script.end()};
}

Case pushed() {
    Script script({-0.06, 0, 0});
    script.rest(0.3).to({-0.06, 0, -0.03}, 0.1).to({-0.025, 0, -0.03}, 0.03);
    const double begin = script.end();
    script.to({0.05, 0, -0.03}, 0.05);
    return {"a box of 100 g on the floor, pushed along it",
            {.name = "box", .half = {0.02, 0.02, 0.02}, .mass = 0.1, .position = {0, 0, -0.03}},
            script,
            begin + 0.3 * (script.end() - begin),
            begin + 0.6 * (script.end() - begin)};
}

/// The mean measured stiffness, N/m. Nothing: not stable. Stable means that after the start the hand never
/// leaves the body, and that the force varies by less than half of itself (rms).
std::optional<double> stable(const Case& one, const TrialOptions& options) {
    World world({one.body});
    double sum = 0, squares = 0, stiffness = 0;
    std::size_t n = 0, lost = 0;
    const Trial trial = run_trial(world, one.script, options, [&](const Moment& moment) {
        if (moment.t < one.from || moment.t > one.until) return;
        const double force = knurl::to_eigen(moment.report.scene_force).norm();
        lost += force < 1e-3;
        sum += force;
        squares += force * force;
        stiffness += moment.stiffness;
        ++n;
    });
    const double mean = sum / static_cast<double>(n);
    const double shaken = std::sqrt(std::max(0.0, squares / static_cast<double>(n) - mean * mean));
    if (trial.faults != 0 || n == 0 || lost > 0 || !(shaken < 0.5 * mean)) return {};
    return stiffness / static_cast<double>(n);
}

}  // namespace

std::vector<Stiffest> compare(double rate) {
    std::vector<Stiffest> rows;
    for (const Case& one : {pressed(), pushed()}) {
        Stiffest row;
        row.what = one.what;
        const auto stiffest = [&](const std::function<void(TrialOptions&, double)>& with) {
            Stiffest::Surface best;
            for (int rung = 0; rung <= 14; ++rung) {
                const double stiffness = 25 * std::pow(2.0, rung / 2.0);
                row.most = stiffness;
                TrialOptions options{.rate = rate};
                with(options, stiffness);
                if (const auto felt = stable(one, options))
                    best = {.wish = stiffness, .felt = *felt};
                else if (best.wish > 0)
                    break;  // below the first, the hand passes through a thing that is too soft to be moved
            }
            return best;
        };
        row.in_loop = stiffest([](TrialOptions& o, double k) { o.force_in_loop = k; }).wish;
        row.as_wished = stiffest([](TrialOptions& o, double k) {
            o.coupled.touch.stiffness = k;
            o.coupled.touch.softness = 0;
        });
        row.held_to = stiffest([](TrialOptions& o, double k) { o.coupled.touch.stiffness = k; });
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace bodies
