#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include <knurl/messages/drawing.hpp>
#include <knurl/reps/all.hpp>

namespace knurl::messages {

namespace {

using Vector = Eigen::Vector3d;
using Turn = Eigen::Quaterniond;

constexpr double thin = 2e-4;             // m: of patches, plates, lines
constexpr double metres_a_newton = 0.01;  // of an arrow that is a force

Vector unit(const Vec3& v) {
    const Vector e = to_eigen(v);
    const double n = e.norm();
    return n > 0 ? Vector(e / n) : Vector::UnitZ();
}
Turn unit(const Quat& q) {
    const Turn e = to_eigen(q);
    return e.norm() > 0 ? e.normalized() : Turn::Identity();
}
/// Turns z to n.
Turn to_axis(const Vector& n) {
    return Turn::FromTwoVectors(Vector::UnitZ(), n);
}
/// A direction across n.
Vector across(const Vector& n) {
    return n.unitOrthogonal();
}

/// Collects an item's markers; takes places in the claim's world and gives them in the device's frame.
class Pen {
  public:
    Pen(const Item& item, const Surroundings& around, const std::string& ns, std::int32_t first, bool surface)
        : item_(item), around_(around), ns_(ns), next_(first) {
        colour_ = surface ? Colour{0.35F, 0.6F, 0.85F, 0.8F} : Colour{0.95F, 0.6F, 0.2F, 0.8F};
        if (item.touching)
            colour_ = surface ? Colour{0.2F, 0.8F, 0.45F, 0.85F} : Colour{1, 0.75F, 0.1F, 0.9F};
        if (item.asleep) colour_ = {0.5F, 0.5F, 0.5F, 0.4F};
        if (item.fading || item.silent) colour_.a *= 0.4F;
    }

    Vector to_device(const Vector& world) const {
        return (world - to_eigen(item_.frame.world_centre)) / item_.frame.scale +
               to_eigen(item_.frame.device_centre);
    }
    /// The hand, in the claim's world.
    Vector hand() const {
        return item_.frame.scale * (to_eigen(around_.hand) - to_eigen(item_.frame.device_centre)) +
               to_eigen(item_.frame.world_centre);
    }
    /// Radius of the workspace, in the claim's world.
    double reach() const { return around_.reach * item_.frame.scale; }
    double device_size(double world) const { return world / item_.frame.scale; }
    double world_size(double device) const { return device * item_.frame.scale; }
    const Item& item() const { return item_; }

    Marker& add(Marker::Type type, const Vector& at, const Turn& turn = Turn::Identity()) {
        Marker marker;
        marker.ns = ns_;
        marker.id = next_++;
        marker.type = type;
        marker.position = to_plain(to_device(at));
        marker.orientation = to_plain(turn);
        marker.colour = colour_;
        return markers_.emplace_back(std::move(marker));
    }
    /// A body with these sizes (m, world); none is so thin that it is not seen.
    Marker& body(Marker::Type type, const Vector& at, const Turn& turn, const Vector& sizes) {
        Marker& marker = add(type, at, turn);
        const auto seen = [this](double size) {
            return std::clamp(device_size(size), thin, 1000 * around_.reach);
        };
        marker.scale = {seen(sizes.x()), seen(sizes.y()), seen(sizes.z())};
        return marker;
    }
    void ball(const Vector& at, double radius) {
        body(Marker::sphere, at, Turn::Identity(), Vector::Constant(2 * radius));
    }
    void patch(const Vector& at, const Vector& normal, double half) {
        // Its upper face is the surface.
        body(Marker::cube, at - normal * world_size(thin) / 2, to_axis(normal), {2 * half, 2 * half, 0});
    }
    /// Corners of triangles or ends of lines.
    Marker& points(Marker::Type type, const std::vector<Vector>& world) {
        Marker& marker = add(type, Vector::Zero());
        marker.position = {};
        marker.scale = type == Marker::triangle_list ? Vec3{1, 1, 1} : Vec3{around_.reach / 100, 0, 0};
        marker.points.reserve(world.size());
        for (const Vector& point : world) marker.points.push_back(to_plain(to_device(point)));
        return marker;
    }
    void arrow(const Vector& from, const Vector& to) {
        Marker& marker = points(Marker::arrow, {from, to});
        marker.scale = {around_.reach / 60, around_.reach / 25, 0};
    }
    /// A force (N, world) that acts on the hand.
    void force(const Vector& newtons) {
        if (newtons.squaredNorm() == 0) return;
        const Vector along = newtons * world_size(metres_a_newton) * item_.frame.force_scale;
        const double most = reach() / std::max(along.norm(), 1e-12);
        arrow(hand(), hand() + along * std::min(1.0, most));
    }
    void words(const Vector& at, std::string text) {
        Marker& marker = add(Marker::text_view_facing, at);
        marker.scale = {0, 0, around_.reach / 10};
        marker.text = std::move(text);
    }
    void paler(float by) { markers_.back().colour.a *= by; }
    std::vector<Marker> take() { return std::move(markers_); }

