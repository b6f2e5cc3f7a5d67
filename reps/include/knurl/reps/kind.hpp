#pragma once

/// @file
/// Kinds of representations by number, without the representations themselves: what includes this file alone is not
/// compiled anew when a kind is added or changed. The list of all kinds is in all.hpp.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <knurl/reps/field.hpp>

namespace knurl {

/// Position in the list of all.hpp: what "kind" means in shared memory.
using Kind = std::uint32_t;

/// R is a representation, and its header has been included.
template <class R>
concept Described = requires {
    Describe<R>::name;
};

/// The kind of R. It is defined for the representations of the list alone: for any other one the linker says that this
/// function is missing.
template <Described R>
Kind kind_number() noexcept;

/// What is known of a kind at run time.
struct KindInfo {
    /// Name in scene files: Describe<R>::name.
    std::string_view name;
    /// One row per parameter: Describe<R>::fields.
    std::span<const Field> fields;
    /// Bytes of its parameters.
    std::size_t size;
    /// Leading bytes of its parameters that an update may bring alone.
    std::size_t geometry_bytes;
    /// True: a surface; false: an effect.
    bool surface;
    /// Checks parameters of `size` bytes.
    Verdict (*validate)(const void* params) noexcept;
    /// The texts that a Verdict's `reason` counts.
    std::span<const std::string_view> contradictions;
};

/// All kinds, in the list's order.
std::span<const KindInfo> kinds() noexcept;

/// A hash over names, types, offsets, counts and sizes of all parameters: two builds that differ in it must
/// not talk.
std::uint64_t layout_hash() noexcept;

}  // namespace knurl
