#pragma once
// Parameters as JSON, by the tables of their kinds.

#include <cstddef>
#include <span>

#include <knurl/json/json.hpp>
#include <knurl/reps/kind.hpp>

namespace knurl::gateway {

/// Numbers that JSON has not are texts: "inf", "-inf", "automatic".
Json number_json(double value);
/// Parameters by field; kinds()[kind].size bytes.
Json params_json(Kind kind, std::span<const std::byte> params);

}  // namespace knurl::gateway
