#include <algorithm>

#include <knurl/vrpn/messages.hpp>

namespace knurl::vrpn {

namespace {

constexpr std::array<std::string_view, type_count> names{
    "vrpn_Base ping_message",
    "vrpn_Base pong_message",
    "vrpn_Base text_message",
    "vrpn_Tracker Pos_Quat",
    "vrpn_Tracker Velocity",
    "vrpn_Tracker Request_Tracker_Workspace",
    "vrpn_Tracker Workspace",
    "vrpn_Tracker Request_Tracker_To_Room",
    "vrpn_Tracker To_Room",
    "vrpn_Tracker Request_Unit_To_Sensor",
    "vrpn_Tracker Unit_To_Sensor",
    "vrpn_Tracker set_update_rate",
    "vrpn_Tracker Reset_Origin",
    "vrpn_Button Change",
    "vrpn_Button States",
    "vrpn_ForceDevice Force",
    "vrpn_ForceDevice SCP",
    "vrpn_ForceDevice Force_Error",
    "vrpn_ForceDevice Plane",
    "vrpn_ForceDevice Plane2",
    "vrpn_ForceDevice Force_Field",
    "vrpn_ForceDevice Custom Effect",
    "vrpn_ForceDevice setVertex",
    "vrpn_ForceDevice setNormal",
    "vrpn_ForceDevice setTriangle",
    "vrpn_ForceDevice removeTriangle",
    "vrpn_ForceDevice updateTrimeshChanges",
    "vrpn_ForceDevice transformTrimesh",
    "vrpn_ForceDevice setTrimeshType",
    "vrpn_ForceDevice clearTrimesh",
    "vrpn_ForceDevice removeObject",
    "vrpn_ForceDevice addObjectExScene",
    "vrpn_ForceDevice addObject",
    "vrpn_ForceDevice moveToParent",
    "vrpn_ForceDevice setObjectPosition",
    "vrpn_ForceDevice setObjectScale",
    "vrpn_ForceDevice setObjectOrientation",
    "vrpn_ForceDevice setHapticOrigin",
    "vrpn_ForceDevice setSceneOrigin",
    "vrpn_ForceDevice setHapticScale",
    "vrpn_ForceDevice setObjectIsTouchable",
    "vrpn_ForceDevice constraint_enable",
    "vrpn_ForceDevice constraint_mode",
    "vrpn_ForceDevice constraint_point",
    "vrpn_ForceDevice constraint_linept",
    "vrpn_ForceDevice constraint_linedir",
    "vrpn_ForceDevice constraint_plpt",
    "vrpn_ForceDevice constraint_plnorm",
    "vrpn_ForceDevice constraint_KSpring",
};
static_assert(static_cast<std::size_t>(Type::constraint_stiffness) + 1 == type_count);

constexpr std::size_t text_bytes = 1024;

template <std::size_t N>
std::array<float, N> floats(Payload& in) noexcept {
    std::array<float, N> values{};
    for (float& value : values) value = in.take<float>();
    return values;
}

std::array<std::int32_t, 3> three_numbers(Payload& in) noexcept {
    std::array<std::int32_t, 3> values{};
    for (std::int32_t& value : values) value = in.take<std::int32_t>();
    return values;
}

template <class M>
std::optional<M> if_complete(const Payload& in, const M& message) noexcept {
    return in.complete() ? std::optional<M>(message) : std::nullopt;
}

void put(PayloadWriter& out, const Vec3& v) {
    out.put(v.x).put(v.y).put(v.z);
}
/// VRPN has the scalar last.
void put(PayloadWriter& out, const Quat& q) {
    out.put(q.x).put(q.y).put(q.z).put(q.w);
}

/// What stands after an object's id.
struct ObjectLayout {
    enum class Number { none, whole, half } number = Number::none;
    std::size_t floats = 0;
};

ObjectLayout layout_of(Type type) noexcept {
    using Number = ObjectLayout::Number;
    switch (type) {
        case Type::remove_triangle:
        case Type::set_trimesh_type:
        case Type::add_object:
        case Type::move_to_parent:
            return {.number = Number::whole, .floats = 0};
        case Type::object_touchable:
            return {.number = Number::half, .floats = 0};
        case Type::object_position:
        case Type::object_scale:
            return {.number = Number::none, .floats = 3};
        case Type::object_orientation:
            return {.number = Number::none, .floats = 4};
        case Type::transform_trimesh:
            return {.number = Number::none, .floats = 16};
        default:
            return {};
    }
}

}  // namespace

std::string_view name_of(Type type) noexcept {
    return names[static_cast<std::size_t>(type)];
}

std::optional<Type> type_of(std::string_view name) noexcept {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return static_cast<Type>(found - names.begin());
}

namespace payload {

void text(PayloadWriter& out, Severity severity, std::string_view line) {
    out.put(static_cast<std::int32_t>(severity)).put(std::uint32_t{0}).put_text(line, text_bytes);
}
void pos_quat(PayloadWriter& out, std::int32_t sensor, const Vec3& position, const Quat& orientation) {
    out.put(sensor).put(sensor);
    put(out, position);
    put(out, orientation);
}
void velocity(PayloadWriter& out, std::int32_t sensor, const Vec3& velocity, const Quat& rotation,
              double dt) {
    pos_quat(out, sensor, velocity, rotation);
    out.put(dt);
}
void workspace(PayloadWriter& out, const Vec3& low, const Vec3& high) {
    put(out, low);
    put(out, high);
}
void pose(PayloadWriter& out, const Vec3& position, const Quat& orientation) {
    put(out, position);
    put(out, orientation);
}
void button_change(PayloadWriter& out, std::int32_t button, bool down) {
    out.put(button).put(std::int32_t{down});
}
void button_states(PayloadWriter& out, std::uint32_t down, std::int32_t count) {
    out.put(count);
    for (std::int32_t i = 0; i < count; ++i) out.put(static_cast<std::int32_t>(down >> i & 1u));
}
void force(PayloadWriter& out, const Vec3& force) {
    put(out, force);
}
void force_error(PayloadWriter& out, ForceError error) {
    out.put(static_cast<std::int32_t>(error));
}

}  // namespace payload

std::optional<PlaneMessage> read_plane(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    PlaneMessage m;
    m.plane = floats<4>(in);
    m.stiffness = in.take<float>();
    m.damping = in.take<float>();
    m.dynamic_friction = in.take<float>();
    m.static_friction = in.take<float>();
    m.index = in.take<std::int32_t>();
    m.recovery = in.take<std::int32_t>();
    return if_complete(in, m);
}

std::optional<PlaneEffectsMessage> read_plane_effects(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    const auto values = floats<6>(in);
    return if_complete(in, PlaneEffectsMessage{.normal_adhesion = values[0],
                                               .lateral_adhesion = values[1],
                                               .texture_amplitude = values[2],
                                               .texture_wavelength = values[3],
                                               .buzz_amplitude = values[4],
                                               .buzz_frequency = values[5]});
}

std::optional<EffectMessage> read_effect(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    EffectMessage m;
    m.number = in.take<std::uint32_t>();
    const auto count = in.take<std::uint32_t>();
    if (!in.ok() || in.rest().size() != std::uint64_t{count} * sizeof(float)) return std::nullopt;
    m.count = std::min<std::uint32_t>(count, m.values.size());
    for (std::uint32_t i = 0; i < m.count; ++i) m.values[i] = in.take<float>();
    return m;
}

std::optional<FieldMessage> read_field(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    FieldMessage m;
    m.origin = floats<3>(in);
    m.force = floats<3>(in);
    m.jacobian = floats<9>(in);
    m.radius = in.take<float>();
    return if_complete(in, m);
}

std::optional<VertexMessage> read_vertex(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    VertexMessage m;
    m.object = in.take<std::int32_t>();
    m.index = in.take<std::int32_t>();
    m.value = floats<3>(in);
    return if_complete(in, m);
}

std::optional<TriangleMessage> read_triangle(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    TriangleMessage m;
    m.object = in.take<std::int32_t>();
    m.index = in.take<std::int32_t>();
    m.vertices = three_numbers(in);
    m.normals = three_numbers(in);
    return if_complete(in, m);
}

std::optional<TrimeshMessage> read_trimesh(std::span<const std::byte> payload) noexcept {
    Payload in(payload);
    TrimeshMessage m;
    m.object = in.take<std::int32_t>();
    m.stiffness = in.take<float>();
    m.damping = in.take<float>();
    m.static_friction = in.take<float>();
    m.dynamic_friction = in.take<float>();
    return if_complete(in, m);
}

std::optional<ObjectMessage> read_object(Type type, std::span<const std::byte> payload) noexcept {
    const ObjectLayout layout = layout_of(type);
    Payload in(payload);
    ObjectMessage m;
    m.object = in.take<std::int32_t>();
    if (layout.number == ObjectLayout::Number::whole) m.number = in.take<std::int32_t>();
    if (layout.number == ObjectLayout::Number::half) m.number = in.take<std::int16_t>();
    for (std::size_t i = 0; i < layout.floats; ++i) m.values[i] = in.take<float>();
    return if_complete(in, m);
}

std::optional<std::array<float, 16>> read_floats(std::span<const std::byte> payload,
                                                 std::size_t count) noexcept {
    Payload in(payload);
    std::array<float, 16> values{};
    for (std::size_t i = 0; i < count; ++i) values[i] = in.take<float>();
    return if_complete(in, values);
}

}  // namespace knurl::vrpn
