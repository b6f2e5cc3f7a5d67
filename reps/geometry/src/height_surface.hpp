#pragma once
// The height field as the walk sees it, with the interface of MeshSurface. The neighbour over an edge is
// found by arithmetic, and the tree is the pyramid of the blocks' lowest and highest heights.

#include <algorithm>
#include <cmath>

#include <knurl/geometry/proxy.hpp>

#include "height_data.hpp"
#include "mesh_data.hpp"
#include "triangle_math.hpp"

namespace knurl::detail {

class HeightSurface {
  public:
    explicit HeightSurface(const HeightData& data) noexcept : d_(data) {}

    bool has(std::uint32_t face) const noexcept { return face < 2 * d_.columns * d_.rows; }
    double size() const noexcept { return d_.size; }
    std::uint8_t flags(std::uint32_t) const noexcept { return 0; }
    std::uint32_t triangle(std::uint32_t face) const noexcept { return face; }
    std::uint8_t material(std::uint32_t) const noexcept { return d_.material; }

    Corners corners(std::uint32_t face) const noexcept {
        const Cell c = cell_of(face);
        return upper(face) ? Corners{{at(c.i, c.j), at(c.i + 1, c.j + 1), at(c.i, c.j + 1)}}
                           : Corners{{at(c.i, c.j), at(c.i + 1, c.j), at(c.i + 1, c.j + 1)}};
    }
    Vec corner(std::uint32_t face, std::uint32_t k) const noexcept {
        const Cell c = cell_of(face);
        if (k == 0) return at(c.i, c.j);
        if (upper(face)) return k == 1 ? at(c.i + 1, c.j + 1) : at(c.i, c.j + 1);
        return k == 1 ? at(c.i + 1, c.j) : at(c.i + 1, c.j + 1);
    }
    Link over(std::uint32_t face, std::uint32_t edge) const noexcept {
        const Cell c = cell_of(face);
        if (upper(face)) {
            if (edge == 0) return link_to(face - 1, 2);
            if (edge == 1) return c.j + 1 < d_.rows ? link_to(face - 1 + 2 * d_.columns, 0) : no_link;
            return c.i > 0 ? link_to(face - 3, 1) : no_link;
        }
        if (edge == 0) return c.j > 0 ? link_to(face + 1 - 2 * d_.columns, 1) : no_link;
        if (edge == 1) return c.i + 1 < d_.columns ? link_to(face + 3, 2) : no_link;
        return link_to(face + 1, 0);
    }

    template <class See>
    bool overlapping(const Vec& low, const Vec& high, Work& work, See&& see) const noexcept {
        const auto touched = [&](double from, double to) { return from <= high.z && to >= low.z; };
        return visit(
            low, high, work, [&](const Vec& from, const Vec& to, bool) { return touched(from.z, to.z); },
            [&](std::uint32_t i, std::uint32_t j) {
                const auto [from, to] = span(i, j);
                if (touched(from, to)) ++work.nodes, see_cell(i, j, see);
                return true;
            });
    }

    template <class See>
    bool nearer(const Vec& h, double& square, Work& work, See&& see) const noexcept {
        see_cell(column(h.x), row(h.y), see);  // the cell below it: farther cells do not matter
        const double reach = std::sqrt(square);
        const auto near = [&](const Vec& from, const Vec& to, bool) {
            const Vec out{std::max({from.x - h.x, h.x - to.x, 0.0}),
                          std::max({from.y - h.y, h.y - to.y, 0.0}),
                          std::max({from.z - h.z, h.z - to.z, 0.0})};
            return out.squaredNorm() <= square;
        };
        return visit(low_of(h, h, reach), high_of(h, h, reach), work, near,
                     [&](std::uint32_t i, std::uint32_t j) {
                         const auto [from, to] = span(i, j);
                         const Vec a = at(i, j), b = at(i + 1, j + 1);
                         if (near({a.x, a.y, from}, {b.x, b.y, to}, false)) ++work.nodes, see_cell(i, j, see);
                         return true;
                     });
    }

    double room(const Vec& h, double most, Work& work) const noexcept {
        double best = most;
        const auto away = [&](const Vec& from, const Vec& to) {
            return std::max({from.x - h.x, h.x - to.x, from.y - h.y, h.y - to.y, from.z - h.z, h.z - to.z});
        };
        const std::uint32_t before = work.nodes;
        const bool all = visit(
            low_of(h, h, most), high_of(h, h, most), work,
            [&](const Vec& from, const Vec& to, bool lowest) {
                const double far = away(from, to);
                if (!lowest || !(far > 0)) return far < best;
                best = std::min(best, far);  // good enough, since it has many cells
                return false;
            },
            [&](std::uint32_t i, std::uint32_t j) {
                const auto [from, to] = span(i, j);
                const Vec a = at(i, j), b = at(i + 1, j + 1);
                best = std::min(best, away({a.x, a.y, from}, {b.x, b.y, to}));
                return best > 0 && work.nodes - before < max_room_nodes;
            });
        return all ? std::max(0.0, best * (1 - 1e-9)) : 0;
    }

