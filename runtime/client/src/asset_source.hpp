#pragma once

#include <cstdint>

#include <knurl/client/asset.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::detail {

/// A shape as the broker takes it: a sealed memfd. Kept by the claim, for a servo that has restarted.
struct AssetMemory {
    shm::UniqueFd memory;
    std::uint64_t bytes = 0;
};

/// Throws Error: counts and options that no builder would take. What else is wrong with the shape the builder
/// says.
AssetMemory source_of(const Triangles& mesh, const SendOptions& options);
AssetMemory source_of(const Heights& field);

}  // namespace knurl::detail
