#include "goals.hpp"

#include <algorithm>

namespace knurl::servo::scaling {

namespace {

const Goal goals[] = {
    {"128 idle clients more than none, cold", 2500, "clients.idle.cold", "clients.idle.cold", 128, 0},
    {"128 silent clients, a plane each, more than none, cold", 2500, "clients.silent.cold",
     "clients.silent.cold", 128, 0},
    {"128 fresh batches of nothing, median", 5000, "clients.empty_batch.warm", "clients.silent.alone", 128,
     128},
    {"128 fresh batches of nothing, 99 %", 8000, "clients.empty_batch.warm", "clients.silent.alone", 128, 128,
     0.99},
    {"128 fresh batches of a plane each, median", 5000, "clients.sending.warm", "clients.silent.alone", 128,
     128},
    {"128 fresh batches of a plane each, 99 %", 8000, "clients.sending.warm", "clients.silent.alone", 128,
     128, 0.99},
};

/// The blocks are merged while drawing: 30 small histograms per resampling.
std::optional<double> percentile(const Point& point, std::span<const std::size_t> drawn, double q) {
    measure::Histogram all;
    for (const std::size_t block : drawn) all.merge(point.blocks[block]);
    return all.percentile(q);
}

Judged judged(const Goal& goal, const Point& point, const Point& beside) {
    const measure::Statistic more = [&](std::span<const std::size_t> drawn,
                                        std::span<const std::size_t>) -> std::optional<double> {
        const auto value = percentile(point, drawn, goal.q), less = percentile(beside, drawn, 0.5);
        return value && less ? std::optional(*value - *less) : std::nullopt;
    };
    return judge(goal, point.blocks.size(), more);
}

}  // namespace

Judged judge(const Goal& goal, std::size_t blocks, const measure::Statistic& statistic) {
    Judged result{.goal = goal, .value = {}, .interval = {}};
    std::vector<std::size_t> all(blocks);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    result.value = statistic(all, all);
    result.interval =
        measure::bootstrap(all.size(), all.size(), statistic, {.confidence = 0.99, .resamples = 400});
    if (result.interval && result.interval->high < goal.limit) result.verdict = measure::Verdict::better;
    if (result.interval && result.interval->low > goal.limit) result.verdict = measure::Verdict::worse;
    return result;
}

std::vector<Judged> judge_goals(const std::vector<Series>& all) {
    const auto find = [&](const std::string& name) {
        return std::find_if(all.begin(), all.end(),
                            [&](const Series& series) { return series.name == name; });
    };
    std::vector<Judged> results;
    for (const Goal& goal : goals) {
        const auto series = find(goal.series), beside = find(goal.beside);
        if (series != all.end() && beside != all.end())
            results.push_back(judged(goal, series->at(goal.n), beside->at(goal.beside_n)));
    }
    return results;
}

}  // namespace knurl::servo::scaling
