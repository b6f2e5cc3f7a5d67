// Fields and effects against their formulas: taylor, taylor6, viscosity, gravity, constant force, magnet,
// constraint and vibration, with and without a device's limits.

#include <knurl/reps/constant_force.hpp>
#include <knurl/reps/constraint.hpp>
#include <knurl/reps/gravity.hpp>
#include <knurl/reps/magnet.hpp>
#include <knurl/reps/taylor.hpp>
#include <knurl/reps/taylor6.hpp>
#include <knurl/reps/vibration.hpp>
#include <knurl/reps/viscosity.hpp>

#include "exact/effects.hpp"
#include "judge.hpp"

using namespace judge;

namespace {

Limits any_device(Rng& rng) {
    Limits limits;
    if (rng.one_in(2)) limits.max_stiffness = rng.uniform(500, 3000);
    if (rng.one_in(3)) limits.max_torsion = rng.uniform(0.1, 5);
    if (rng.one_in(2)) limits.mass = rng.uniform(0.05, 0.3);
    if (rng.one_in(2)) limits.lag = rng.uniform(0, 2e-3);
    if (rng.one_in(4)) limits.period = rng.of(1e-4, 2.5e-4, 2e-3);
    if (rng.one_in(4)) limits.max_force = rng.scale(0.01, 10);
    if (rng.one_in(4)) limits.max_torque = rng.scale(1e-3, 1);
    return limits;
}

Probe any_hand(Rng& rng, const Vector& about, double size) {
    Probe hand = at(about + size * rng.direction(), rng.uniform(0, 1) * rng.direction());
    hand.orientation = rng.orientation();
    hand.angular_velocity = rng.uniform(0, 3) * rng.direction();
    return hand;
}

Vector any_origin(Rng& rng) {
    return rng.of(0, 0.1, 0.1, 10, 1e6) * rng.direction();
}

/// The wrench of one effect alone, settled.
template <class R>
Wrench felt(Case& c, const R& effect, const Probe& hand, const Limits& limits) {
    Scene scene({2, 1}, limits);
    c.require(bool(scene.add({0, 1}, effect)), "added");
    scene.settle();
    const double dt = any_step(c.rng);
    const Wrench got = scene.evaluate(hand, dt);
    c.require(finite(got), "finite");
    c.require(got.force.norm() <= limits.max_force * (1 + 1e-12), "at most the device's force");
    c.require(got.torque.norm() <= limits.max_torque * (1 + 1e-12), "at most the device's torque");
    return got;
}

exact::Matrix any_jacobian(Rng& rng, int size, double* out) {
    exact::Matrix m;
    m.size = size;
    const double scale = rng.scale(1, 3000);
    const bool symmetric = rng.one_in(2);
    for (int r = 0; r < size; ++r) {
        for (int col = 0; col < size; ++col) {
            double& at = out[r * size + col];
            at = symmetric && col < r ? out[col * size + r] : scale * rng.uniform(-1, 1);
            if (rng.one_in(5) && !symmetric) at = 0;
            m.at[r][col] = at;
        }
    }
    return m;
}

/// Takes the edge from the prepared field: how far the device lets the edge go is bounded in
/// tests/reps/taylor_edges.cpp, and only the formula with that edge is judged here.
template <class R>
void take_edge(const R& prepared, exact::Taylor& out) {
    out.core = prepared.core;
    out.force = real(prepared.force);
    Real square = 0;
    for (const double entry : prepared.jacobian.at) square += Real(entry) * entry;
    out.size = std::sqrt(square);
}

/// The scale of rounding of the energy's share and of its slope.
Real edge_scale(const exact::Taylor& t, Real size, Real reach) {
    const Real width = (1 - t.core) * t.radius;
    return size / width * reach * (1 + 6 * t.radius / width);
}

Real largest_of(const exact::Matrix& m) {
    Real most = 0;
    for (int r = 0; r < m.size; ++r) {
        Real sum = 0;
        for (int col = 0; col < m.size; ++col) sum += std::fabs(m.at[r][col]);
        most = std::max(most, sum);
    }
    return most;
}

}  // namespace

