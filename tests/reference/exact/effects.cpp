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

Real faded(Real r, Real edge) {
    const Real u = std::min(std::max((r / edge - 0.8L) / 0.2L, Real(0)), Real(1));
    return 1 - u * u * (3 - 2 * u);
}

Twist taylor(const Taylor& t, const Tip& tip, const Device& device) {
    constexpr Real hand = 50;  // N/m
    Matrix j = t.jacobian;
    V turn;
    if (j.size == 6) {
        // q q0^-1 by the shorter way; both may have any length.
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
            j = clamped(j, -device.stiffness, hand);
        } else if (std::isfinite(device.torsion)) {
            const Real metres = std::sqrt(device.torsion / device.stiffness);  // a radian counts as so many
            const auto scale = [&](int row) { return row < 3 ? Real(1) : metres; };
            for (int r = 0; r < 6; ++r) {
                for (int c = 0; c < 6; ++c) j.at[r][c] /= scale(r) * scale(c);
            }
            j = clamped(j, -device.stiffness, hand);
            for (int r = 0; r < 6; ++r) {
                for (int c = 0; c < 6; ++c) j.at[r][c] *= scale(r) * scale(c);
            }
        } else {
            Matrix block;
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c) block.at[r][c] = j.at[r][c];
            }
            block = clamped(block, -device.stiffness, hand);
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c) j.at[r][c] = block.at[r][c];
            }
        }
    }
    V d = tip.position - t.origin;
    Real felt = 1;
    if (t.hold) {
        if (length(d) > t.radius) d = t.radius / length(d) * d;
        if (j.size == 6 && length(turn) > t.angle) turn = t.angle / length(turn) * turn;
    } else {
        felt = faded(length(d), t.radius);
        if (j.size == 6) felt *= faded(length(turn), t.angle);
    }
    const Real x[6] = {d.x, d.y, d.z, turn.x, turn.y, turn.z};
    Real out[6] = {t.force.x, t.force.y, t.force.z, t.torque.x, t.torque.y, t.torque.z};
    for (int r = 0; r < j.size; ++r) {
        for (int c = 0; c < j.size; ++c) out[r] += j.at[r][c] * x[c];
    }
    Twist twist{felt * V{out[0], out[1], out[2]}, {}};
    if (j.size == 6) twist.torque = felt * V{out[3], out[4], out[5]};
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
