#include "commands.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <knurl/reps/taylor.hpp>
#include <knurl/reps/vibration.hpp>

#include "turn.hpp"

namespace knurl::vrpn {

namespace {

constexpr double most_force = 1000;        // N: more is a mistake
constexpr double most_amplitude = 0.01;    // m, of a texture
constexpr double least_wavelength = 1e-6;  // m
constexpr double longest_effect = 1e6;     // s

const std::string wrong_length = "its payload has a wrong length";

/// Across the ridges of a texture: along the plane.
Vec3 along(const Vec3& normal) {
    return to_plain(to_eigen(normal).unitOrthogonal());
}

bool has_direction(const Vec3& v) {
    return to_eigen(v).norm() >= 1e-6;
}

std::string refused_material(const PlaneMessage& m) {
    std::string refused = refuse("kspring", m.stiffness, 0, 1e9);
    if (refused.empty()) refused = refuse("kdamp", m.damping, 0, 1e9);
    if (refused.empty()) refused = refuse("dynamic friction", m.dynamic_friction, 0, 100);
    if (refused.empty()) refused = refuse("static friction", m.static_friction, 0, 100);
    if (refused.empty()) refused = refuse("recovery", m.recovery, 0, most_recovery);
    return refused;
}

}  // namespace

bool commands_force(Type type) noexcept {
    return type >= Type::plane && type <= Type::constraint_stiffness;
}

template <class R>
std::string Commands::put(const std::string& name, const R& params) {
    std::vector<std::byte> bytes(sizeof params);
    std::memcpy(bytes.data(), &params, sizeof params);
    if (there_.contains(name)) return hand_->set(name, bytes);
    std::string refused = hand_->add(name, kind_number<R>(), bytes);
    if (refused.empty()) there_.insert(name);
    return refused;
}

void Commands::drop(const std::string& name) {
    if (there_.erase(name) > 0) hand_->remove(name);
}

Outcome Commands::take(Type type, std::span<const std::byte> payload, double max_stiffness) {
    switch (type) {
        case Type::plane:
            return plane(payload, max_stiffness);
        case Type::plane_effects:
            return plane_effects(payload);
        case Type::force_field:
            return field(payload);
        case Type::custom_effect:
            return effect(payload);
        case Type::haptic_origin:
        case Type::scene_origin:
        case Type::haptic_scale:
            return {.refused =
                        "the scene is that of the device: place objects by their own position, scale and "
                        "orientation"};
        default:
            break;
    }
    if (type >= Type::constraint_enable) return constraint(type, payload);
    return trimesh(type, payload, max_stiffness);
}

Outcome Commands::plane(std::span<const std::byte> payload, double max_stiffness) {
    const auto m = read_plane(payload);
    if (!m) return {.refused = wrong_length};
    if (m->index < 0 || m->index >= most_planes)
        return {.refused = fmt::format("plane {} is none; it must be 0 to {}", m->index, most_planes - 1)};
    const auto index = static_cast<std::size_t>(m->index);
    const std::string name = fmt::format("plane {}", m->index);
    PlaneState& state = planes_[index];
    if (m->stops()) {
        drop(name);
        state.there = false;
        return {.refused = buzz()};
    }
    std::string refused = refuse_all("the plane", m->plane, farthest);
    if (refused.empty()) refused = refused_material(*m);
    if (refused.empty() && !has_direction(vec_of(m->plane.data())))
        refused = "its normal a, b, c has no direction";
    if (!refused.empty()) return {.refused = fmt::format("plane {}: {}", m->index, refused)};

    Plane& plane = state.plane;
    plane.normal = mapping_.axes.back().direction(vec_of(m->plane.data()));
    plane.offset = -double{m->plane[3]};
    plane.stiffness = std::min(1.0, double{m->stiffness}) * max_stiffness;
    plane.damping = mapping_.damping_unit * double{m->damping};
    plane.recovery = 1e-3 * m->recovery;
    // At once, too, a surface rises under the hand no faster than the scene allows; only a fade knows of that.
    plane.update = m->recovery > 0 ? mapping_.update : PlaneUpdate::fade;
    plane.friction = {.static_ = std::max(m->static_friction, m->dynamic_friction),
                      .dynamic = m->dynamic_friction};
    plane.texture.direction = along(plane.normal);
    state.there = true;
    last_plane_ = index;
    refused = put(name, plane);
    return {.refused = refused.empty() ? buzz() : refused};
}

/// It says no index: it belongs to the plane before.
Outcome Commands::plane_effects(std::span<const std::byte> payload) {
    const auto m = read_plane_effects(payload);
    if (!m) return {.refused = wrong_length};
    std::string refused = refuse("texture amplitude", m->texture_amplitude, 0, most_amplitude);
    if (refused.empty()) refused = refuse("texture wavelength", m->texture_wavelength, 0, farthest);
    if (refused.empty()) refused = refuse("buzz amplitude", m->buzz_amplitude, 0, most_force);
    if (refused.empty()) refused = refuse("buzz frequency", m->buzz_frequency, 0, 1e5);
    if (!refused.empty()) return {.refused = fmt::format("plane {}: {}", last_plane_, refused)};
    Outcome outcome;
    if (m->normal_adhesion != 0 || m->lateral_adhesion != 0)
        outcome.remark = "adhesion is not felt: this server has nothing that stands for it";
    effects_ = *m;
    PlaneState& state = planes_[last_plane_];
    if (!state.there) return outcome;
    const bool rough = m->texture_amplitude > 0 && m->texture_wavelength >= least_wavelength;
    Texture texture = state.plane.texture;
    texture.amplitude = rough ? double{m->texture_amplitude} : 0;
    texture.wavelength = rough ? double{m->texture_wavelength} : Texture{}.wavelength;
    const bool same = texture.amplitude == state.plane.texture.amplitude &&
                      texture.wavelength == state.plane.texture.wavelength;
    state.plane.texture = texture;
    if (!same) outcome.refused = put(fmt::format("plane {}", last_plane_), state.plane);
    if (outcome.refused.empty()) outcome.refused = buzz();
    return outcome;
}

/// Along the normal of the plane that was sent last, while a surface is touched.
std::string Commands::buzz() {
    const PlaneState& state = planes_[last_plane_];
    if (!state.there || effects_.buzz_amplitude == 0) {
        drop("buzz");
        return {};
    }
    return put("buzz", Vibration{.direction = state.plane.normal,
                                 .amplitude = touched_ ? double{effects_.buzz_amplitude} : 0,
                                 .frequency = effects_.buzz_frequency});
}

/// A buzz for a time, whatever is touched. What is left out of a message stays as it was.
Outcome Commands::effect(std::span<const std::byte> payload) {
    const auto m = read_effect(payload);
    if (!m) return {.refused = wrong_length};
    if (m->number != EffectMessage::buzz) {
        drop("effect");
        return {};
    }
    // A direction comes whole or not at all.
    std::array<float, 6> values = effect_;
    std::copy_n(m->values.begin(), m->count < 6 ? std::min(m->count, 3u) : 6u, values.begin());
    const auto direction = std::span(values).subspan<3>();
    std::string refused = refuse("the effect's amplitude", values[0], 0, most_force);
    if (refused.empty()) refused = refuse("the effect's frequency", values[1], 0, 1e5);
    if (refused.empty()) refused = refuse("the effect's duration", values[2], 0, longest_effect);
    if (refused.empty()) refused = refuse_all("the effect's direction", direction, farthest);
    if (refused.empty() && !has_direction(vec_of(direction.data())))
        refused = "the effect's direction is 0, 0, 0";
    if (!refused.empty()) return {.refused = refused};
    effect_ = values;
    effect_ends_ns_ = 0;
    return {.refused =
                put("effect", Vibration{.direction = mapping_.axes.back().direction(vec_of(direction.data())),
                                        .amplitude = values[0],
                                        .frequency = values[1]})};
}

void Commands::look(const Report& report) {
    bool changed = false;
    if (there_.contains("effect")) {
        if (effect_ends_ns_ == 0) effect_ends_ns_ = report.read_ns + std::llround(double{effect_[2]} * 1e9);
        if (report.read_ns >= effect_ends_ns_) {
            drop("effect");
            changed = true;
        }
    }
    const bool touched = (report.flags & report_flags::touching) != 0;
    if (std::exchange(touched_, touched) != touched && there_.contains("buzz")) {
        buzz();
        changed = true;
    }
    if (changed) hand_->sent();
}

Outcome Commands::field(std::span<const std::byte> payload) {
    const auto m = read_field(payload);
    if (!m) return {.refused = wrong_length};
    std::string refused = refuse("the radius of the field", m->radius, 0, 1e6);
    if (refused.empty()) refused = refuse_all("the origin of the field", m->origin, farthest);
    if (refused.empty()) refused = refuse_all("the force of the field", m->force, most_force);
    if (refused.empty()) refused = refuse_all("the jacobian of the field", m->jacobian, 1e6);
    if (!refused.empty()) return {.refused = refused};
    if (m->stops()) {
        drop("field");
        return {};
    }
    const gateway::Axes back = mapping_.axes.back();
    const Eigen::Matrix3d turn = turn_of(back);
    const Eigen::Matrix3d jacobian =
        Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(m->jacobian.data()).cast<double>();
    return {.refused = put("field", Taylor{.origin = back.position(vec_of(m->origin.data())),
                                           .force = back.direction(vec_of(m->force.data())),
                                           .jacobian = to_mat3(turn * jacobian * turn.transpose()),
                                           .radius = std::max(1e-6, double{m->radius})})};
}

Outcome Commands::constraint(Type type, std::span<const std::byte> payload) {
    if (type == Type::constraint_enable || type == Type::constraint_mode) {
        Payload in(payload);
        const auto value = in.take<std::int32_t>();
        if (!in.complete()) return {.refused = wrong_length};
        if (type == Type::constraint_enable)
            constrained_ = value != 0;
        else if (value < 0 || value > 3)
            return {.refused = fmt::format("constraint mode {} is none; it must be 0 to 3", value)};
        else
            mode_ = value;
        return {.refused = hold()};
    }
    const std::size_t count = type == Type::constraint_stiffness ? 1 : 3;
    const auto values = read_floats(payload, count);
    if (!values) return {.refused = wrong_length};
    if (type == Type::constraint_stiffness) {
        const std::string refused = refuse("the constraint's stiffness", values->front(), 0, 1e9);
        if (!refused.empty()) return {.refused = refused};
        constraint_.stiffness = double{values->front()};
        return {.refused = hold()};
    }
    const std::string refused = refuse_all("the constraint", *values, farthest);
    if (!refused.empty()) return {.refused = refused};
    const bool direction = type == Type::constraint_line_direction || type == Type::constraint_plane_normal;
    const Vec3 value = vec_of(values->data());
    if (direction && !has_direction(value)) return {.refused = "the constraint's direction is 0, 0, 0"};
    constraint_at_[static_cast<std::size_t>(type) - static_cast<std::size_t>(Type::constraint_point)] = value;
    return {.refused = hold()};
}

/// It is felt once it has a stiffness and, if it is no point, a direction.
std::string Commands::hold() {
    const auto& [point, line_point, line_direction, plane_point, plane_normal] = constraint_at_;
    const gateway::Axes back = mapping_.axes.back();
    const Vec3 at = mode_ == 1 ? point : mode_ == 2 ? line_point : plane_point;
    const Vec3 along = mode_ == 1 ? Vec3{0, 0, 1} : mode_ == 2 ? line_direction : plane_normal;
    if (!constrained_ || mode_ == 0 || constraint_.stiffness == 0 || along == Vec3{}) {
        drop("constraint");
        return {};
    }
    constraint_.shape = mode_ == 1   ? ConstraintShape::point
                        : mode_ == 2 ? ConstraintShape::line
                                     : ConstraintShape::plane;
    constraint_.origin = back.position(at);
    constraint_.direction = back.direction(along);
    return put("constraint", constraint_);
}

Outcome Commands::trimesh(Type type, std::span<const std::byte> payload, double max_stiffness) {
    switch (type) {
        case Type::set_vertex:
            if (const auto m = read_vertex(payload)) return {.refused = trimeshes_.vertex(*m)};
            break;
        case Type::set_normal:
            // The servo has normals of its own; a triangle that names some is shaded by them.
            if (read_vertex(payload)) return {};
            break;
        case Type::set_triangle:
            if (const auto m = read_triangle(payload)) return {.refused = trimeshes_.triangle(*m)};
            break;
        case Type::update_trimesh:
            if (const auto m = read_trimesh(payload))
                return {.refused = trimeshes_.update(*m, max_stiffness)};
            break;
        default:
            if (const auto m = read_object(type, payload)) return {.refused = trimeshes_.object(type, *m)};
            break;
    }
    return {.refused = wrong_length};
}

}  // namespace knurl::vrpn
