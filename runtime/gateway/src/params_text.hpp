#pragma once
// Parameters from JSON: the same keys, ranges and refusals as in scene files.

#include <cstddef>
#include <span>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/reps/kind.hpp>

namespace knurl::gateway {

/// The kind of that name. Throws std::runtime_error, with the names that there are.
Kind kind_of_name(const std::string& name);
/// The parameters that `params` (an object, or null) states; `before`: those that it changes; empty: the defaults.
/// Throws std::runtime_error, one line.
std::vector<std::byte> params_of(Kind kind, const Json& params, std::span<const std::byte> before = {});

}  // namespace knurl::gateway
