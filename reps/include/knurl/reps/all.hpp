#pragma once

/// @file
/// The one list of representations. A new one is a header of its own and its name here: the scene, the wire
/// format, TOML scenes and the conformance tests take it from this list.

#include <knurl/reps/box.hpp>
#include <knurl/reps/cap.hpp>
#include <knurl/reps/capsule.hpp>
#include <knurl/reps/constant_force.hpp>
#include <knurl/reps/constraint.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/gravity.hpp>
#include <knurl/reps/half_plane.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/reps/magnet.hpp>
#include <knurl/reps/plane.hpp>
#include <knurl/reps/polygon.hpp>
#include <knurl/reps/shape.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/spring.hpp>
#include <knurl/reps/taylor.hpp>
#include <knurl/reps/taylor6.hpp>
#include <knurl/reps/torus.hpp>
#include <knurl/reps/vibration.hpp>
#include <knurl/reps/viscosity.hpp>

namespace knurl {

/// A list of types.
template <class... R>
struct TypeList {
    /// How many types there are.
    static constexpr std::size_t size = sizeof...(R);
};

#ifdef KNURL_REPRESENTATIONS  // a build with fewer kinds: tests count its instructions
/// A build with fewer kinds: tests count its instructions.
using Representations = TypeList<KNURL_REPRESENTATIONS>;
#else
/// All representations; the position of one is its Kind.
using Representations =
    TypeList<Plane, Spring, ConstantForce, Cap, Polygon, HalfPlane, Box, Sphere, Capsule, Cylinder, Torus,
             Taylor, Taylor6, Viscosity, Gravity, Magnet, Constraint, Vibration, Shape>;
#endif

namespace detail {
template <class R, class... All>
constexpr Kind index_in(TypeList<All...>) {
    Kind index = 0, found = sizeof...(All);
    ((std::is_same_v<R, All> ? void(found = index) : void(), ++index), ...);
    return found;
}
}  // namespace detail

/// The kind of R: its position in the list.
template <class R>
inline constexpr Kind kind_of = detail::index_in<R>(Representations{});

/// R is in the list.
template <class R>
concept Listed = kind_of<R> < Representations::size;

}  // namespace knurl
