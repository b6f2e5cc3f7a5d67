#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <knurl/reps/contact_solver.hpp>

#include "plane_scan.hpp"

namespace knurl {
namespace {

using Eigen::Vector3d;
using Status = ContactSolution::Status;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double dependent = 1e-13;  // a normal this near to the span of the active ones lies in it

constexpr double blunt = 0.75;  // cosine squared: from here on (30 degrees) two normals need no care

// A violation that rounding alone explains, for a solution of this size. Past `patience` steps it grows
// fourfold each step: copies of a plane that differ in the last bit would take turns for ever.
constexpr std::uint32_t patience = 20;
double tolerance(double worst, const Vector3d& dx, std::uint32_t iterations) noexcept {
    const double exact = 16 * std::numeric_limits<double>::epsilon() * (worst + dx.lpNorm<1>());
    return iterations <= patience ? exact
                                  : exact * std::ldexp(1.0, 2 * static_cast<int>(iterations - patience));
}

Vector3d normal_of(const ContactPlanes& planes, std::uint32_t i) noexcept {
    return {planes.nx[i], planes.ny[i], planes.nz[i]};
}

bool holds(const ActiveSet& set, std::uint32_t i) noexcept {
    return (set.count > 0 && set.plane[0] == i) || (set.count > 1 && set.plane[1] == i) ||
           (set.count > 2 && set.plane[2] == i);
}

void drop(ContactSolution& at, std::uint32_t leaves) noexcept {
    for (std::uint32_t i = leaves; i < 2; ++i) {
        at.active.plane[i] = at.active.plane[i + 1];
        at.multiplier[i] = at.multiplier[i + 1];
    }
    --at.active.count;
}

// Two planes. With w = b -+ a instead of b every difference of nearly equal numbers is taken first, where it
// has no rounding: a corner of a hundredth of a degree keeps all its digits, whichever way it opens.
struct Pair {
    Vector3d m, am, wm;       // a x b, a x m, w x m
    double sign, mm, per_mm;  // of a.b; |m|^2 and its inverse

    Pair(const Vector3d& a, const Vector3d& b) noexcept {
        sign = a.dot(b) < 0 ? -1 : 1;
        const Vector3d w = b - sign * a;
        m = a.cross(w);
        mm = m.squaredNorm();
        per_mm = 1 / mm;
        am = a.cross(m);
        wm = w.cross(m);
    }
    // Coefficients of v in a and b, for v in their span (or its part there).
    double along_a(const Vector3d& v) const noexcept { return (sign * v.dot(am) + v.dot(wm)) * per_mm; }
    double along_b(const Vector3d& v) const noexcept { return -v.dot(am) * per_mm; }
    Vector3d meet(double sa, double sb) const noexcept {
        return ((sign * sa - sb) * per_mm) * am + (sa * per_mm) * wm;
    }
};

// x and the multipliers from the active planes alone, all touching: dx = sum u_i n_i with n_i . dx = s_i.
// Computed anew after each step, so that no rounding accumulates. False: the planes are dependent.
bool closed_form(const ContactPlanes& planes, double give, ContactSolution& at) noexcept {
    const ActiveSet& set = at.active;
    std::array<double, 3>& u = at.multiplier;
    Vector3d& dx = at.dx;
    const auto s = [&](std::uint32_t j) { return planes.s[set.plane[j]] - give; };
    const auto n = [&](std::uint32_t j) { return normal_of(planes, set.plane[j]); };
    if (set.count == 1) {
        u[0] = s(0);
        dx = u[0] * n(0);
        return true;
    }
    if (set.count == 2) {
        const Vector3d a = n(0), b = n(1);
        const double g = a.dot(b);
        if (g * g < blunt) {  // the short way
            const double per = 1 / (1 - g * g);
            u[0] = (s(0) - g * s(1)) * per;
            u[1] = (s(1) - g * s(0)) * per;
            dx = u[0] * a + u[1] * b;
            return true;
        }
        const Pair pair(a, b);
        if (!(pair.mm > dependent * dependent)) return false;
        dx = pair.meet(s(0), s(1));
        u[0] = pair.along_a(dx);
        u[1] = pair.along_b(dx);
        return true;
    }
    if (set.count == 3) {
        // The most nearly parallel two first; then along their line to the third.
        const double ab = std::abs(n(0).dot(n(1))), bc = std::abs(n(1).dot(n(2))),
                     ca = std::abs(n(2).dot(n(0)));
        const std::uint32_t third = ab >= bc && ab >= ca ? 2 : bc >= ca ? 0 : 1;
        const std::uint32_t i = third == 0 ? 1 : 0, j = third == 2 ? 1 : 2;
        const Pair pair(n(i), n(j));
        const Vector3d c = n(third);
        const double d = c.dot(pair.m);
        if (!(pair.mm > dependent * dependent) || !(d * d > dependent * dependent * pair.mm)) return false;
        dx = pair.meet(s(i), s(j));
        const double per_d = 1 / d;
        dx += ((s(third) - c.dot(dx)) * per_d) * pair.m;
        // Three nearly in one plane: what the first step's rounding left is amplified, so it is taken away.
        if (d * d < 1e-2 * pair.mm) dx += ((s(third) - c.dot(dx)) * per_d) * pair.m;
        u[third] = dx.dot(pair.m) * per_d;
        const Vector3d rest = dx - u[third] * c;
        u[i] = pair.along_a(rest);
        u[j] = pair.along_b(rest);
        return true;
    }
    dx.setZero();
    return true;
}

// n = sum r_i n_i + z, z orthogonal to all active normals.
void decompose(const ContactPlanes& planes, const ActiveSet& set, const Vector3d& n, std::array<double, 3>& r,
               Vector3d& z) noexcept {
    z = n;
    if (set.count == 0) return;
    const Vector3d a = normal_of(planes, set.plane[0]);
    if (set.count == 1) {
        const double sign = a.dot(n) < 0 ? -1 : 1;
        const Vector3d w = n - sign * a;  // as in Pair
        z = a.cross(w).cross(a);
        r[0] = sign + a.dot(w);
        return;
    }
    const Pair pair(a, normal_of(planes, set.plane[1]));
    Vector3d rest = n;
    if (set.count == 3) {
        const Vector3d c = normal_of(planes, set.plane[2]);
        r[2] = n.dot(pair.m) / c.dot(pair.m);
        rest -= r[2] * c;
        z.setZero();
    } else {
        z = (n.dot(pair.m) * pair.per_mm) * pair.m;
    }
    r[0] = pair.along_a(rest);
    r[1] = pair.along_b(rest);
}

// Takes plane q in, dropping those that it pushes away: at most four rounds, since each but the last drops
// one. False: infeasible, and `contradiction` says by how much.
bool take_in(const ContactPlanes& planes, std::uint32_t q, double give, ContactSolution& at) noexcept {
    const Vector3d n = normal_of(planes, q);
    const double s = planes.s[q] - give;
    double uq = 0;
    for (int round = 0; round < 4; ++round) {
        ActiveSet& set = at.active;
        std::array<double, 3> r{};
        Vector3d z;
        decompose(planes, set, n, r, z);
        double t1 = unbounded;
        std::uint32_t leaves = 0;
        for (std::uint32_t j = 0; j < set.count; ++j) {
            if (r[j] > 0 && at.multiplier[j] < t1 * r[j])
                t1 = std::max(0.0, at.multiplier[j]) / r[j], leaves = j;
        }
        const double zz = z.squaredNorm();
        const double t2 = zz > dependent * dependent ? (s - n.dot(at.dx)) / zz : unbounded;
        if (t1 == unbounded && t2 == unbounded) {
            // n = sum r_j n_j with all r_j <= 0: the planes face each other. The weights 1, -r_j sum the
            // normals to zero, so the same sum of offsets must not be positive: each must give way by its
            // weighted mean.
            double sum = planes.s[q], weight = 1;
            for (std::uint32_t j = 0; j < set.count; ++j)
                sum -= r[j] * planes.s[set.plane[j]], weight -= r[j];
            at.contradiction = sum / weight;
            return false;
        }
        const double t = std::min(t1, t2);
        if (t2 < unbounded) at.dx += t * z;
        for (std::uint32_t j = 0; j < set.count; ++j) at.multiplier[j] -= t * r[j];
        uq += t;
        if (t2 <= t1) {
            set.plane[set.count] = q;
            at.multiplier[set.count++] = uq;
            return true;
        }
        drop(at, leaves);
    }
    return true;  // not reached: with no plane left, z = n and the step is full
}

// The guessed planes, if they are the right ones: all push, and no other plane is violated.
bool guessed_right(const ContactPlanes& planes, double give, double size, ContactSolution& at) noexcept {
    const std::uint32_t count = at.active.count;
    if (count == 0 || count > 3) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (at.active.plane[i] >= planes.count) return false;
    }
    if (!closed_form(planes, give, at)) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!(at.multiplier[i] >= 0)) return false;
    }
    if (count >= planes.count) return true;
    const double left = worst_violation(planes, at.dx);
    return left - give <= tolerance(size, at.dx, 0) || holds(at.active, find_violation(planes, at.dx, left));
}

}  // namespace

