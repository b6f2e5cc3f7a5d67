#pragma once
// The output of `knurl latency` besides the table, for people and for programs.

#include <cstdint>
#include <string>

#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::cli {

/// What stands beside the table.
struct Aside {
    knurl::Json setting, network, comparison;  // null: none
    std::uint64_t merged = 0, lost = 0;        // updates
    std::string ended, text;
};

/// One additional percentile of each result. A result with too few samples states how many it needs.
std::string percentile_text(const measure::Run& run, double percentile);

/// The whole output. `percentile`: an additional one; 0: none.
std::string to_json(const measure::Run& run, const Aside& aside, double percentile);

}  // namespace knurl::cli
