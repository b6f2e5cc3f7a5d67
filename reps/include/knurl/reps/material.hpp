#pragma once
// What a surface feels like along and into it: fields that every surface has. They say nothing about where it
// is, so the scene acts on them once, on the solved contact of each probe (friction.hpp, texture.hpp).

#include <array>
#include <cstddef>
#include <cstdint>

#include <knurl/reps/field.hpp>

namespace knurl {

/// Elastic Coulomb friction: the tip is held by a spring to an anchor, which is dragged once the force
/// exceeds the cone. `static_` automatic: as `dynamic`.
struct Friction {
    double static_ = automatic;  // 1, until it slides
    double dynamic = 0;          // 1, while it slides
    double viscous = 0;          // N s/m; never more than the normal force
};

/// How a snag gives way.
enum class SnagLaw : std::uint32_t {
    passive = 0,  // constant tangential stiffness, the anchor is dragged: gives back no more than it stored
    // the paper's own law, for comparison; generates energy when the normal force changes while stuck
    paper = 1,
};

/// Snags (Mark et al., SIGGRAPH 96, 2.1): the tip sticks at points that lie some way apart. In use when
/// `k_stick` and `d_snap` are positive or `k_kinetic` is; then it takes the place of Coulomb friction.
struct Snag {
    double k_kinetic = 0;  // 1, friction between snags by normal force
    double k_stick = 0;    // 1/m, stiffness of a snag by normal force
    double d_snap = 0;     // m, at which a snag lets go
    double d_mean = 0;     // m, from one snag to the next; 0: always stuck, static friction
    double d_spread = 0;   // m, over which that distance is spread evenly: d_mean +- d_spread / 2
    std::uint32_t seed = 1;
    SnagLaw law = SnagLaw::passive;
};

enum class TexturePattern : std::uint32_t {
    ridges = 0,  // cos(2 pi u / wavelength), u along `direction`
    grid = 1,    // the mean of that and the same across
    rings = 2,   // cos(2 pi r / wavelength), r the distance from `origin` along the surface
};

/// A relief of height A f on the surface, -1 <= f <= 1, anchored in the world (and carried by the surface's
/// velocity).
struct Texture {
    double amplitude = 0;      // m
    double wavelength = 1e-3;  // m
    Vec3 direction = {1, 0, 0};
    Vec3 origin = {};  // m
    TexturePattern pattern = TexturePattern::ridges;
    std::uint32_t reserved = 0;
};

namespace detail {
inline constexpr std::string_view snag_laws[] = {"passive", "paper"};
inline constexpr std::string_view texture_patterns[] = {"ridges", "grid", "rings"};
}  // namespace detail

/// The rows of all that every surface has besides its shape: stiffness, damping, recovery, braking, velocity
/// and the material. R has these members.
template <class R>
constexpr auto surface_rows() {
    using Type = Field::Type;
    return std::array{
        Field{.name = "stiffness",
              .offset = offsetof(R, stiffness),
              .unit = "N/m",
              .meaning = "force per depth",
              .minimum = 0,
              .maximum = 1e9,
              .infinity_allowed = true},
        Field{.name = "damping",
              .offset = offsetof(R, damping),
              .unit = "N s/m",
              .meaning = "along the normal, never pulling",
              .minimum = 0,
              .maximum = 1e9},
        recovery_row(offsetof(R, recovery)),
        Field{.name = "braking",
              .offset = offsetof(R, braking),
              .unit = "1",
              .meaning = "share of the hand's momentum that a pulse takes away at entry",
              .minimum = 0,
              .maximum = 1},
        Field{.name = "velocity",
              .type = Type::vector,
              .offset = offsetof(R, velocity),
              .unit = "m/s",
              .meaning = "with which it moves on between updates",
              .minimum = -1e3,
              .maximum = 1e3},
        Field{.name = "friction.static",
              .offset = offsetof(R, friction.static_),
              .unit = "1",
              .meaning = "Coulomb coefficient until it slides",
              .minimum = 0,
              .maximum = 100,
              .automatic_allowed = true},
        Field{.name = "friction.dynamic",
              .offset = offsetof(R, friction.dynamic),
              .unit = "1",
              .meaning = "Coulomb coefficient while it slides",
              .minimum = 0,
              .maximum = 100},
        Field{.name = "friction.viscous",
              .offset = offsetof(R, friction.viscous),
              .unit = "N s/m",
              .meaning = "against the sliding velocity, at most the normal force",
              .minimum = 0,
              .maximum = 1e6},
        Field{.name = "snag.k_kinetic",
              .offset = offsetof(R, snag.k_kinetic),
              .unit = "1",
              .meaning = "friction between snags by normal force",
              .minimum = 0,
              .maximum = 100},
        Field{.name = "snag.k_stick",
              .offset = offsetof(R, snag.k_stick),
              .unit = "1/m",
              .meaning = "stiffness of a snag by normal force",
              .minimum = 0,
              .maximum = 1e9},
        Field{.name = "snag.d_snap",
              .offset = offsetof(R, snag.d_snap),
              .unit = "m",
              .meaning = "at which a snag lets go",
              .minimum = 0,
              .maximum = 1e3},
        Field{.name = "snag.d_mean",
              .offset = offsetof(R, snag.d_mean),
              .unit = "m",
              .meaning = "from one snag to the next; 0: always stuck",
              .minimum = 0,
              .maximum = 1e3},
        Field{.name = "snag.d_spread",
              .offset = offsetof(R, snag.d_spread),
              .unit = "m",
              .meaning = "over which that distance is spread evenly",
              .minimum = 0,
              .maximum = 1e3},
        Field{.name = "snag.seed",
              .type = Type::integer,
              .offset = offsetof(R, snag.seed),
              .meaning = "of the distances' generator"},
        Field{.name = "snag.law",
              .type = Type::choice,
              .offset = offsetof(R, snag.law),
              .meaning = "how a snag gives way",
              .choices = detail::snag_laws},
        Field{.name = "texture.amplitude",
              .offset = offsetof(R, texture.amplitude),
              .unit = "m",
              .meaning = "half the height from valley to peak",
              .minimum = 0,
              .maximum = 1},
        Field{.name = "texture.wavelength",
              .offset = offsetof(R, texture.wavelength),
              .unit = "m",
              .meaning = "from peak to peak",
              .minimum = 6e-7,
              .maximum = 1e3},
        Field{.name = "texture.direction",
              .type = Type::vector,
              .offset = offsetof(R, texture.direction),
              .unit = "1",
              .meaning = "across the ridges",
              .minimum = -1e9,
              .maximum = 1e9,
              .nonzero = true},
        Field{.name = "texture.origin",
              .type = Type::vector,
              .offset = offsetof(R, texture.origin),
              .unit = "m",
              .meaning = "a point on a peak; the centre of rings",
              .minimum = -1e9,
              .maximum = 1e9},
        Field{.name = "texture.pattern",
              .type = Type::choice,
              .offset = offsetof(R, texture.pattern),
              .meaning = "shape of the relief",
              .choices = detail::texture_patterns},
    };
}

/// Contradictions that every surface can have: the first entries of its `contradictions`.
inline constexpr std::string_view static_below_dynamic = "is below friction.dynamic; give at least as much";

/// Of the field with this name.
template <class R>
constexpr std::uint32_t row_of(std::string_view name) {
    std::uint32_t index = 0;
    for (const Field& field : Describe<R>::fields) {
        if (field.name == name) return index;
        ++index;
    }
    return Verdict::no_field;
}

/// The check that every surface makes.
template <class R>
Verdict check_material(const R& params) noexcept {
    if (params.friction.static_ != automatic && params.friction.static_ < params.friction.dynamic) {
        constexpr std::uint32_t row = row_of<R>("friction.static");
        return {Verdict::Code::contradiction, row, params.friction.static_, 0};
    }
    return {};
}

/// Joins tables of rows.
template <std::size_t A, std::size_t B>
constexpr std::array<Field, A + B> join_rows(const std::array<Field, A>& a, const std::array<Field, B>& b) {
    std::array<Field, A + B> all{};
    for (std::size_t i = 0; i < A; ++i) all[i] = a[i];
    for (std::size_t i = 0; i < B; ++i) all[A + i] = b[i];
    return all;
}

}  // namespace knurl
