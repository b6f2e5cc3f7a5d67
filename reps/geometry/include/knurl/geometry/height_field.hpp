#pragma once

/// @file
/// Heights over a regular grid, rendered as two triangles per cell: the same walk as on a mesh, but what lies
/// over an edge is arithmetic. 2.1 bytes per triangle instead of about a hundred.
///
///      y ^  01 ──── 11      Each cell (i, j) is cut from its corner 00 to its corner 11: triangle
///        |  │ 1  ╱  │       2 (j columns + i) is 00, 10, 11, the next one 00, 11, 01. Free space is above.
///        |  │  ╱  0 │
///        |  00 ──── 10
///        +───────────> x

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include <knurl/geometry/asset.hpp>

namespace knurl {

/// One line that says what is wrong, and what to do.
struct HeightFieldError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Size and place of a grid of heights.
struct HeightGrid {
    /// Number of heights along x, 2 or more.
    std::uint32_t columns = 0;
    /// Number of heights along y, 2 or more.
    std::uint32_t rows = 0;
    /// Distance along x from one height to the next (m), 1e-9 or more.
    double dx = 0;
    /// Distance along y from one height to the next (m), 1e-9 or more.
    double dy = 0;
    /// Where the first height is, at height 0 (m).
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();
};

struct HeightData;  // src/height_data.hpp

/// Heights over a regular grid, as an asset.
class HeightField final : public Asset {
  public:
    /// Heights (m) row by row, x first. More memory than `budget` (bytes) is refused before it is taken.
    /// Throws HeightFieldError, std::bad_alloc.
    HeightField(std::span<const float> heights, const HeightGrid& grid, std::uint8_t material = 0,
                std::size_t budget = std::numeric_limits<std::size_t>::max());
    /// One that was written by write(): asset_of. Throws HeightFieldError.
    HeightField(std::span<const std::byte> block, std::shared_ptr<const void> keeper);
    ~HeightField() override;

    /// As of Asset.
    std::size_t bytes() const noexcept override;
    /// As of Asset.
    std::size_t faces() const noexcept override;
    /// As of Asset.
    std::size_t block_bytes() const noexcept override;
    /// As of Asset.
    void write(std::span<std::byte> block) const override;
    /// As of Asset.
    DrawnTriangles drawn() const override;
    /// The form that the proxy walks on.
    const HeightData& data() const noexcept { return *data_; }

  private:
    using Block = std::pair<std::span<const std::byte>, std::shared_ptr<const void>>;
    explicit HeightField(Block block) : HeightField(block.first, std::move(block.second)) {}
    static Block built(std::span<const float> heights, const HeightGrid& grid, std::uint8_t material,
                       std::size_t budget);
    std::unique_ptr<HeightData> data_;
};

}  // namespace knurl
