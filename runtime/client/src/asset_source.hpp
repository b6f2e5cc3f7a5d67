#pragma once

#include <cstdint>

#include <knurl/client/asset.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::detail {

/// A shape in the form that the broker takes: a sealed memfd. The claim keeps it for a restarted servo.
struct AssetMemory {
    shm::UniqueFd memory;
    std::uint64_t bytes = 0;
};

/// Throws Error for counts and options that no builder accepts. The builder reports all other faults of the
/// shape.
AssetMemory source_of(const Triangles& mesh, const SendOptions& options);
AssetMemory source_of(const Heights& field);

}  // namespace knurl::detail
