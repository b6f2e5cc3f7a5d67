#pragma once
// Checks before sending or merging, with the servo's own function: a bad change throws at the call and
// changes nothing. Each throws Error::bad_parameters with field, value and range.

#include <cstddef>
#include <cstdint>

#include <knurl/reps/scene.hpp>

namespace knurl::detail {

void validate(Kind kind, const void* params, std::size_t bytes);
void validate(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
void validate(std::uint32_t probe, const ProbePlacement& placement);

}  // namespace knurl::detail
