#pragma once
// Where the hand will be when an update is felt, and a plane that is right there. A pure function of its
// arguments and of a little memory, so that it is tested without a servo.
//
// An application at 20 Hz, answered 25 ms later, sends planes for where the hand was. Asking the model where
// the hand will be removes most of that error, but unchecked it does harm: a point predicted past the middle
// of a plate is nearer to its other face, and the hand is pushed out there. So the look-ahead is tried,
// checked against the model at the moment of landing, and halved until it is harmless:
//
//     v t*  = v (latency + interval/2), at most 20 mm          normal part: at most up to the surface
//     p_L   = p + v latency                                    where the hand is when the update lands
//     plane = model(p + v t*), accepted if                     height of p_L over the plane
//             h(p_L) >= min(d(p_L), 0) - min(0.5 mm, 1 N / k)  ... is no worse than under the model itself
//     else t* / 2, t* / 4, 0

#include <functional>

#include <knurl/reps/vec.hpp>

namespace knurl {

/// Where a model is nearest to a point, for `follow`.
struct SurfacePoint {
    Vec3 foot;    // m
    Vec3 normal;  // towards free space; of any length but 0
};
using SurfaceModel = std::function<SurfacePoint(const Vec3& near)>;

/// How late an application is.
struct Lateness {
    double latency = 0;   // s, from a report's read to the first force computed from it
    double interval = 0;  // s, between updates
};

/// What the next call has to know of the last one.
struct FollowMemory {
    SurfacePoint plane;  // sent last
    bool known = false;
};

struct Followed {
    SurfacePoint plane;     // to send; unit normal
    double look_ahead = 0;  // share of t* that was used: 1, 1/2, 1/4 or 0
    bool kept_side =
        false;  // the nearest face was not the one by which the hand came in: the last plane stays
    std::uint32_t asked = 0;  // calls of the model
};

inline constexpr double max_look_ahead = 0.020;  // m

/// Position of the hand t* from now, at most max_look_ahead away. Frame as given.
Vec3 look_ahead(const Vec3& position, const Vec3& velocity, const Lateness& lateness) noexcept;

/// The plane to send. `velocity` is slow (Report::slow_velocity); `stiffness` in N/m, that of the plane.
/// Throws knurl::Error if the model answers with something not finite, or a zero normal.
Followed follow_surface(const SurfaceModel& model, const Vec3& position, const Vec3& velocity,
                        const Lateness& lateness, double stiffness, FollowMemory& memory);

}  // namespace knurl
