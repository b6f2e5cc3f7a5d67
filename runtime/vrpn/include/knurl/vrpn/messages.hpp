#pragma once

/// @file
/// The messages of VRPN that this server knows: their names, and what stands in their payloads. Pure functions.
///
/// Positions are in metres, forces in newtons, in the frame that the server's option --axes names.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <knurl/reps/vec.hpp>
#include <knurl/vrpn/wire.hpp>

namespace knurl::vrpn {

/// Types of messages. The number is the id under which this server describes a type.
enum class Type : std::int32_t {
    /// Is a server there?
    ping,
    /// It is.
    pong,
    /// A line for the user.
    text,
    /// Position and orientation.
    pos_quat,
    /// Velocity.
    velocity,
    /// Asks for the workspace.
    request_workspace,
    /// The workspace.
    workspace,
    /// Asks for the transform to the room.
    request_to_room,
    /// The transform to the room.
    to_room,
    /// Asks for the transform from the tracker's unit to its sensor.
    request_unit_to_sensor,
    /// The transform from the tracker's unit to its sensor.
    unit_to_sensor,
    /// How many reports a second.
    set_update_rate,
    /// Makes the hand's place the origin.
    reset_origin,
    /// A button went down or came up.
    button_change,
    /// All buttons.
    button_states,
    /// Force on the hand.
    force,
    /// Surface contact point.
    contact_point,
    /// No force, and why.
    force_error,
    /// A plane.
    plane,
    /// Adhesion, texture and buzz of the plane before.
    plane_effects,
    /// A force field.
    force_field,
    /// An effect of the client's own.
    custom_effect,
    /// A mesh's vertex.
    set_vertex,
    /// A mesh's normal.
    set_normal,
    /// A mesh's triangle.
    set_triangle,
    /// Takes a triangle away.
    remove_triangle,
    /// The changes to a mesh are complete.
    update_trimesh,
    /// Places a mesh.
    transform_trimesh,
    /// How a mesh is to be computed.
    set_trimesh_type,
    /// Takes a mesh away.
    clear_trimesh,
    /// Takes an object away.
    remove_object,
    /// A new object outside of the scene.
    add_object_outside,
    /// A new object.
    add_object,
    /// An object under another one.
    move_to_parent,
    /// Where an object is.
    object_position,
    /// How large an object is.
    object_scale,
    /// How an object is turned.
    object_orientation,
    /// Where the hand's workspace is in the scene.
    haptic_origin,
    /// Where the scene is.
    scene_origin,
    /// How large the hand's workspace is in the scene.
    haptic_scale,
    /// Whether an object can be felt.
    object_touchable,
    /// Switches the constraint.
    constraint_enable,
    /// Point, line or plane.
    constraint_mode,
    /// The point.
    constraint_point,
    /// A point of the line.
    constraint_line_point,
    /// Direction of the line.
    constraint_line_direction,
    /// A point of the plane.
    constraint_plane_point,
    /// Normal of the plane.
    constraint_plane_normal,
    /// Stiffness.
    constraint_stiffness,
};
/// How many types there are.
inline constexpr std::size_t type_count = 49;

/// The name of a type, as both ends describe it.
std::string_view name_of(Type type) noexcept;
/// The type of that name; none: this server does not know it.
std::optional<Type> type_of(std::string_view name) noexcept;

/// A line for the user: how bad it is.
enum class Severity : std::int32_t {
    /// All is well.
    normal = 0,
    /// Something is not as the client may think.
    warning = 1,
    /// Something does not work.
    error = 2,
};
/// Why there is no force.
enum class ForceError : std::int32_t {
    /// A value is out of range.
    range = 0,
    /// The servo is too slow.
    too_slow = 1,
    /// Too much force, too hot, or an amplifier.
    device = 2,
    /// Anything else.
    other = 3,
    /// There is force again.
    none = 4,
};

/// Payloads that this server writes.
namespace payload {
/// A line for the user.
void text(PayloadWriter& out, Severity severity, std::string_view line);
/// Position and orientation of a sensor.
void pos_quat(PayloadWriter& out, std::int32_t sensor, const Vec3& position, const Quat& orientation);
/// Velocity of a sensor (m/s), and its rotation within `dt` (s).
void velocity(PayloadWriter& out, std::int32_t sensor, const Vec3& velocity, const Quat& rotation, double dt);
/// Corners of the workspace.
void workspace(PayloadWriter& out, const Vec3& low, const Vec3& high);
/// A position and an orientation alone: the tracker in the room, the surface contact point.
void pose(PayloadWriter& out, const Vec3& position, const Quat& orientation);
/// A button, and whether it is down.
void button_change(PayloadWriter& out, std::int32_t button, bool down);
/// The first `count` buttons.
void button_states(PayloadWriter& out, std::uint32_t down, std::int32_t count);
/// A force (N).
void force(PayloadWriter& out, const Vec3& force);
/// Why there is no force.
void force_error(PayloadWriter& out, ForceError error);
}  // namespace payload

/// A plane: a x + b y + c z + d < 0 is inside.
struct PlaneMessage {
    /// a, b, c, d (d: m).
    std::array<float, 4> plane{};
    /// Stiffness as a share of the largest (1).
    float stiffness = 0;
    /// Damping; see Mapping::damping_unit.
    float damping = 0;
    /// Friction while sliding (1).
    float dynamic_friction = 0;
    /// Friction until it slides (1).
    float static_friction = 0;
    /// Which plane.
    std::int32_t index = 0;
    /// Time over which it takes effect (cycles of 1 ms).
    std::int32_t recovery = 0;
    /// All of a, b, c and d are zero: the plane stops.
    bool stops() const noexcept { return plane == std::array<float, 4>{}; }
};

/// What comes after a plane.
struct PlaneEffectsMessage {
    /// Adhesion across the surface.
    float normal_adhesion = 0;
    /// Adhesion along the surface.
    float lateral_adhesion = 0;
    /// Texture: amplitude (m).
    float texture_amplitude = 0;
    /// Texture: wavelength (m).
    float texture_wavelength = 0;
    /// Buzz: amplitude (N).
    float buzz_amplitude = 0;
    /// Buzz: frequency (Hz).
    float buzz_frequency = 0;
    friend bool operator==(const PlaneEffectsMessage&, const PlaneEffectsMessage&) = default;
};

/// An effect of a server's own. Those of VRPN for a Phantom know one, number 0: a buzz for a time. Any other number stops
/// it; a client's stopEffect() sends such a one.
struct EffectMessage {
    /// The number of the buzz.
    static constexpr std::uint32_t buzz = 0;
    /// Number of the effect.
    std::uint32_t number = 0;
    /// How many of `values` came.
    std::uint32_t count = 0;
    /// Amplitude (N), frequency (Hz), duration (s), direction. A client may leave out the last ones.
    std::array<float, 6> values{};
};

/// A force field: force + jacobian (x - origin) within the radius.
struct FieldMessage {
    /// Where it is known (m).
    std::array<float, 3> origin{};
    /// Force there (N).
    std::array<float, 3> force{};
    /// How the force (rows) changes with the position (columns) (N/m).
    std::array<float, 9> jacobian{};
    /// Where it ends (m).
    float radius = 0;
    /// It gives nothing.
    bool stops() const noexcept { return radius == 0; }
};

/// A vertex or a normal of a mesh.
struct VertexMessage {
    /// Which object.
    std::int32_t object = 0;
    /// Which vertex or normal.
    std::int32_t index = 0;
    /// The vertex (m), or the normal.
    std::array<float, 3> value{};
};

/// A triangle of a mesh.
struct TriangleMessage {
    /// Which object.
    std::int32_t object = 0;
    /// Which triangle.
    std::int32_t index = 0;
    /// Its vertices.
    std::array<std::int32_t, 3> vertices{};
    /// Its normals; -1: none.
    std::array<std::int32_t, 3> normals{};
};

/// The changes to a mesh are complete, and this is its material.
struct TrimeshMessage {
    /// Which object.
    std::int32_t object = 0;
    /// Stiffness as a share of the largest (1).
    float stiffness = 0;
    /// Damping; see Mapping::damping_unit.
    float damping = 0;
    /// Friction until it slides (1).
    float static_friction = 0;
    /// Friction while sliding (1).
    float dynamic_friction = 0;
};

/// What an object is or does, in numbers: its id, and as many as the type has.
struct ObjectMessage {
    /// Which object.
    std::int32_t object = 0;
    /// Integers after it: a triangle, a parent, a type, a flag.
    std::int32_t number = 0;
    /// Floating-point numbers after it.
    std::array<float, 16> values{};
};

/// Each returns nothing if the payload has another length than the type has.
std::optional<PlaneMessage> read_plane(std::span<const std::byte> payload) noexcept;
/// See read_plane.
std::optional<PlaneEffectsMessage> read_plane_effects(std::span<const std::byte> payload) noexcept;
/// See read_plane. Numbers behind the ones that are known are left out.
std::optional<EffectMessage> read_effect(std::span<const std::byte> payload) noexcept;
/// See read_plane.
std::optional<FieldMessage> read_field(std::span<const std::byte> payload) noexcept;
/// See read_plane.
std::optional<VertexMessage> read_vertex(std::span<const std::byte> payload) noexcept;
/// See read_plane.
std::optional<TriangleMessage> read_triangle(std::span<const std::byte> payload) noexcept;
/// See read_plane.
std::optional<TrimeshMessage> read_trimesh(std::span<const std::byte> payload) noexcept;
/// A message about one object: set_trimesh_type, remove_triangle, transform_trimesh, add_object, object_position and the
/// others of that kind. See read_plane.
std::optional<ObjectMessage> read_object(Type type, std::span<const std::byte> payload) noexcept;
/// A message of `count` (at most 16) floating-point numbers: haptic_origin, constraint_point, ... See read_plane.
std::optional<std::array<float, 16>> read_floats(std::span<const std::byte> payload,
                                                 std::size_t count) noexcept;

}  // namespace knurl::vrpn
