#pragma once

/// @file
/// A surface is geometry plus material. The material is what it feels like along and into it: fields that
/// every surface has. They say nothing about where it is, so the scene acts on them once, on the solved
/// contact of each probe (friction.hpp, texture.hpp).
///
/// Every surface declares its parameters in this order, so that a pose is their prefix (geometry_bytes):
///
/// ~~~{.unparsed}
///   geometry, velocity and, where it turns, angular_velocity | stiffness, damping, recovery, ..., texture
///   what is sent while it moves                              | its material, and how it acts (`update` of a plane)
/// ~~~

#include <array>
#include <cstddef>
#include <cstdint>

#include <knurl/reps/field.hpp>
#include <knurl/reps/limits.hpp>

namespace knurl {

/// Elastic Coulomb friction: the tip is held by a spring to an anchor, which is dragged once the force
/// exceeds the cone.
struct Friction {
    /// Coefficient until it slides (1), 0 to 100; typically 0.05 to 1. `automatic`: as `dynamic`.
    double static_ = automatic;
    /// Coefficient while it slides (1), 0 to 100; no more than `static_`.
    double dynamic = 0;
    /// Viscous friction against the sliding velocity (N s/m), 0 to 1e6; its force never exceeds the normal
    /// force.
    double viscous = 0;
};

/// How a snag gives way.
enum class SnagLaw : std::uint32_t {
    /// Constant tangential stiffness, and the anchor is dragged: gives back no more than it stored.
    passive = 0,
    /// The paper's own law, for comparison. It generates energy when the normal force changes while stuck.
    paper = 1,
};

/// Snags (Mark et al., SIGGRAPH 96, 2.1): the tip sticks at points that lie some way apart. In use when
/// `k_stick` and `d_snap` are positive or `k_kinetic` is; then it takes the place of Coulomb friction.
struct Snag {
    /// Friction between snags by normal force (1), 0 to 100.
    double k_kinetic = 0;
    /// Stiffness of a snag by normal force (1/m).
    double k_stick = 0;
    /// Distance at which a snag lets go (m), 0 to 1000.
    double d_snap = 0;
    /// Distance from one snag to the next (m); 0: always stuck, static friction.
    double d_mean = 0;
    /// Range over which that distance is spread evenly (m): d_mean +- d_spread / 2.
    double d_spread = 0;
    /// Seed of the distances' generator.
    std::uint32_t seed = 1;
    /// How a snag gives way.
    SnagLaw law = SnagLaw::passive;
};

/// Shape of a texture's relief f.
enum class TexturePattern : std::uint32_t {
    /// f = cos(2 pi u / wavelength), u along `direction`.
    ridges = 0,
    /// The mean of ridges along `direction` and of ridges across it.
    grid = 1,
    /// f = cos(2 pi r / wavelength), r the distance from `origin` along the surface.
    rings = 2,
};

/// A relief of height A f on the surface, -1 <= f <= 1, anchored in the world (and carried by the surface's
/// velocity).
struct Texture {
    /// Amplitude A (m): half the height from valley to peak, 0 to 1; typically 20 to 200 µm.
    double amplitude = 0;
    /// Distance from peak to peak (m), 6e-7 to 1000.
    double wavelength = 1e-3;
    /// Direction across the ridges, of any length but 0.
    Vec3 direction = {1, 0, 0};
    /// A point on a peak, or the centre of rings (m), world frame.
    Vec3 origin = {};
    /// Shape of the relief.
    TexturePattern pattern = TexturePattern::ridges;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

/// Clamps stiffness, damping and viscous friction to what the device stands.
void clamp_material(double& stiffness, double& damping, Friction& friction, const Limits& limits) noexcept;

namespace detail {
inline constexpr std::string_view snag_laws[] = {"passive", "paper"};
inline constexpr std::string_view texture_patterns[] = {"ridges", "grid", "rings"};
}  // namespace detail

/// Joins two tables of rows.
template <std::size_t A, std::size_t B>
constexpr std::array<Field, A + B> join_rows(const std::array<Field, A>& a, const std::array<Field, B>& b) {
    std::array<Field, A + B> all{};
    for (std::size_t i = 0; i < A; ++i) all[i] = a[i];
    for (std::size_t i = 0; i < B; ++i) all[A + i] = b[i];
    return all;
}

/// The rows of a surface's material. R has these members.
template <class R>
constexpr auto material_rows() {
    using Type = Field::Type;
    return std::array{
        stiffness_row(offsetof(R, stiffness), "force per depth"),
        number_row("damping", offsetof(R, damping), "N s/m", "along the normal, never pulling"),
        recovery_row(offsetof(R, recovery)),
        number_row("braking", offsetof(R, braking), "1",
                   "share of the hand's momentum that a pulse takes away at entry", 0, 1),
        Field{.name = "friction.static",
              .offset = offsetof(R, friction.static_),
              .unit = "1",
              .meaning = "Coulomb coefficient until it slides",
              .minimum = 0,
              .maximum = 100,
              .automatic_allowed = true},
        number_row("friction.dynamic", offsetof(R, friction.dynamic), "1",
                   "Coulomb coefficient while it slides", 0, 100),
        number_row("friction.viscous", offsetof(R, friction.viscous), "N s/m",
                   "against the sliding velocity, at most the normal force", 0, 1e6),
        number_row("snag.k_kinetic", offsetof(R, snag.k_kinetic), "1",
                   "friction between snags by normal force", 0, 100),
        number_row("snag.k_stick", offsetof(R, snag.k_stick), "1/m", "stiffness of a snag by normal force"),
        number_row("snag.d_snap", offsetof(R, snag.d_snap), "m", "at which a snag lets go", 0, 1e3),
        number_row("snag.d_mean", offsetof(R, snag.d_mean), "m", "from one snag to the next; 0: always stuck",
                   0, 1e3),
        number_row("snag.d_spread", offsetof(R, snag.d_spread), "m",
                   "over which that distance is spread evenly", 0, 1e3),
        Field{.name = "snag.seed",
              .type = Type::integer,
              .offset = offsetof(R, snag.seed),
              .meaning = "of the distances' generator"},
        choice_row("snag.law", offsetof(R, snag.law), "how a snag gives way", detail::snag_laws),
        number_row("texture.amplitude", offsetof(R, texture.amplitude), "m",
                   "half the height from valley to peak", 0, 1),
        number_row("texture.wavelength", offsetof(R, texture.wavelength), "m", "from peak to peak", 6e-7,
                   1e3),
        direction_row("texture.direction", offsetof(R, texture.direction), "across the ridges"),
        vector_row("texture.origin", offsetof(R, texture.origin), "m",
                   "a point on a peak; the centre of rings"),
        choice_row("texture.pattern", offsetof(R, texture.pattern), "shape of the relief",
                   detail::texture_patterns),
    };
}

/// The rows of all that every surface has besides its geometry.
template <class R>
constexpr auto surface_rows() {
    return join_rows(std::array{vector_row("velocity", offsetof(R, velocity), "m/s",
                                           "with which it moves on between updates", 1e3)},
                     material_rows<R>());
}

/// The contradiction that every surface's material can have: the first entry of its `contradictions`.
inline constexpr std::string_view static_below_dynamic = "is below friction.dynamic; give at least as much";

/// Number of the row with this name; Verdict::no_field: there is none.
template <class R>
constexpr std::uint32_t row_of(std::string_view name) {
    std::uint32_t index = 0;
    for (const Field& field : Describe<R>::fields) {
        if (field.name == name) return index;
        ++index;
    }
    return Verdict::no_field;
}

/// The check that is made of every surface's material, beside the one that its Describe makes of its
/// geometry.
template <class R>
Verdict check_material(const R& params) noexcept {
    if (params.friction.static_ != automatic && params.friction.static_ < params.friction.dynamic) {
        constexpr std::uint32_t row = row_of<R>("friction.static");
        return {Verdict::Code::contradiction, row, params.friction.static_, 0};
    }
    return {};
}

}  // namespace knurl
