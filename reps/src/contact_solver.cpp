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

// A violation that rounding alone explains, for a solution of this size. Past `patience` steps it grows
// fourfold each step: copies of a plane that differ in the last bit would take turns for ever.
constexpr std::uint32_t patience = 20;
double tolerance(double worst, const Vector3d& dx, std::uint32_t iterations) noexcept {
    const double exact = 16 * std::numeric_limits<double>::epsilon() * (worst + dx.lpNorm<1>());
    return iterations <= patience ? exact
                                  : exact * std::ldexp(1.0, 2 * static_cast<int>(iterations - patience));
}

struct Active {
    Vector3d n[3] = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
    double s[3] = {};
    double u[3] = {};
    std::uint32_t plane[3] = {};
    std::uint32_t count = 0;

    void put(const ContactPlanes& planes, std::uint32_t i, double give) noexcept {
        n[count] = {planes.nx[i], planes.ny[i], planes.nz[i]};
        s[count] = planes.s[i] - give;
        u[count] = 0;
        plane[count++] = i;
    }
    void drop(std::uint32_t at) noexcept {
        for (std::uint32_t i = at; i < 2; ++i) {
            n[i] = n[i + 1], s[i] = s[i + 1], u[i] = u[i + 1], plane[i] = plane[i + 1];
        }
        --count;
    }
    bool holds(std::uint32_t i) const noexcept {
        for (std::uint32_t j = 0; j < count; ++j) {
            if (plane[j] == i) return true;
        }
        return false;
    }
};

// x and the multipliers from the active planes alone, all touching: dx = sum u_i n_i with n_i . dx = s_i.
// Computed anew after each step, so that no rounding accumulates. False: the planes are dependent.
bool closed_form(Active& a, const double (&s)[3], Vector3d& dx, double (&u)[3]) noexcept {
    if (a.count == 1) {
        u[0] = s[0];
        dx = s[0] * a.n[0];
        return true;
    }
    const Vector3d m = a.n[0].cross(a.n[1]);
    if (a.count == 2) {
        const double mm = m.squaredNorm();
        if (!(mm > dependent * dependent)) return false;
        const double g = a.n[0].dot(a.n[1]);
        u[0] = (s[0] - g * s[1]) / mm;
        u[1] = (s[1] - g * s[0]) / mm;
        dx = (s[0] * a.n[1].cross(m) + s[1] * m.cross(a.n[0])) / mm;
        return true;
    }
    const Vector3d bc = a.n[1].cross(a.n[2]), ca = a.n[2].cross(a.n[0]);
    const double d = m.dot(a.n[2]);
    if (!(std::abs(d) > dependent * dependent)) return false;
    dx = (s[0] * bc + s[1] * ca + s[2] * m) / d;
    u[0] = dx.dot(bc) / d;
    u[1] = dx.dot(ca) / d;
    u[2] = dx.dot(m) / d;
    return true;
}

bool polish(Active& a, Vector3d& dx) noexcept {
    if (a.count == 0) {
        dx.setZero();
        return true;
    }
    if (!closed_form(a, a.s, dx, a.u)) return false;
    if (a.count >
        1) {  // one step of refinement: corners of a hundredth of a degree lose four digits without it
        double rest[3] = {}, more[3] = {};
        for (std::uint32_t i = 0; i < a.count; ++i) rest[i] = a.s[i] - a.n[i].dot(dx);
        Vector3d step;
        closed_form(a, rest, step, more);
        dx += step;
        for (std::uint32_t i = 0; i < a.count; ++i) a.u[i] += more[i];
    }
    return true;
}

// n = sum r_i n_i + z, z orthogonal to all active normals.
void decompose(const Active& a, const Vector3d& n, double (&r)[3], Vector3d& z) noexcept {
    if (a.count == 0) {
        z = n;
    } else if (a.count == 1) {
        r[0] = a.n[0].dot(n);
        z = n - r[0] * a.n[0];
        const double again = a.n[0].dot(z);
        r[0] += again;
        z -= again * a.n[0];
    } else {
        const Vector3d m = a.n[0].cross(a.n[1]);
        if (a.count == 2) {
            const double mm = m.squaredNorm();
            r[0] = n.dot(a.n[1].cross(m)) / mm;
            r[1] = n.dot(m.cross(a.n[0])) / mm;
            z = (n.dot(m) / mm) * m;
        } else {
            const double d = m.dot(a.n[2]);
            r[0] = n.dot(a.n[1].cross(a.n[2])) / d;
            r[1] = n.dot(a.n[2].cross(a.n[0])) / d;
            r[2] = n.dot(m) / d;
            z.setZero();
        }
    }
}

