#include "latency_bound.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace knurl::cli {

namespace {

bool meet(const Span& span, const measure::Gap& gap) {
    return gap.begin < span.end && span.begin < gap.end;
}

}  // namespace

std::optional<RemoteBound> remote_bound(const PathSamples& paths, std::span<const double> udp_one_way,
                                        std::span<const double> wake, const FloorMedians& medians,
                                        Nanoseconds period, std::span<const measure::Gap> gaps) {
    if (paths.to_use.empty() || udp_one_way.empty() || wake.empty()) return std::nullopt;
    const double cycle = static_cast<double>(period);
    const double granted = RemoteBound::grace * (medians.udp_one_way + medians.wake);
    const double limit = cycle + granted;
    RemoteBound bound;
    bound.use.limit = limit * 1e-3;
    bound.use.n = paths.to_use.size();
    for (std::size_t i = 0; i < bound.use.n; ++i) {
        if (paths.to_use[i] <= limit)
            ++bound.use.within;
        else if (std::ranges::any_of(gaps,
                                     [&](const measure::Gap& gap) { return meet(paths.commits[i], gap); }))
            ++bound.use.stalled;
        if (paths.to_write[i] <= limit) ++bound.write_within;
    }
    // With a wait uniform over the cycle, a path of length w exceeds the bound with probability (w - granted)
    // / cycle.
    const std::size_t pairs = std::min(udp_one_way.size(), wake.size());
    double beyond = 0;
    for (std::size_t i = 0; i < pairs; ++i)
        beyond += std::clamp((udp_one_way[i] + wake[i] - granted) / cycle, 0.0, 1.0);
    bound.use.references_within = 1 - beyond / static_cast<double>(pairs);
    return bound;
}

std::string to_text(const RemoteBound& bound) {
    const measure::Bound& use = bound.use;
    const auto percent = [&](std::size_t count) {
        return 100 * static_cast<double>(count) / static_cast<double>(use.n);
    };
    return fmt::format(
        "{}: {} of {} ({:.2f} %) within {:.1f} us = one cycle + {:g} x (floor.udp_one_way "
        "+ "
        "floor.eventfd_wake), {:.2f} % until it was written;\nthe floors' own samples would keep that in "
        "{:.2f} %; in {} of the {} others the machine stood still.\n",
        use.name, use.within, use.n, percent(use.within), use.limit, RemoteBound::grace,
        percent(bound.write_within), 100 * use.references_within, use.stalled, use.n - use.within);
}

}  // namespace knurl::cli
