#pragma once
// The library checks before it sends or merges, with the same function as the servo: a bad change throws at
// the call and spoils nothing. Each throws Error::bad_parameters with field, value and range.

#include <cstddef>
#include <cstdint>

#include <knurl/reps/scene.hpp>

namespace knurl::detail {

void validate(Kind kind, const void* params, std::size_t bytes);
void validate(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
void validate(std::uint32_t probe, const ProbePlacement& placement);

}  // namespace knurl::detail