TEST(Fields, Taylor) {
    run("taylor", 40'000, [](Case& c) {
        Rng& rng = c.rng;
        const Limits limits = any_device(rng);
        knurl::Taylor t;
        const Vector origin = any_origin(rng);
        t.origin = knurl::to_plain(origin);
        t.force = knurl::to_plain(rng.scale(1e-3, 10) * rng.direction());
        t.radius = rng.one_in(4) ? rng.scale(1e-6, 10) : rng.scale(1e-4, 0.1);
        t.edge = rng.one_in(2) ? knurl::TaylorEdge::hold : knurl::TaylorEdge::fade;
        exact::Taylor want_of{.origin = real(t.origin),
                              .force = real(t.force),
                              .torque = {},
                              .orientation = {},
                              .jacobian = any_jacobian(rng, 3, t.jacobian.at),
                              .radius = t.radius,
                              .hold = t.edge == knurl::TaylorEdge::hold};
        take_edge(knurl::prepared(t, limits), want_of);
        const Probe hand = any_hand(rng, origin, rng.one_in(10) ? 0 : rng.uniform(0, 1.3) * t.radius);
        const exact::Twist want = exact::taylor(want_of, tip_of(hand), device_of(limits));
        const Real reach = std::max(exact::length(real(hand.position)), exact::length(real(t.origin)));
        const Real j = largest_of(want_of.jacobian) + 50, size = exact::length(real(t.force)) + j * t.radius;
        c.compare(felt(c, t, hand, limits).force, exact::capped(want.force, limits.max_force),
                  10 * size + j * reach + edge_scale(want_of, size, reach));
    });
}

TEST(Fields, Taylor6) {
    run("taylor6", 20'000, [](Case& c) {
        Rng& rng = c.rng;
        const Limits limits = any_device(rng);
        knurl::Taylor6 t;
        const Vector origin = any_origin(rng);
        t.origin = knurl::to_plain(origin);
        const Eigen::Quaterniond q = rng.orientation();
        const double length = rng.of(1, 1, 0.01, 100);
        t.orientation = {length * q.w(), length * q.x(), length * q.y(), length * q.z()};
        t.force = knurl::to_plain(rng.scale(1e-3, 10) * rng.direction());
        t.torque = knurl::to_plain(rng.scale(1e-3, 1) * rng.direction());
        t.radius = rng.scale(1e-4, 0.1);
        t.angle = rng.uniform(0.05, 1.5);
        t.edge = rng.one_in(2) ? knurl::TaylorEdge::hold : knurl::TaylorEdge::fade;
        exact::Taylor want_of{.origin = real(t.origin),
                              .force = real(t.force),
                              .torque = real(t.torque),
                              .orientation = real(t.orientation),
                              .jacobian = any_jacobian(rng, 6, t.jacobian.at),
                              .radius = t.radius,
                              .angle = t.angle,
                              .hold = t.edge == knurl::TaylorEdge::hold};
        const knurl::Taylor6 servo = knurl::prepared(t, limits);
        take_edge(servo, want_of);
        want_of.torque = real(servo.torque);
        Probe hand = any_hand(rng, origin, rng.uniform(0, 1.3) * t.radius);
        const double turn = rng.one_in(10) ? rng.scale(1e-12, 1e-3) : rng.uniform(0, 1.3) * t.angle;
        const Vector axis = rng.direction();
        const double s = std::sin(turn / 2);
        hand.orientation =
            Eigen::Quaterniond(std::cos(turn / 2), s * axis.x(), s * axis.y(), s * axis.z()) * q;
        if (rng.one_in(2)) hand.orientation.coeffs() *= -1;  // the same orientation
        const exact::Twist want = exact::taylor(want_of, tip_of(hand), device_of(limits));
        const Real reach = std::max(exact::length(real(hand.position)), exact::length(real(t.origin)));
        const Real j = largest_of(want_of.jacobian) + 50;
        const Real size =
            exact::length(real(t.force)) + exact::length(real(t.torque)) + j * (t.radius + t.angle);
        // Clamping converts J to units in which a radian is sqrt(torsion / stiffness) metres, and back.
        const Real metres = limits.max_torsion < 1e9 && limits.max_stiffness < 1e9
                                ? std::sqrt(Real(limits.max_torsion) / Real(limits.max_stiffness))
                                : 1;
        const Real ratio = std::max(metres * metres, 1 / (metres * metres));
        const Real narrow = (1 - want_of.core) * t.angle;
        const Real scale = (10 * size + j * reach + edge_scale(want_of, size, reach) +
                            10 * size / narrow / narrow + size * reach / narrow) *
                           ratio;
        const Wrench got = felt(c, t, hand, limits);
        c.compare(got.force, exact::capped(want.force, limits.max_force), scale);
        c.compare(got.torque, exact::capped(want.torque, limits.max_torque), scale);
    });
}

