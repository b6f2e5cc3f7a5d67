#pragma once

/// @file
/// Where the hand will be when an update takes effect, and a plane or a rimmed cap that is right there. A
/// pure function of its arguments and of a little memory, so that it is tested without a servo.
///
/// An application at 20 Hz, answered 25 ms later, sends planes for where the hand was. Asking the model where
/// the hand will be removes most of that error, but unchecked it does harm: a point predicted past the middle
/// of a plate is nearer to its other face, and the hand is pushed out there. So the look-ahead is tried,
/// checked against the model at the moment of landing, and halved until it is harmless:
///
///     v t*  = v (latency + interval/2), at most 20 mm          normal part: at most up to the surface
///     p_L   = p + v latency                                    where the hand is when the update lands
///     face  = model(p + v t*), accepted if                     height of p_L over that plane or cap
///             h(p_L) >= min(d(p_L), 0) - min(0.5 mm, 1 N / k)  ... is no worse than under the model itself
///     else t* / 2, t* / 4, 0
///
/// A plane acts all along a way, from its landing until the next one has faded in: interval + fade, about p +
/// v t*. Where one plane is sent (no corner) it is the one nearest to the surface along that way, in the mean
/// square: the tangent plane in its middle, moved by (first + last) / 6 and tilted by 3/5 (last - first) /
/// length, of the heights of the surface over it at the way's two ends, if it passes the same check.
///
/// A hand that turns round is not where its velocity says. How far the past updates' velocities did explain
/// where it went is measured, and the look-ahead shortened by it (trust): 1 on a stroke, about 0.8 for 50 ms
/// of a 3 Hz reversal.
///
/// All these lengths and forces are the hand's, in a world of any size (Follower::metre).

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include <knurl/reps/cap.hpp>
#include <knurl/reps/plane.hpp>

namespace knurl {

/// Where a model is nearest to a point, for `follow`. A model that knows how its surface curves there says
/// so: a followed Cap curves likewise, and for a plane, too, it tells whether the updates come often enough.
struct SurfacePoint {
    /// Nearest point of the surface (m).
    Vec3 foot;
    /// Normal there, towards free space; of any length but 0.
    Vec3 normal;
    /// Curvature along `axis` (1/m). Positive: hollow, the surface curves towards free space.
    double curvature = 0;
    /// Curvature across `axis` (1/m).
    double curvature2 = 0;
    /// Tangent direction of `curvature`; 0 0 0: that curvature in every direction.
    Vec3 axis = {};
};
/// A model: the nearest point of its surface to a place (m).
using SurfaceModel = std::function<SurfacePoint(const Vec3& near)>;

/// Gives a model curvatures that it does not know, from how its normals turn: each call evaluates the model
/// three times, `step` (m) apart. For smooth surfaces: where the normal turns by more than 0.3 rad within a
/// step that is an edge, and no curvature. The step is in metres of the model: in a world of another size
/// than the device, `1e-3 * hand.limits().metre` is a millimetre of the hand.
SurfaceModel curved(SurfaceModel model, double step = 1e-3);

/// How late an application is.
struct Lateness {
    /// Time from the read of a report to the first force computed from it (s).
    double latency = 0;
    /// Time between updates (s).
    double interval = 0;
};

/// How far velocity tells where this hand goes: the factor a that minimises |p(t + h) - p(t) - a h v(t)|^2
/// over the past, weighted by 0.8 per update, for the horizon h nearest to the one asked for.
class Trust {
  public:
    /// Takes in the hand at `time` (s, of any epoch): position (m), velocity (m/s), and the horizon (s) for
    /// which factor() will be wanted.
    void observe(double time, const Vec3& position, const Vec3& velocity, double horizon) noexcept;
    /// The factor a, 0 to 1; 1 without evidence.
    double factor() const noexcept;

  private:
    struct Sample {
        double time = 0;
        Vec3 position, velocity;
    };
    std::array<Sample, 8> samples_{};
    std::uint64_t count_ = 0;
    double explained_ = 0, expected_ = 0;  // m^2
};

/// Faces that one follower sends at once.
inline constexpr std::uint32_t max_faces = 3;

/// The planes or caps that a follower sends.
struct Faces {
    /// The faces, with unit normals; the first `count` are in use.
    std::array<SurfacePoint, max_faces> face{};
    /// How many there are, 0 to max_faces.
    std::uint32_t count = 0;
    /// Those that are in use.
    std::span<const SurfacePoint> all() const& { return {face.data(), count}; }
    /// Not of a temporary, which would be gone before the loop over it.
    std::span<const SurfacePoint> all() && = delete;
};

/// What follow_surface remembers between calls.
struct FollowMemory {
    /// The faces sent last; none: never.
    Faces sent;
    /// How far velocity tells where this hand goes.
    Trust trust;
};

/// The hand as a report has it.
struct HandNow {
    /// When it was read (s), of any epoch.
    double time = 0;
    /// Position (m).
    Vec3 position{};
    /// Slow velocity (m/s): Report::slow_velocity.
    Vec3 velocity{};
};

/// The representation that follows the surface.
struct Follower {
    /// Stiffness as applied (N/m).
    double stiffness = 0;
    /// Rim of a cap (1), Cap::rim; 0: a plane.
    double rim = 0;
    /// Metres of the world that one metre of the device is (Limits::metre): the lengths and forces of the
    /// check mean the hand, in a world of any size.
    double metre = 1;
    /// Newtons of the world that one newton of the device is (Limits::newton).
    double newton = 1;
};

/// What follow_surface found.
struct Followed {
    /// The planes or caps to send.
    Faces faces;
    /// Share of t* that passed the check: 1, 1/2, 1/4 or 0.
    double look_ahead = 0;
    /// Factor by which t* was shortened before.
    double trust = 1;
    /// The nearest face was not the one by which the hand came in: the last face stays.
    bool kept_side = false;
    /// |v| interval > R/2: between two updates the hand passes more of the surface than a plane or cap can
    /// follow. R is from the model's curvatures, or from how its normal turns.
    bool undersampled = false;
    /// Evaluations of the model.
    std::uint32_t asked = 0;
};

/// Largest distance of the look-ahead, at the hand (m).
inline constexpr double max_look_ahead = 0.020;

/// Position of the hand t* from now, at most max_look_ahead away. Frame as given; a metre of the device is
/// `metre` in it.
Vec3 look_ahead(const Vec3& position, const Vec3& velocity, const Lateness& lateness,
                double metre = 1) noexcept;

/// The plane or cap to send. Throws knurl::Error if the model answers with something not finite, a zero
/// normal, or two curvatures without the direction of the first.
Followed follow_surface(const SurfaceModel& model, const HandNow& hand, const Lateness& lateness,
                        const Follower& follower, FollowMemory& memory);

/// Puts a plane there; its other parameters stay.
void place(Plane& plane, const SurfacePoint& face) noexcept;
/// Puts a cap there; its other parameters stay.
void place(Cap& cap, const SurfacePoint& face) noexcept;

}  // namespace knurl
