#pragma once
// Scanned meshes, if scripts/fetch_meshes has fetched them.

#include <optional>

#include "generators.hpp"

namespace knurl::test {

/// bunny, dragon_11k, dragon_48k, dragon_203k or dragon_871k; from KNURL_MESHES, or build/meshes.
std::optional<MadeMesh> fetched(const std::string& name);
/// Loop's subdivision (1987) of a closed mesh, once: four times the triangles, smoother.
MadeMesh subdivided(const MadeMesh&);

}  // namespace knurl::test
