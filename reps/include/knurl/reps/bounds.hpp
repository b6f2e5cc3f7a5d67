#pragma once

/// @file
/// How much of each there may be, for all modules: a bound has one name and one value.

#include <cstddef>
#include <cstdint>

namespace knurl {

/// Most representations of one claim.
inline constexpr std::uint32_t max_representations = 1024;
/// Most probes of one claim.
inline constexpr std::uint32_t max_probes = 16;
/// Most bytes of one representation's parameters.
inline constexpr std::uint32_t max_parameter_bytes = 480;
/// Most bytes of the servo's memory of one representation.
inline constexpr std::size_t max_state_bytes = 192;
/// Most kinds of representations.
inline constexpr std::uint32_t max_kinds = 32;
/// Most assets of a scene; they are numbered from 1.
inline constexpr std::uint32_t max_assets = 64;

}  // namespace knurl