void solve_contact(const ContactPlanes& planes, double worst, double give, ContactSolution& at) noexcept {
    at.status = Status::solved;
    at.iterations = 0;
    const double violation = worst - give;
    if (!(violation > 0)) {
        at.dx.setZero();
        at.active.count = 0;
        return;
    }
    const double size = std::max(worst, violation);
    if (guessed_right(planes, give, size, at)) return;

    at.dx.setZero();
    at.active.count = 0;
    double unshifted = worst;
    while (at.iterations < max_contact_iterations) {
        const std::uint32_t q = find_violation(planes, at.dx, unshifted);
        if (holds(at.active, q))
            break;  // the worst is an active plane's rounding: all others are nearer still
        ++at.iterations;
        if (!take_in(planes, q, give, at)) {
            at.status = Status::infeasible;
            break;
        }
        closed_form(planes, give, at);
        if (at.active.count == planes.count) break;
        unshifted = worst_violation(planes, at.dx);
        if (unshifted - give <= tolerance(size, at.dx, at.iterations)) break;
        if (at.iterations == max_contact_iterations) at.status = Status::unfinished;
    }
    for (std::uint32_t i = 0; i < at.active.count; ++i) at.multiplier[i] = std::max(0.0, at.multiplier[i]);
}

void solve_contact_relaxed(const ContactPlanes& planes, double worst, double& give,
                           ContactSolution& at) noexcept {
    solve_contact(planes, worst, give, at);
    if (at.status != Status::infeasible) return;
    // Newton's method on the largest contradiction: each certificate is a lower bound that the next solve
    // respects, and there are finitely many. Planes that touch exactly would fail the solver's tolerance: a
    // little more.
    double need = 0;
    for (std::uint32_t i = 0; i < max_contact_relaxations && at.status == Status::infeasible; ++i) {
        const double margin = 1e-11 + 1e-12 * std::abs(need);
        need = std::max(at.contradiction, need + (i == 0 ? 0 : margin));
        give = need + margin;
        solve_contact(planes, worst, give, at);
    }
}

}  // namespace knurl