  private:
    const Item& item_;
    const Surroundings& around_;
    const std::string& ns_;
    std::int32_t next_;
    Colour colour_;
    std::vector<Marker> markers_;
};

// One function a kind: without it a new kind does not compile.

void draw(const Plane& plane, Pen& pen) {
    const Vector n = unit(plane.normal), hand = pen.hand();
    const double offset = plane.offset / std::max(to_eigen(plane.normal).norm(), 1e-12);
    pen.patch(hand - n * (n.dot(hand) - offset), n, pen.reach() / 2);
}

void draw(const HalfPlane& half, Pen& pen) {
    const Vector n = unit(half.normal), hand = pen.hand();
    const double offset = half.offset / std::max(to_eigen(half.normal).norm(), 1e-12);
    const Vector edge = to_eigen(half.edge) - n * n.dot(to_eigen(half.edge));
    const double length = edge.norm();
    if (!(length > 0)) return;
    const Vector e = edge / length;
    // edge.x <= edge_offset, on the face.
    const double limit = (half.edge_offset - n.dot(to_eigen(half.edge)) * offset) / length;
    const double size = pen.reach() / 2;
    Vector foot = hand - n * (n.dot(hand) - offset);
    foot += e * (std::min(e.dot(foot), limit - size) - e.dot(foot));
    Eigen::Matrix3d axes;
    axes << e, n.cross(e), n;
    pen.body(Marker::cube, foot - n * pen.world_size(thin) / 2, Turn(axes), {2 * size, 2 * size, 0});
}

void draw(const Polygon& polygon, Pen& pen) {
    const std::uint32_t n = std::min(polygon.vertices.count, max_vertices);
    std::vector<Vector> corners;
    for (std::uint32_t i = 1; i + 1 < n; ++i)
        for (const std::uint32_t k : {0U, i, i + 1}) corners.push_back(to_eigen(polygon.vertices.at[k]));
    if (!corners.empty()) pen.points(Marker::triangle_list, corners);
}

/// A net of rows and columns, its squares as two triangles each; `at`: the point of (row, column).
template <class At>
std::vector<Vector> net(int rows, int columns, At at) {
    std::vector<Vector> corners;
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < columns; ++k)
            for (const auto& [di, dk] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
                corners.push_back(at(i + di, k + dk));
    return corners;
}

void draw(const Cap& cap, Pen& pen) {
    const Vector n = unit(cap.normal), foot = to_eigen(cap.foot);
    Vector u = to_eigen(cap.axis) - n * n.dot(to_eigen(cap.axis));
    const bool one = !(u.norm() > 0);
    u = one ? across(n) : Vector(u.normalized());
    const Vector v = n.cross(u);
    const double first = cap.curvature, second = one ? cap.curvature : cap.curvature2;
    const double strongest = std::max(std::abs(first), std::abs(second));
    // Within the rim, where it follows the surface; to second order.
    const double size = std::min(pen.reach() / 2, strongest > 0 ? cap.rim / strongest : pen.reach() / 2);
    constexpr int rings = 4, spokes = 24;
    pen.points(Marker::triangle_list, net(rings, spokes, [&](int ring, int spoke) -> Vector {
                   const double r = size * ring / rings, angle = 2 * std::numbers::pi * spoke / spokes;
                   const double x = r * std::cos(angle), y = r * std::sin(angle);
                   return foot + u * x + v * y + n * (first * x * x + second * y * y) / 2;
               }));
}

void draw(const Box& box, Pen& pen) {
    pen.body(Marker::cube, to_eigen(box.center), unit(box.orientation), 2 * to_eigen(box.half_size));
    if (box.side == Side::inside) pen.paler(0.4F);
}

void draw(const Sphere& sphere, Pen& pen) {
    pen.ball(to_eigen(sphere.center), sphere.radius);
    if (sphere.side == Side::inside) pen.paler(0.4F);
}

void draw(const Capsule& capsule, Pen& pen) {
    const Vector axis = unit(capsule.axis), middle = to_eigen(capsule.center);
    const float pale = capsule.side == Side::inside ? 0.4F : 1.0F;
    pen.body(Marker::cylinder, middle, to_axis(axis),
             {2 * capsule.radius, 2 * capsule.radius, 2 * capsule.half_length});
    pen.paler(pale);
    for (const double end : {-capsule.half_length, capsule.half_length}) {
        pen.ball(middle + axis * end, capsule.radius);
        pen.paler(pale);
    }
}

void draw(const Cylinder& cylinder, Pen& pen) {
    const double half = std::min(cylinder.half_length, 4 * pen.reach());
    pen.body(Marker::cylinder, to_eigen(cylinder.center), to_axis(unit(cylinder.axis)),
             {2 * cylinder.radius, 2 * cylinder.radius, 2 * half});
    if (cylinder.side == Side::inside) pen.paler(0.4F);
}

void draw(const Torus& torus, Pen& pen) {
    const Vector n = unit(torus.axis), u = across(n), v = n.cross(u), middle = to_eigen(torus.center);
    constexpr int around = 32, tube = 12;
    pen.points(Marker::triangle_list, net(around, tube, [&](int i, int k) -> Vector {
                   const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * k / tube;
                   const Vector out = u * std::cos(a) + v * std::sin(a);
                   return middle + out * (torus.radius + torus.tube * std::cos(b)) +
                          n * torus.tube * std::sin(b);
               }));
    if (torus.side == Side::inside) pen.paler(0.4F);
}

void draw(const Shape& shape, Pen& pen) {
    const Vector at = to_eigen(shape.position);
    const Turn turn = unit(shape.orientation);
    const Triangles* triangles = pen.item().triangles;
    const auto vertex = [&](std::size_t i) {
        return Vector(triangles->vertices[3 * i], triangles->vertices[3 * i + 1],
                      triangles->vertices[3 * i + 2]);
    };
    const std::size_t vertices = triangles != nullptr ? triangles->vertices.size() / 3 : 0;
    if (vertices == 0) {
        if (shape.asset != 0) pen.words(at, fmt::format("mesh {}", shape.asset));
        return;
    }
    if (triangles->corners.size() / 3 > most_triangles) {
        Eigen::AlignedBox3d box;
        for (std::size_t i = 0; i < vertices; ++i) box.extend(vertex(i));
        pen.body(Marker::cube, at + turn * box.center(), turn, box.sizes());
        pen.paler(0.4F);
        return;
    }
    for (std::size_t first = 0; first < triangles->corners.size(); first += 3 * triangles_of_marker) {
        Marker& marker = pen.add(Marker::triangle_list, at, turn);
        const auto part = triangles->corners.subspan(
            first, std::min(3 * triangles_of_marker, triangles->corners.size() - first));
        marker.points.reserve(part.size());
        for (std::size_t i = 0; i + 2 < part.size(); i += 3) {
            const auto corners = part.subspan(i, 3);
            if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t c) { return c >= vertices; }))
                continue;
            for (const std::uint32_t corner : corners)
                marker.points.push_back(to_plain(Vector(vertex(corner) / pen.item().frame.scale)));
        }
    }
}

