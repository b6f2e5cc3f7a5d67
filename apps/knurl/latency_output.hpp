#pragma once
// What `knurl latency` says beside the table, for people and for programs.

#include <cstdint>
#include <string>

#include <knurl/json/json.hpp>
#include <knurl/measure/measure.hpp>

namespace knurl::cli {

/// What stands beside the table.
struct Aside {
    knurl::Json setting, network, comparison;  // null: there is none
    std::uint64_t merged = 0, lost = 0;        // updates
    std::string ended, text;
};

/// One percentile more of each result. What has too few samples says how many it needs.
std::string percentile_text(const measure::Run& run, double percentile);

/// All of it. `percentile`: one more; 0: none.
std::string to_json(const measure::Run& run, const Aside& aside, double percentile);

}  // namespace knurl::cli