void write(ContactSolution& out, const Active& a, const Vector3d& dx) noexcept {
    out.dx = dx;
    out.active.count = a.count;
    for (std::uint32_t i = 0; i < a.count; ++i) {
        out.active.plane[i] = a.plane[i];
        out.multiplier[i] = a.u[i] > 0 ? a.u[i] : 0;
    }
}

// Takes plane q in, dropping those that it pushes away: at most four rounds, since each but the last drops
// one. False: infeasible, and `contradiction` says by how much.
bool take_in(Active& a, const ContactPlanes& planes, std::uint32_t q, double give, Vector3d& dx,
             double& contradiction) noexcept {
    const Vector3d n{planes.nx[q], planes.ny[q], planes.nz[q]};
    const double s = planes.s[q] - give;
    double uq = 0;
    for (int round = 0; round < 4; ++round) {
        double r[3] = {};
        Vector3d z;
        decompose(a, n, r, z);
        double t1 = unbounded;
        std::uint32_t leaves = 0;
        for (std::uint32_t j = 0; j < a.count; ++j) {
            if (r[j] > 0 && a.u[j] < t1 * r[j]) t1 = a.u[j] / r[j], leaves = j;
        }
        const double zz = z.squaredNorm();
        const double t2 = zz > dependent * dependent ? (s - n.dot(dx)) / zz : unbounded;
        if (t1 == unbounded && t2 == unbounded) {
            // n = sum r_j n_j with all r_j <= 0: the planes face each other. The weights 1, -r_j sum the
            // normals to zero, so the same sum of offsets must not be positive: each must give way by its
            // weighted mean.
            double sum = planes.s[q], weight = 1;
            for (std::uint32_t j = 0; j < a.count; ++j) sum -= r[j] * (a.s[j] + give), weight -= r[j];
            contradiction = sum / weight;
            return false;
        }
        const double t = std::min(t1, t2);
        if (t2 < unbounded) dx += t * z;
        for (std::uint32_t j = 0; j < a.count; ++j) a.u[j] -= t * r[j];
        uq += t;
        if (t2 <= t1) {
            a.put(planes, q, give);
            a.u[a.count - 1] = uq;
            return true;
        }
        a.drop(leaves);
    }
    return true;  // not reached: with no plane left, z = n and the step is full
}

}  // namespace

ContactSolution solve_contact(const ContactPlanes& planes, double worst, double give,
                              const ActiveSet& warm) noexcept {
    ContactSolution out;
    double violation = worst - give;
    if (!(violation > 0)) return out;
    const double size = std::max(worst, violation);

    if (warm.count > 0) {
        Active a;
        bool right = warm.count <= 3;
        for (std::uint32_t i = 0; right && i < warm.count; ++i) right = warm.plane[i] < planes.count;
        for (std::uint32_t i = 0; right && i < warm.count; ++i) a.put(planes, warm.plane[i], give);
        Vector3d dx;
        right = right && polish(a, dx);
        for (std::uint32_t i = 0; right && i < a.count; ++i) right = a.u[i] >= 0;
        if (right && a.count < planes.count) {
            const double left = worst_violation(planes, dx) - give;
            right = left <= tolerance(size, dx, 0) || a.holds(find_violation(planes, dx, left + give));
        }
        if (right) {
            write(out, a, dx);
            return out;
        }
    }

    Active a;
    Vector3d dx = Vector3d::Zero();
    double unshifted = worst;
    for (out.iterations = 1; out.iterations <= max_contact_iterations; ++out.iterations) {
        const std::uint32_t q = find_violation(planes, dx, unshifted);
        if (a.holds(q)) break;  // the worst is an active plane's rounding: all others are nearer still
        if (!take_in(a, planes, q, give, dx, out.contradiction)) {
            out.status = Status::infeasible;
            break;
        }
        polish(a, dx);
        unshifted = worst_violation(planes, dx);
        if (unshifted - give <= tolerance(size, dx, out.iterations)) break;
    }
    if (out.iterations > max_contact_iterations) out.status = Status::unfinished;
    write(out, a, dx);
    return out;
}

ContactSolution solve_contact_relaxed(const ContactPlanes& planes, double worst, double& give,
                                      const ActiveSet& warm) noexcept {
    ContactSolution out = solve_contact(planes, worst, give, warm);
    if (out.status != Status::infeasible) return out;
    // Newton's method on the largest contradiction: each certificate is a lower bound that the next solve
    // respects, and there are finitely many. Planes that touch exactly would fail the solver's tolerance: a
    // little more.
    double need = 0;
    for (std::uint32_t i = 0; i < max_contact_relaxations && out.status == Status::infeasible; ++i) {
        const double margin = 1e-11 + 1e-12 * std::abs(need);
        need = std::max(out.contradiction, need + (i == 0 ? 0 : margin));
        give = need + margin;
        out = solve_contact(planes, worst, give, warm);
    }
    return out;
}

}  // namespace knurl