TEST(Fields, ViscosityGravityAndConstantForce) {
    run("viscosity", 30'000, [](Case& c) {
        Rng& rng = c.rng;
        const Limits limits = any_device(rng);
        const knurl::Viscosity v{.damping = rng.scale(1e-3, 100), .angular_damping = rng.scale(1e-4, 1)};
        const Probe hand = any_hand(rng, any_origin(rng), 0.1);
        const Wrench got = felt(c, v, hand, limits);
        const exact::Device device = device_of(limits);
        const Real b = std::min(Real(v.damping), device.damping()),
                   r = std::min(Real(v.angular_damping), device.angular_damping());
        c.compare(got.force, exact::capped(-b * real(hand.velocity), limits.max_force),
                  b * exact::length(real(hand.velocity)));
        c.compare(got.torque, exact::capped(-r * real(hand.angular_velocity), limits.max_torque),
                  r * exact::length(real(hand.angular_velocity)));
    });
    run("gravity, constant force", 30'000, [](Case& c) {
        Rng& rng = c.rng;
        const Limits limits = any_device(rng);
        const Probe hand = any_hand(rng, any_origin(rng), 0.1);
        const knurl::Gravity g{.acceleration = knurl::to_plain(rng.scale(0.1, 100) * rng.direction()),
                               .mass = rng.scale(1e-3, 1)};
        const exact::V weight = Real(g.mass) * real(g.acceleration);
        c.compare(felt(c, g, hand, limits).force, exact::capped(weight, limits.max_force),
                  exact::length(weight));
        const knurl::ConstantForce f{.force = knurl::to_plain(rng.scale(0.1, 100) * rng.direction()),
                                     .torque = knurl::to_plain(rng.scale(0.1, 100) * rng.direction())};
        const Wrench got = felt(c, f, hand, limits);
        c.compare(got.force, exact::capped(real(f.force), limits.max_force), exact::length(real(f.force)));
        c.compare(got.torque, exact::capped(real(f.torque), limits.max_torque),
                  exact::length(real(f.torque)));
    });
}

TEST(Fields, Magnet) {
    run("magnet", 60'000, [](Case& c) {
        Rng& rng = c.rng;
        const Limits limits = any_device(rng);
        const Vector position = any_origin(rng);
        knurl::Magnet m{.position = knurl::to_plain(position)};
        if (rng.one_in(2)) m.radius = rng.scale(1e-4, 0.1);
        m.stiffness = rng.scale(10, 3000);
        m.max_force = rng.scale(0.01, 10);
        m.max_distance = m.max_force / m.stiffness * rng.uniform(1.01, 5);
        if (rng.one_in(2)) m.damping = rng.scale(0.01, 20);
        double distance = m.radius + rng.uniform(-1, 1) * 1.2 * m.max_distance;
        if (rng.one_in(10)) distance = m.radius;
        if (rng.one_in(10)) distance = rng.one_in(2) ? 0 : rng.scale(1e-12, 1e-5);
        const Probe hand = any_hand(rng, position, distance);
        const exact::Magnet model{real(m.position), m.radius,       m.stiffness,
                                  m.max_force,      m.max_distance, m.damping};
        const exact::V want = exact::magnet(model, tip_of(hand), device_of(limits));
        const Real reach = std::max({exact::length(real(hand.position)), exact::length(real(m.position)),
                                     Real(m.radius), Real(m.max_distance)});
        const Real falls = m.max_force / (m.max_distance - Real(m.max_force) / m.stiffness);
        // Near a point, or the centre of a sphere, rounding turns the direction by rounding / distance. A
        // sphere's field is smoothed there.
        const Real q = exact::length(real(hand.position) - real(m.position));
        const Real e = m.radius > 0 ? std::min(Real(1e-3L), Real(m.radius) / 20) : 0;
        const Real steep = m.radius > 0 ? Real(m.max_force) / std::sqrt(q * q + e * e) : 0;
        const Real speed = exact::length(real(hand.velocity));
        c.compare(
            felt(c, m, hand, limits).force, exact::capped(want, limits.max_force),
            (m.stiffness + falls + steep) * reach + m.damping * speed * (1 + reach * falls / m.max_force));
    });
}