void draw(const Spring& spring, Pen& pen) {
    const Vector anchor = to_eigen(spring.anchor);
    pen.points(Marker::line_list, {pen.hand(), anchor});
    pen.ball(anchor, pen.reach() / 60);
}

void draw(const ConstantForce& constant, Pen& pen) {
    pen.force(to_eigen(constant.force));
}

void draw(const Gravity& gravity, Pen& pen) {
    pen.force(to_eigen(gravity.acceleration) * gravity.mass);
}

void draw(const Vibration& vibration, Pen& pen) {
    const Vector along = unit(vibration.direction) * vibration.amplitude;
    pen.force(along);
    pen.force(-along);
}

void draw(const Viscosity& viscosity, Pen& pen) {
    if (viscosity.damping == 0 && viscosity.angular_damping == 0) return;
    pen.ball(pen.hand(), pen.reach() / 10);
    pen.paler(0.4F);
}

void draw(const Magnet& magnet, Pen& pen) {
    const Vector at = to_eigen(magnet.position);
    pen.ball(at, std::max(magnet.radius, pen.reach() / 60));
    pen.ball(at, magnet.radius + magnet.max_distance);
    pen.paler(0.2F);
}

void draw(const Constraint& constraint, Pen& pen) {
    const Vector origin = to_eigen(constraint.origin), along = unit(constraint.direction), hand = pen.hand();
    switch (constraint.shape) {
        case ConstraintShape::line: {
            const Vector foot = origin + along * along.dot(hand - origin);
            pen.points(Marker::line_list, {foot - along * pen.reach(), foot + along * pen.reach()});
            break;
        }
        case ConstraintShape::plane:
            pen.patch(hand - along * along.dot(hand - origin), along, pen.reach() / 2);
            pen.paler(0.6F);
            break;
        case ConstraintShape::point:
            pen.ball(origin, pen.reach() / 40);
    }
}

