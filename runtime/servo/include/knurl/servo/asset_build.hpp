#pragma once

/// @file
/// From what an application sent to what a servo feels. Takes the time that it takes, allocates, throws:
/// knurld does it in a process of its own (build_queue.hpp), a replay or a test where it is.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <knurl/geometry/asset.hpp>
#include <knurl/protocol/asset.hpp>

namespace knurl::servo {

/// An asset as the servo holds it.
struct BuiltAsset {
    /// The asset with its materials.
    std::unique_ptr<Asset> asset;
    /// The answer to the client, all but the number.
    protocol::AssetReady ready;
};

/// Builds an asset from a source. `source` is a protocol::AssetSource and its parts, aligned to 8, and is not
/// needed afterwards; all of it is checked. `budget`: bytes that the result and building it may take. Throws
/// one line that says what is wrong and what to do (std::runtime_error), std::bad_alloc.
BuiltAsset build_asset(std::span<const std::byte> source, std::uint64_t budget);

}  // namespace knurl::servo
