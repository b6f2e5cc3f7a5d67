#include "latency_output.hpp"

#include <fmt/format.h>

#include "latency_compare.hpp"

namespace knurl::cli {

std::string percentile_text(const measure::Run& run, double percentile) {
    std::string text;
    for (const measure::Result& r : run.results) {
        const auto value = measure::merged(r.blocks).percentile(percentile / 100);
        text += value ? fmt::format("p{:g} of {}: {:.4g} {}\n", percentile, r.name, *value, r.unit)
                      : fmt::format("p{:g} of {}: {} samples are too few, {} are needed\n", percentile,
                                    r.name, r.n, measure::needed_for(percentile / 100));
    }
    return text;
}

std::string to_json(const measure::Run& run, const Aside& aside, double percentile) {
    using knurl::Json;
    Json more = {{"format", {{"program", LatencyFile::program}, {"version", LatencyFile::version}}},
                 {"setting", aside.setting},
                 {"updates", {{"merged", aside.merged}, {"lost", aside.lost}}},
                 {"ended", aside.ended.empty() ? Json() : Json(aside.ended)},
                 {"network", aside.network}};
    if (percentile > 0) {
        Json values;
        for (const measure::Result& r : run.results) {
            const auto value = measure::merged(r.blocks).percentile(percentile / 100);
            values[r.name] = value ? Json(*value) : Json();
        }
        more["percentile"] = {{"of", percentile}, {"values", values}};
    }
    if (!aside.comparison.is_null()) more["comparison"] = aside.comparison;
    // The blocks stay one per line; additions go to the end.
    std::string text = measure::to_json(run);
    text.erase(text.rfind('}'));
    text.erase(text.find_last_not_of(" \n") + 1);
    return text + "," + more.dump(2).substr(1) + "\n";
}

}  // namespace knurl::cli