  private:
    struct Cell {
        std::uint32_t i, j;
    };
    static constexpr std::uint32_t max_room_nodes = 64, stack_size = 384;  // 6 levels of 64

    static bool upper(std::uint32_t face) noexcept { return (face & 1) != 0; }
    Cell cell_of(std::uint32_t face) const noexcept {
        const std::uint32_t cell = face >> 1, j = cell / d_.columns;
        return {cell - j * d_.columns, j};
    }
    float height(std::uint32_t i, std::uint32_t j) const noexcept {
        return d_.heights[std::size_t{j} * (d_.columns + 1) + i];
    }
    Vec at(std::uint32_t i, std::uint32_t j) const noexcept {
        return {d_.low_x + i * d_.dx, d_.low_y + j * d_.dy, height(i, j)};
    }
    std::uint32_t column(double x) const noexcept {
        return static_cast<std::uint32_t>(std::clamp((x - d_.low_x) / d_.dx, 0.0, double(d_.columns - 1)));
    }
    std::uint32_t row(double y) const noexcept {
        return static_cast<std::uint32_t>(std::clamp((y - d_.low_y) / d_.dy, 0.0, double(d_.rows - 1)));
    }
    std::pair<double, double> span(std::uint32_t i, std::uint32_t j) const noexcept {
        const auto [a, b] =
            std::minmax({height(i, j), height(i + 1, j), height(i, j + 1), height(i + 1, j + 1)});
        return {a, b};
    }
    template <class See>
    void see_cell(std::uint32_t i, std::uint32_t j, See&& see) const noexcept {
        const std::uint32_t face = 2 * (j * d_.columns + i);
        see(face);
        see(face + 1);
    }

    /// Visits the cells under low..high. into(low, high, lowest) says whether to enter a block, cell(i, j)
    /// whether to continue. False: not all cells were visited.
    template <class Into, class See>
    // NOLINTNEXTLINE(readability-function-cognitive-complexity): in the cycle, a split costs inlining
    bool visit(const Vec& low, const Vec& high, Work& work, Into&& into, See&& see) const noexcept {
        const double margin = 1e-12 * d_.size;  // rounding of columns and rows
        if (high.x < d_.low_x - margin || high.y < d_.low_y - margin || low.x > -d_.low_x + margin ||
            low.y > -d_.low_y + margin)
            return true;
        const Cell first{column(low.x - margin), row(low.y - margin)},
            last{column(high.x + margin), row(high.y + margin)};
        struct Block {
            std::uint32_t level, x, y;
        } stack[stack_size];
        std::uint32_t depth = 0;
        stack[depth++] = {d_.level_count - 1, 0, 0};
        while (depth > 0) {
            if (work.nodes + 1 + 8 + 64 > max_nodes) return false;
            const Block block = stack[--depth];
            const std::uint32_t shift = HeightData::shift * block.level;  // of a child, in powers of two of
                                                                          // cells
            const std::uint32_t x0 = std::max(block.x * 8, first.i >> shift),
                                x1 = std::min(block.x * 8 + 7, last.i >> shift),
                                y0 = std::max(block.y * 8, first.j >> shift),
                                y1 = std::min(block.y * 8 + 7, last.j >> shift);
            work.nodes += 1 + (x1 - x0 + 1) * (y1 - y0 + 1) / 8;  // the cost in nodes of eight
            for (std::uint32_t y = y0; y <= y1; ++y) {
                for (std::uint32_t x = x0; x <= x1; ++x) {
                    if (block.level == 0) {
                        if (!see(x, y)) return false;
                        continue;
                    }
                    const HeightData::Level& level = d_.levels[block.level - 1];
                    const HeightData::Span span = level.blocks[std::size_t{y} * level.columns + x];
                    const std::uint32_t i = std::min((x + 1) << shift, d_.columns),
                                        j = std::min((y + 1) << shift, d_.rows);
                    const Vec from{d_.low_x + (x << shift) * d_.dx, d_.low_y + (y << shift) * d_.dy,
                                   span.low},
                        to{d_.low_x + i * d_.dx, d_.low_y + j * d_.dy, span.high};
                    if (!into(from, to, block.level == 1)) continue;
                    if (depth == stack_size) return false;
                    stack[depth++] = {block.level - 1, x, y};
                }
            }
        }
        return true;
    }

    const HeightData& d_;
};

}  // namespace knurl::detail
