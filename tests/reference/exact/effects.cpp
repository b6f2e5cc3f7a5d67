#include "effects.hpp"

namespace exact {

Real Device::damping() const {
    if (!known()) return INFINITY;
    return mass > 0 ? mass / (4 * (period + lag + 1 / (2 * pi * 100))) : 10;
}
Real Device::angular_damping() const {
    return known() && std::isfinite(torsion) ? damping() * torsion / stiffness : INFINITY;
}

Twist spring(const Spring& s, const Tip& tip, const Device& device) {
    const V arm = turned(tip.orientation, s.attach);
    const V d = s.anchor - tip.position - arm;
    const Real l = length(d);
    V force = s.stiffness * d;
    if (s.rest_length > 0) {
        const Real e = std::max(std::min(Real(1e-3L), s.rest_length / 20),
                                s.rest_length * s.stiffness / device.stiffness);
        force = s.stiffness * (1 - s.rest_length / std::sqrt(l * l + e * e)) * d;
    }
    if (l > 0) {
        const V u = unit(d);
        force += -std::min(s.damping, device.damping()) * dot(tip.velocity + cross(tip.turning, arm), u) * u;
    }
    return {force, cross(arm, force)};
}

Matrix clamped(const Matrix& m, Real low, Real high) {
    const int n = m.size;
    Real a[6][6], v[6][6];
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            a[i][j] = (m.at[i][j] + m.at[j][i]) / 2;
            v[i][j] = i == j;
        }
    }
    for (int sweep = 0; sweep < 30; ++sweep) {
        for (int p = 0; p < n; ++p) {
            for (int q = p + 1; q < n; ++q) {
                if (a[p][q] == 0) continue;
                const Real theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const Real t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const Real c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < n; ++k) {
                    const Real kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - s * kq, a[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < n; ++k) {
                    const Real pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - s * qk, a[q][k] = s * pk + c * qk;
                }
                for (int k = 0; k < n; ++k) {
                    const Real kp = v[k][p], kq = v[k][q];
                    v[k][p] = c * kp - s * kq, v[k][q] = s * kp + c * kq;
                }
            }
        }
    }
    Matrix out = m;
    for (int k = 0; k < n; ++k) {
        const Real excess = std::min(std::max(a[k][k], low), high) - a[k][k];
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) out.at[i][j] += excess * v[i][k] * v[j][k];
        }
    }
    return out;
}

Edge faded(Real r, Real core, Real edge) {
    const Real u = std::min(std::max((r / edge - core) / (1 - core), Real(0)), Real(1));
    return {1 - u * u * (3 - 2 * u), -6 * u * (1 - u) / ((1 - core) * edge)};
}
Edge held_square(Real r, Real edge) {
    if (r <= edge) return {r * r, 2 * r};
    return {2 * edge * r - edge * edge, 2 * edge};
}
Edge held_length(Real r, Real edge) {
    if (r <= edge) return {r, 1};
    return {2 * edge - edge * edge / r, edge / r * (edge / r)};
}

namespace {

V block(const Matrix& j, int row, int column, const V& x) {
    V out;
    Real* const at[] = {&out.x, &out.y, &out.z};
    for (int r = 0; r < 3; ++r) {
        // Only the symmetric part has a potential.
        const auto s = [&](int c) { return (j.at[row + r][column + c] + j.at[column + c][row + r]) / 2; };
        *at[r] = s(0) * x.x + s(1) * x.y + s(2) * x.z;
    }
    return out;
}

/// The gradient of f(u) h(r). f is homogeneous of that degree in d = r u, and has the gradient `slope` at u.
V gradient(const V& slope, int degree, const V& u, Real r, const Edge& h) {
    if (!(r > 0)) return degree == 1 ? h.slope * slope : V{};
    const Real along = dot(slope, u);
    return h.slope * along / degree * u + h.value / r * (slope - along * u);
}

}  // namespace

