#pragma once
// A rigid thing whose form was sent once (a triangle mesh, a height field) and is named here: felt exactly
// wherever the hand is, however seldom its pose is sent. Its faces are one-sided, and the hand is held by the
// point of it that it came to (knurl/geometry/proxy.hpp). Beside others, with flat shading, that point goes by the proxy of
// all of them (proxy_path.hpp).

#include <cstddef>
#include <optional>

#include <knurl/geometry/proxy.hpp>
#include <knurl/reps/concepts.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/motion.hpp>

namespace knurl {

/// Assets of a scene, numbered from 1.
inline constexpr std::uint32_t max_assets = 64;

enum class Shading : std::uint32_t {
    flat = 0,  // the force points to the proxy, as it does on the facets that were sent
    // along the normal interpolated over the facet; contact is decided by the facets all the same
    smooth = 1,
};

/// The servo's memory of a shape.
struct ShapeState {
    const Asset* asset = nullptr;  // that the parameters name
    const Asset* met = nullptr;    // that the proxy lies on
    Proxy proxy;
    Motion motion;
    Vec3 normal = {0, 0, 1};  // in the asset's frame: what was answered when the hand was at proxy.last
    double height = 0;        // m
    double offset = 0;        // m: of the plane by which it holds the hand, along that normal
    Vec3 start = {};          // m: the proxy when the cycle began
    std::uint32_t material = 0, was_face = 0;
    Proxy::Phase was_phase = Proxy::Phase::fresh;  // when the cycle began
    // Beside others (proxy_path.hpp): the proxy lies beyond a rim, by no more than touching is; has left it, so often in
    // this cycle; is about to leave it; its plane is not known, since the form has changed; a ball touches it whose centre is in
    // front; no time passes, and it answers what it would alone.
    std::uint8_t handed = 0, left = 0, leaving = 0, anew = 0, brushed = 0, tries = 0, reserved = 0;
};

struct Shape {
    std::uint32_t asset = 0;  // which of the scene's; 0, or one that is not there: nothing is felt
    Shading shading = Shading::flat;
    Vec3 position = {};           // m, where the asset's origin lies
    Quat orientation = {};        // turns the asset's axes into the world's
    Vec3 velocity = {};           // m/s, of its origin, with which it moves on between updates
    Vec3 angular_velocity = {};   // rad/s, world axes, about its origin, likewise
    double stiffness = 0;         // N/m; infinity: as stiff as the device allows
    double damping = 0;           // N s/m
    double recovery = automatic;  // s; 0: at once
    double braking = 0;           // 1, share of the hand's momentum taken away at entry
    Friction friction = {};
    Snag snag = {};
    Texture texture = {};

    using State = ShapeState;
    static constexpr bool turns = true;
    static constexpr bool follows = true;
};

namespace detail {
inline constexpr std::string_view shadings[] = {"flat", "smooth"};
}

template <>
struct Describe<Shape> {
    static constexpr std::string_view name = "shape";
    static constexpr auto fields = join_rows(
        std::array{Field{.name = "asset",
                         .type = Field::Type::integer,
                         .offset = offsetof(Shape, asset),
                         .meaning = "which of the shapes that were sent; 0: none",
                         .minimum = 0,
                         .maximum = max_assets},
                   choice_row("shading", offsetof(Shape, shading),
                              "the direction of the force: the facets', or interpolated", detail::shadings),
                   vector_row("position", offsetof(Shape, position), "m", "where its origin lies"),
                   Field{.name = "orientation",
                         .type = Field::Type::quaternion,
                         .offset = offsetof(Shape, orientation),
                         .unit = "1",
                         .meaning = "turns its axes into the world's; of any length",
                         .minimum = -1e9,
                         .maximum = 1e9},
                   vector_row("angular_velocity", offsetof(Shape, angular_velocity), "rad/s",
                              "with which it turns on about its origin between updates", 1e3)},
        surface_rows<Shape>());
};

Shape prepared(Shape params, const Limits& limits) noexcept;
void adopt(const Shape& params, const Shape* previous, Shape::State& state, const Probe& probe) noexcept;
Contact contact(const Shape& params, Shape::State& state, const Probe& probe, double dt) noexcept;
std::optional<Bound> bound(const Shape& params, const Shape::State& state) noexcept;
void out_of_reach(const Shape& params, Shape::State& state) noexcept;

}  // namespace knurl
