#include <knurl/reps/half_plane.hpp>

#include "surfaces/piece.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;

constexpr double least_share = 1e-6;  // least share of the edge's direction that must lie in the face

// The part of v in the plane of the unit normal n. Done twice, since the first pass leaves its rounding.
Vector3d in_plane(const Vector3d& v, const Vector3d& n) noexcept {
    const Vector3d once = v - n.dot(v) * n;
    return once - n.dot(once) * n;
}

class HalfPlaneOutline {
  public:
    explicit HalfPlaneOutline(const HalfPlane& half) noexcept
        : normal_(to_eigen(half.normal)),
          edge_(to_eigen(half.edge)),
          offset_(half.offset),
          edge_offset_(half.edge_offset) {}

    const Vector3d& normal() const noexcept { return normal_; }
    double height(const Vector3d& q) const noexcept { return normal_.dot(q) - offset_; }
    double seam(const ProxyPath& path) const noexcept { return path.hand; }
    bool holds(const Vector3d& q, double reach, double by) const noexcept {
        return beyond(q) <= by + piece::rounding * (reach + std::abs(edge_offset_));
    }
    bool reaches(const Vector3d&, double) const noexcept { return true; }
    Vector3d away(const Vector3d& q) const noexcept { return height(q) * normal_ + beyond(q) * edge_; }

  private:
    double beyond(const Vector3d& q) const noexcept { return edge_.dot(q) - edge_offset_; }
    Vector3d normal_, edge_;
    double offset_, edge_offset_;
};

}  // namespace

Verdict Describe<HalfPlane>::check(const HalfPlane& half) noexcept {
    const double share =
        in_plane(to_eigen(half.edge).normalized(), to_eigen(half.normal).normalized()).norm();
    if (share >= least_share) return {};
    constexpr std::uint32_t row = row_of<HalfPlane>("edge");
    return {Verdict::Code::contradiction, row, share, 1};
}

HalfPlane prepared(HalfPlane params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    params.reserved = 0;
    const double length = to_eigen(params.normal).norm();
    const Vector3d normal = to_eigen(params.normal) / length;
    params.normal = to_plain(normal);
    params.offset /= length;
    // On the face edge.x = across.x + (edge.n) offset, so edge.x <= edge_offset holds as it was given.
    const Vector3d edge = to_eigen(params.edge), across = in_plane(edge, normal);
    const double width = across.norm();
    params.edge = to_plain(in_plane(across / width, normal));
    params.edge_offset = (params.edge_offset - edge.dot(normal) * params.offset) / width;
    return params;
}

void adopt(const HalfPlane& params, const HalfPlane* previous, PieceState& state, const Probe&) noexcept {
    if (!previous) {
        state = {};
        place(state.motion);
    } else if (!(params.normal == previous->normal) || params.offset != previous->offset ||
               !(params.edge == previous->edge) || params.edge_offset != previous->edge_offset ||
               !(params.velocity == previous->velocity)) {
        piece::adopt(params, HalfPlaneOutline(params), *previous, HalfPlaneOutline(*previous), state);
    }
}

Contact contact(const HalfPlane& params, PieceState& state, const Probe& probe, double dt) noexcept {
    return piece::contact(params, HalfPlaneOutline(params), state, probe, dt);
}

// Away from the piece only the side matters, and prime() finds it again.
double clearance(const HalfPlane& params, const PieceState& state, const Probe& probe) noexcept {
    if (state.touched != 0 && state.out == 0) return 0;
    const HalfPlaneOutline outline(params);
    const Vector3d& q = probe.position;
    const double distance =
        outline.holds(q, q.lpNorm<1>(), 0) ? std::abs(outline.height(q)) : outline.away(q).norm();
    return distance - probe.radius;
}

void out_of_reach(const HalfPlane&, PieceState& state) noexcept {
    piece::forget(state);
}

}  // namespace knurl