/// Arrows on a grid in a ball: F = force + jacobian (p - origin), the longest as long as the grid is wide.
void draw_field(const Vec3& origin, double radius, const Vector& force, const Eigen::Matrix3d& jacobian,
                Pen& pen) {
    constexpr int steps = 2;
    const double size = std::min(radius, pen.reach()) * 0.8, width = size / steps;
    struct Place {
        Vector at, force;
    };
    std::vector<Place> places;
    double strongest = 0;
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y)
            for (int z = -steps; z <= steps; ++z) {
                const Vector from(x * width, y * width, z * width);
                if (from.norm() > 1.01 * size) continue;
                places.push_back({to_eigen(origin) + from, force + jacobian * from});
                strongest = std::max(strongest, places.back().force.norm());
            }
    if (!(strongest > 0)) return;
    std::vector<Vector> lines;
    for (const Place& place : places) {
        const double share = place.force.norm() / strongest;
        if (share < 0.02) continue;
        const Vector to = place.at + place.force / strongest * width;
        const Vector back = (place.at - to) * 0.25, aside = across(back.normalized()) * back.norm() * 0.5;
        lines.insert(lines.end(), {place.at, to, to, to + back + aside, to, to + back - aside});
    }
    Marker& marker = pen.points(Marker::line_list, lines);
    marker.scale.x = pen.device_size(width) / 25;
}

void draw(const Taylor& taylor, Pen& pen) {
    draw_field(taylor.origin, taylor.radius, to_eigen(taylor.force), to_eigen(taylor.jacobian), pen);
}

void draw(const Taylor6& taylor, Pen& pen) {
    draw_field(taylor.origin, taylor.radius, to_eigen(taylor.force),
               to_eigen(taylor.jacobian).topLeftCorner<3, 3>(), pen);
}

template <class... R>
void draw_kind(TypeList<R...>, Pen& pen) {
    const Item& item = pen.item();
    const auto one = [&]<class K>(K params) {
        if (item.kind != kind_of<K> || item.params.size() != sizeof params) return;
        std::memcpy(&params, item.params.data(), sizeof params);
        draw(params, pen);
    };
    (one(R{}), ...);
}

bool finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

double redraw_distance(Kind kind, const Surroundings& around) {
    if (kind == kind_of<Plane> || kind == kind_of<HalfPlane> || kind == kind_of<Constraint>)
        return around.reach / 4;
    if (kind == kind_of<Spring> || kind == kind_of<ConstantForce> || kind == kind_of<Gravity> ||
        kind == kind_of<Vibration> || kind == kind_of<Viscosity>)
        return around.reach / 200;
    return std::numeric_limits<double>::infinity();
}

std::vector<Marker> draw(const Item& item, const Surroundings& around, const std::string& ns,
                         std::int32_t first_id) {
    if (item.kind >= kinds().size() || !(item.frame.scale > 0) || !finite(around.hand) || !(around.reach > 0))
        return {};
    Pen pen(item, around, ns, first_id, kinds()[item.kind].surface);
    draw_kind(Representations{}, pen);
    return pen.take();
}

}  // namespace knurl::messages
