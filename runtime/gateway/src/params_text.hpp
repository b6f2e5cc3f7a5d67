#pragma once
// Parameters from JSON: the same keys, ranges and refusals as in scene files.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/reps/kind.hpp>

namespace knurl::gateway {

/// The kind of that name. Throws std::runtime_error with the name that may be meant, or all that there are.
Kind kind_of_name(const std::string& name);
/// The members of a table as keys and values of TOML, for scenefile::read_stated. "inf" is a number there; JSON has none.
/// Throws std::runtime_error.
std::string toml_of(const Json& table);
/// The parameters that `params` (an object, or null) states; `before`: those that it changes; empty: the defaults.
/// Throws std::runtime_error, one line.
std::vector<std::byte> params_of(Kind kind, const Json& params, std::span<const std::byte> before = {});

}  // namespace knurl::gateway
