#pragma once

/// @file
/// The two kinds of representation: contacts must be solved together, effects must not.

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include <knurl/reps/bounds.hpp>
#include <knurl/reps/field.hpp>
#include <knurl/reps/hand_load.hpp>
#include <knurl/reps/limits.hpp>
#include <knurl/reps/material.hpp>
#include <knurl/reps/motion.hpp>
#include <knurl/reps/probe.hpp>
#include <knurl/reps/wrench.hpp>

namespace knurl {

/// The tangent plane of a surface at the foot of the probe: points x with normal . (x - foot) >= 0 are free.
struct Contact {
    /// Unit normal, towards free space.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    /// Signed height of the probe's surface over the tangent plane (m); negative: that deep in it.
    double height = 0;
    /// Stiffness as applied (N/m).
    double stiffness = 0;
    /// Damping as applied (N s/m).
    double damping = 0;
    /// Velocity of the surface's material at the foot (m/s).
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    /// Factor on the surface's own coefficients of friction at this place (1).
    double friction = 1;
};

/// A surface at some point: as a Contact there, and how its normal turns.
struct CurvedContact {
    /// Unit normal: the height's gradient.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    /// Signed height of the probe's surface there (m).
    double height = 0;
    /// Second derivatives of the height (1/m).
    Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();
};

/// A ball outside of which a surface is out of reach: its height there is positive.
struct Bound {
    /// Centre at the moment (m), world frame.
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    /// Radius (m).
    double radius = 0;
    /// Velocity of the centre (m/s), of a surface that turns.
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

/// The plane of a surface that stands still between changes; points with normal . x >= offset are free.
struct HalfSpace {
    /// Unit normal, towards free space.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    /// Offset along the normal (m).
    double offset = 0;
    /// Damping along the normal (N s/m).
    double damping = 0;
};

// clang-format 14 breaks requirements and the table below apart.
// clang-format off

/// R and R::State are trivially copyable, and within max_parameter_bytes and max_state_bytes.
template <class R>
concept ParametersWithState =
    std::is_trivially_copyable_v<R> && sizeof(R) <= max_parameter_bytes &&
    std::is_trivially_copyable_v<typename R::State> && sizeof(typename R::State) <= max_state_bytes;

/// Parameters are the application's: a trivially copyable aggregate of fixed-width members in SI units.
/// State is the servo's. All functions are noexcept and depend on their arguments alone.
template <class R>
concept Representation = ParametersWithState<R> &&
    requires(R params, const R& previous, typename R::State& state, const Probe& probe, const Limits& limits) {
        { Describe<R>::name } -> std::convertible_to<std::string_view>;
        { std::span<const Field>(Describe<R>::fields) };
        // Validated parameters as the servo uses them (unit normal, stiffness within the limits).
        { prepared(params, limits) } noexcept -> std::same_as<R>;
        // New parameters take effect: `previous` is null for one just added. Parameters equal to the previous
        // ones to the bit never reach adopt.
        { adopt(params, &previous, state, probe) } noexcept;
    };

/// A representation that gives a tangent plane; all surfaces of a probe are solved together.
template <class R>
concept Surface = Representation<R> &&
    requires(const R& params, typename R::State& state, const Probe& probe, double dt) {
        { contact(params, state, probe, dt) } noexcept -> std::same_as<Contact>;
        { state.motion } -> std::same_as<Motion&>;            // by which it moves on; the scene may make it stay
        { params.stiffness } -> std::convertible_to<double>;  // N/m, the same between changes
        { params.velocity } -> std::convertible_to<Vec3>;     // m/s, likewise
        { params.friction } -> std::convertible_to<Friction>;
        { params.snag } -> std::convertible_to<Snag>;
        { params.texture } -> std::convertible_to<Texture>;
        { params.braking } -> std::convertible_to<double>;
    };

/// A representation that gives a wrench, a function of the probe alone; the wrenches of all effects are
/// added.
template <class R>
concept Effect = Representation<R> &&
    requires(const R& params, typename R::State& state, const Probe& probe, double dt) {
        { evaluate(params, state, probe, dt) } noexcept -> std::same_as<Wrench>;
    };

/// The leading bytes of R's parameters that an update may bring alone; the rest stays as it is then. Of a
/// surface its geometry with the velocity: all before the first field of its material. Of an effect, which is
/// small, all.
template <Representation R>
consteval std::size_t geometry_bytes() {
    std::size_t bytes = sizeof(R);
    if constexpr (Surface<R>)
        for (const Field& row : material_rows<R>()) bytes = std::min(bytes, row.offset);
    return bytes;
}

/// Each field lies in the geometry or behind it, and the velocity in it, as material.hpp orders them.
template <Representation R>
consteval bool geometry_comes_first() {
    for (const Field& row : Describe<R>::fields) {
        const bool begins = row.offset < geometry_bytes<R>();
        const bool ends = row.offset + row.bytes() <= geometry_bytes<R>();
        if (begins != ends || (row.name == "velocity" && !begins)) return false;
    }
    return geometry_bytes<R>() % 8 == 0;
}

/// @page optional_functions Optional functions of a representation
///
/// Each is found by its name (argument-dependent lookup) and is optional.
///
/// - `std::optional<HalfSpace> standing(const R&)`: a surface that is one plane until it changes: the scene
///   scans its plane with all others, without a call. With `void prepare_geometry(R&)`, the geometry's part
///   of prepared(), an update of the geometry alone takes a shorter way
/// - `std::optional<Bound> bound(const R&, const R::State&)`:
///   a surface that is not evaluated where it is out of reach; without it, or without a value, it is
///   evaluated in every cycle
/// - `double clearance(const R&, const R::State&, const Probe&)`:
///   a surface without an end, while it stands still: that far (m) the probe may go before it touches; 0
///   where it holds the probe. It changes by no more than the probe moves
/// - `std::optional<Bound> bound(const R&)`:
///   an effect that gives nothing where the probe's position is outside of that ball, whatever it remembers:
///   there it is not evaluated, and no time passes for it
/// - `bool powerless(const R&)`:
///   an effect that gives nothing anywhere, as its parameters stand, nor changes by itself: not evaluated
/// - `bool arrived(const R&, const R::State&)`: an effect that moves towards new parameters: evaluated until
///   it has arrived, though it gives nothing, and through a silence. All other time of an effect is the
///   scene's to stop: in a silence through which it holds, and where one has taken it away, evaluate is
///   called with dt = 0
/// - `void out_of_reach(const R&, R::State&)`: beside bound(): it was not evaluated for a while and forgets
///   its path
/// - `std::uint32_t contacts(const R&, R::State&, const Probe&, double dt, std::span<Contact> out)`:
///   a surface with up to R::max_contacts tangent planes at once (the corner of a hollow box): fills in those
///   that matter
/// - `std::uint32_t curved(const R&, const R::State&, const Probe&, const Probe& there, std::span<CurvedContact> out)`:
///   a surface that is not flat: what `contact` has answered for the probe in this cycle, as it is at another
///   place; as many as it has tangent planes. 0: those of this cycle hold there too (a face that holds the
///   probe). Where the answer changes with the probe, it must agree with the tangent plane at the probe's
///   foot
/// - `void lean(const R&, R::State&, const Probe& there, double below)`: beside curved(): where it meets
///   others, so that the plane by which it holds a deep probe is the one that acts there. In layers that are
///   harder than `below` (N/m) it meets none of them; infinity: it is in no harder layer
/// - `bool plane_alone(const R&, const R::State&, const Probe&, double stiffness, CurvedContact& out)`:
///   beside lean(): in a layer of that stiffness (N/m) it holds the probe by another plane than its
///   contact's, `out`
/// - `R::turns`:
///   a surface whose material moves differently from place to place: Contact::velocity counts, not R's. Its
///   bound holds while it moves on: where it is out of reach it is not evaluated, and is put where it has
///   come to before it is evaluated again
/// - `R::follows`:
///   a surface that the proxy enters and leaves: contact() reads Probe::path (proxy_path.hpp)
/// - `bool recovers_itself(const R&)`:
///   its own state brings a change in: left out of the cross-fade
/// - `HandLoad load(const R&, const R::State&, const Probe&)`:
///   how stiff and how damped an effect is, at the probe (hand_load.hpp); without it, as its members
///   `stiffness` (N/m) and `damping` (N s/m) say, alike in every direction; with none of these, not at all.
///   Its `energy.held` (J) is what the hand can get out of the effect from there, at most: without it the
///   budget may give back more than it took where the effect's stiffness depends on the place
/// - `R carried(const R& old, const R& next)`:
///   an effect's `old` with all that moves by itself from `next`; its state, too, unless there is a
///   State::moves_alike, which says that both move by themselves and alike
/// - `void settle(const R&, R::State&)`:
///   ends every motion and recovery at once
///
/// A member `asset` names one of the scene's (Scene::set_asset); State::asset is that one when adopt is
/// called, or null.
///
/// A member `recovery` or else `duration` (s) is the time of its cross-fade; with neither it is automatic.
/// Members `friction`, `snag`, `texture` and `braking` (material.hpp) are a surface's material: the scene
/// acts on them.

// clang-format on

}  // namespace knurl