TEST(Fields, Constraint) {
    run("constraint", 60'000, [](Case& c) {
        Rng& rng = c.rng;
        const Limits limits = any_device(rng);
        const Vector origin = any_origin(rng);
        knurl::Constraint k{.origin = knurl::to_plain(origin),
                            .direction = knurl::to_plain(rng.scale(1e-3, 1e3) * rng.direction()),
                            .stiffness = rng.one_in(10) ? infinity : rng.scale(1, 5000)};
        if (rng.one_in(2)) k.damping = rng.scale(0.01, 50);
        const int shape = rng.between(0, 2);
        k.shape = static_cast<knurl::ConstraintShape>(shape);
        const Probe hand = any_hand(rng, origin, rng.one_in(10) ? 0 : rng.scale(1e-9, 1));
        const Real most = limits.max_stiffness;
        Real stiffness =
            std::isinf(k.stiffness) ? (std::isinf(limits.max_stiffness) ? 1000 : most) : Real(k.stiffness);
        stiffness = std::min(stiffness, most);
        const Real b = std::min(Real(k.damping), device_of(limits).damping());
        const exact::V want = exact::constraint(static_cast<exact::Held>(shape), real(k.origin),
                                                real(k.direction), stiffness, b, tip_of(hand));
        const Real reach = std::max(exact::length(real(hand.position)), exact::length(real(k.origin)));
        c.compare(felt(c, k, hand, limits).force, exact::capped(want, limits.max_force),
                  stiffness * reach + b * exact::length(real(hand.velocity)));
    });
}

TEST(Fields, VibrationSumsItsPhase) {
    run("vibration", 20'000, [](Case& c) {
        Rng& rng = c.rng;
        Limits limits;
        if (rng.one_in(2)) limits.period = rng.of(1e-4, 2.5e-4, 2e-3);
        knurl::Vibration v{.direction = knurl::to_plain(rng.scale(1e-3, 1e3) * rng.direction()),
                           .amplitude = rng.scale(0.01, 10),
                           .frequency = rng.scale(0.1, 1000)};
        Scene scene({2, 1}, limits);
        c.require(bool(scene.add({0, 1}, v)), "added");
        scene.settle();
        const exact::V u = exact::unit(real(v.direction));
        Real phase = 0, cycles = 0;
        for (int i = 0; i < 8; ++i) {
            if (rng.one_in(4)) {
                v.frequency = rng.scale(0.1, 1000);
                c.require(bool(scene.update({0, 1}, v)), "updated");
            }
            const double dt = any_step(rng);
            const Real f = std::min(Real(v.frequency), 1 / (4 * Real(limits.period)));
            phase += f * dt, cycles += f * dt;
            const Wrench got = scene.evaluate({}, dt);
            const Real a = v.amplitude;
            c.compare(got.force, a * std::sin(2 * exact::pi * (phase - std::floor(phase))) * u,
                      a * std::max(Real(1), cycles));
            c.require(got.force.norm() <= v.amplitude * (1 + 1e-12), "at most its amplitude");
        }
    });
}
