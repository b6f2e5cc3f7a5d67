#pragma once
// How much of each there may be, for all modules: a bound has one name and one value.

#include <cstddef>
#include <cstdint>

namespace knurl {

inline constexpr std::uint32_t max_representations = 1024;  // of one claim
inline constexpr std::uint32_t max_probes = 16;             // of one claim
inline constexpr std::uint32_t max_parameter_bytes = 480;   // of one representation
inline constexpr std::size_t max_state_bytes = 192;         // of one representation, in the servo

}  // namespace knurl