Twist taylor(const Taylor& t, const Tip& tip, const Device& device) {
    constexpr Real hand = 50;  // N/m
    const Real low = t.hold ? std::max(Real(0), device.stiffness - hand / 3) : device.stiffness;
    Matrix j = t.jacobian;
    V turn;
    if (j.size == 6) {
        // The shorter rotation q q0^-1; both quaternions may have any length.
        const Turn a = tip.orientation,
                   b{t.orientation.w, -t.orientation.x, -t.orientation.y, -t.orientation.z};
        const V av{a.x, a.y, a.z}, bv{b.x, b.y, b.z};
        Real w = a.w * b.w - dot(av, bv);
        V u = a.w * bv + b.w * av + cross(av, bv);
        if (w < 0) w = -w, u = -u;
        const Real s = length(u);
        if (s > 0) turn = 2 * std::atan2(s, w) / s * u;
    }
    if (device.known()) {
        if (j.size == 3) {
            j = clamped(j, -low, hand);
        } else if (std::isfinite(device.torsion)) {
            const Real metres = std::sqrt(device.torsion / device.stiffness);  // for one radian
            const auto scale = [&](int row) { return row < 3 ? Real(1) : metres; };
            for (int r = 0; r < 6; ++r) {
                for (int c = 0; c < 6; ++c) j.at[r][c] /= scale(r) * scale(c);
            }
            j = clamped(j, -low, hand);
            for (int r = 0; r < 6; ++r) {
                for (int c = 0; c < 6; ++c) j.at[r][c] *= scale(r) * scale(c);
            }
        } else {
            Matrix block;
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c) block.at[r][c] = j.at[r][c];
            }
            block = clamped(block, -low, hand);
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c) j.at[r][c] = block.at[r][c];
            }
        }
    }
    const int n = j.size;
    Real square = 0;
    for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) square += j.at[r][c] * j.at[r][c];
    }
    for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) j.at[r][c] *= square > 0 ? t.size / std::sqrt(square) : 1;
    }
    const V d = tip.position - t.origin;
    const Real far = length(d), turned = length(turn);
    const V u = far > 0 ? 1 / far * d : V{}, axis = turned > 0 ? 1 / turned * turn : V{};
    if (t.hold) {
        const Edge a = held_length(far, t.radius), b = held_length(turned, t.angle);
        const Real rim = std::min(far, t.radius), most = std::min(turned, t.angle);
        Twist twist{t.force + gradient(block(j, 0, 0, u), 2, u, far, held_square(far, t.radius)), t.torque};
        if (n == 6) {
            twist.force += gradient(block(j, 0, 3, b.value * axis), 1, u, far, a);
            twist.torque += gradient(block(j, 3, 3, axis), 2, axis, turned, held_square(turned, t.angle)) +
                            gradient(block(j, 3, 0, a.value * u), 1, axis, turned, b);
        }
        const Real x[6] = {rim * u.x, rim * u.y, rim * u.z, most * axis.x, most * axis.y, most * axis.z};
        Real curl[6] = {};
        for (int r = 0; r < n; ++r) {
            for (int c = 0; c < n; ++c) curl[r] += (j.at[r][c] - j.at[c][r]) / 2 * x[c];
        }
        return {twist.force + V{curl[0], curl[1], curl[2]}, twist.torque + V{curl[3], curl[4], curl[5]}};
    }
    const Edge place = faded(far, t.core, t.radius);
    const Edge turning = n == 6 ? faded(turned, t.core, t.angle) : Edge{1, 0};
    const Real x[6] = {d.x, d.y, d.z, turn.x, turn.y, turn.z};
    const Real f[6] = {t.force.x, t.force.y, t.force.z, t.torque.x, t.torque.y, t.torque.z};
    Real out[6], work = 0;
    const Real middle = (1 + t.core) / 2;
    for (int r = 0; r < n; ++r) {
        out[r] = f[r];
        for (int c = 0; c < n; ++c) out[r] += j.at[r][c] * x[c];
        const Real reach = middle * (r < 3 ? t.radius : t.angle);
        work += (f[r] + out[r]) / 2 * x[r] - reach * reach * j.at[r][r] / 6;
    }
    const Real share = place.value * turning.value;
    Twist twist{share * V{out[0], out[1], out[2]} + place.slope * turning.value * work * u, {}};
    if (n == 6) twist.torque = share * V{out[3], out[4], out[5]} + place.value * turning.slope * work * axis;
    return twist;
}

V magnet(const Magnet& m, const Tip& tip, const Device& device) {
    Real peak = m.max_force;
    const Real k = std::min(m.stiffness, device.stiffness);
    if (device.known()) {
        peak = std::min(peak, m.max_distance * k * device.stiffness / (k + device.stiffness));
    }
    if (!(k > 0)) return {};
    const Real turns = peak / k;  // m, where the pull is strongest
    const auto pull = [&](Real x) {
        if (x <= turns) return k * x;
        return x < m.max_distance ? peak * (m.max_distance - x) / (m.max_distance - turns) : 0;
    };
    const V q = tip.position - m.position;
    const Real r = length(q), x = std::fabs(r - m.radius);
    const Real e =
        m.radius > 0 ? std::max(std::min(Real(1e-3L), m.radius / 20), pull(m.radius) / device.stiffness) : 0;
    const Real root = std::sqrt(r * r + e * e);
    V force;
    if (root > 0) force = (r > m.radius ? -1 : 1) * pull(x) / root * q;
    const Real near =
        x <= turns ? 1 : (x < m.max_distance ? (m.max_distance - x) / (m.max_distance - turns) : 0);
    return force - near * std::min(m.damping, device.damping()) * tip.velocity;
}

V constraint(Held shape, const V& origin, const V& direction, Real stiffness, Real damping, const Tip& tip) {
    const V u = unit(direction);
    const auto held = [&](const V& a) {
        if (shape == Held::point) return a;
        const V along = dot(a, u) * u;
        return shape == Held::line ? a - along : along;
    };
    return -stiffness * held(tip.position - origin) - damping * held(tip.velocity);
}

}  // namespace exact
