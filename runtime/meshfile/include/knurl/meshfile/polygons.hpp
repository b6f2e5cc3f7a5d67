#pragma once
// Cuts polygons into triangles that fill their outline: concave ones, ones with corners on their edges, ones
// with holes that a bridge of two equal edges joins to the outline, and bent ones.

#include <cstdint>
#include <span>
#include <vector>

#include <knurl/geometry/triangles.hpp>

namespace knurl::meshfile {

class Cutter {
  public:
    enum class Shape {
        convex,     // a fan
        concave,    // cut along its outline
        nothing,    // without an area: no triangles
        crossed,    // its outline crosses itself: no triangles
        too_large,  // cutting exceeds the time limit of a file: no triangles
    };

    /// Appends the triangles of the polygon with these corners.
    Shape cut(std::span<const knurl::Point3> vertices, std::span<const std::uint32_t> polygon,
              std::vector<knurl::Triangle>& out);
    /// Of the last polygon: the distance of a corner from its plane, relative to its size.
    double bent() const { return bent_; }

  private:
    struct Corner {
        std::uint32_t vertex;
        double x, y;  // in the plane
        std::uint32_t before, after;
        bool reflex, gone;
    };

    Shape fan(std::vector<knurl::Triangle>& out) const;
    void measure(std::span<const knurl::Point3> vertices);
    void project(std::span<const knurl::Point3> at, int way);
    bool is_convex() const;
    bool crosses_itself();
    bool clip(std::vector<knurl::Triangle>& out);
    bool is_ear(std::uint32_t corner);
    bool blocks(std::uint32_t point, const Corner& a, const Corner& b, const Corner& c) const;
    void take_out(std::uint32_t corner);

    std::vector<std::uint32_t> ring_;  // vertices, without repetitions
    std::vector<knurl::Point3> at_;    // of the ring's vertices, relative to the first
    knurl::Point3 normal_{};           // as long as twice the area
    std::vector<Corner> corners_;
    std::vector<std::uint32_t> by_x_;  // edges; then reflex corners
    double extent_ = 0, bent_ = 0;
    static constexpr std::uint64_t most_work = 500'000'000;  // corners visited: some seconds
    std::uint64_t work_ = 0;
};

}  // namespace knurl::meshfile
