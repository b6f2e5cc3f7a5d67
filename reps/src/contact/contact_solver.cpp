#include <algorithm>
#include <cmath>
#include <limits>

#include <knurl/reps/contact_solver.hpp>

#include "contact/contact_corner.hpp"
#include "contact/plane_scan.hpp"

namespace knurl {
namespace {

using Status = ContactSolution::Status;
using namespace corner;

constexpr double unbounded = std::numeric_limits<double>::infinity();

// A violation that rounding alone explains, for a solution of this size. After `patience` steps it grows
// fourfold in each step: else copies of a plane that differ in the last bit would take turns for ever.
constexpr std::uint32_t patience = 20;
double tolerance(double worst, const Vec3& dx, std::uint32_t iterations) noexcept {
    const double exact = 16 * std::numeric_limits<double>::epsilon() *
                         (worst + (std::abs(dx.x) + std::abs(dx.y) + std::abs(dx.z)));
    return iterations <= patience ? exact
                                  : exact * std::ldexp(1.0, 2 * static_cast<int>(iterations - patience));
}

// The same for a blunt corner, relative to the worst violation at the probe: at most 5e-14 of it is left
// over.
constexpr double blunt_tolerance = 1e-13;

bool holds(const ActiveSet& set, std::uint32_t i) noexcept {
    return (set.count > 0 && set.plane[0] == i) || (set.count > 1 && set.plane[1] == i) ||
           (set.count > 2 && set.plane[2] == i);
}

[[gnu::always_inline]] inline Meeting meet(const ContactPlanes& planes, double give,
                                           const ActiveSet& set) noexcept {
    if (set.count == 1) return meet_blunt<1>(planes, give, set);
    const Meeting met = set.count == 2 ? meet_blunt<2>(planes, give, set) : meet_blunt<3>(planes, give, set);
    return met.exists ? met : meet_sharp(planes, give, set);
}

// n = sum r_i n_i + z, z orthogonal to all active normals.
[[gnu::always_inline]] inline void decompose(const ContactPlanes& planes, const ActiveSet& set, const Vec3& n,
                                             std::array<double, 3>& r, Vec3& z) noexcept {
    z = n;
    if (set.count == 0) return;
    const Vec3 a = normal_of(planes, set.plane[0]);
    if (set.count == 1) {
        const double sign = dot(a, n) < 0 ? -1 : 1;
        const Vec3 w = n - sign * a;  // as in Pair
        z = cross(cross(a, w), a);
        r[0] = sign + dot(a, w);
        return;
    }
    const Pair pair(a, normal_of(planes, set.plane[1]));
    Vec3 rest = n;
    if (set.count == 3) {
        const Vec3 c = normal_of(planes, set.plane[2]);
        r[2] = dot(n, pair.m) / dot(c, pair.m);
        rest = rest - r[2] * c;
        z = {};
    } else {
        z = (dot(n, pair.m) * pair.per_mm) * pair.m;
    }
    r[0] = pair.along_a(rest);
    r[1] = pair.along_b(rest);
}

void drop(ContactSolution& at, std::uint32_t leaves) noexcept {
    for (std::uint32_t i = leaves; i < 2; ++i) {
        at.active.plane[i] = at.active.plane[i + 1];
        at.multiplier[i] = at.multiplier[i + 1];
    }
    --at.active.count;
}

[[gnu::always_inline]] inline void take(const Meeting& met, Vec3& dx, ContactSolution& at) noexcept {
    dx = {met.x, met.y, met.z};
    at.multiplier[0] = met.u0;
    at.multiplier[1] = met.u1;
    at.multiplier[2] = met.u2;
}

// Takes in plane q and drops the planes that it pushes away. Takes at most four rounds, since each but the
// last drops one. False: infeasible, and `contradiction` says by how much.
bool take_in(const ContactPlanes& planes, std::uint32_t q, double give, Vec3& dx,
             ContactSolution& at) noexcept {
    const Vec3 n = normal_of(planes, q);
    const double s = planes.s[q] - give;
    double uq = 0;
    for (int round = 0; round < 4; ++round) {
        ActiveSet& set = at.active;
        std::array<double, 3> r{};
        Vec3 z;
        decompose(planes, set, n, r, z);
        double t1 = unbounded;
        std::uint32_t leaves = 0;
        for (std::uint32_t j = 0; j < set.count; ++j) {
            if (r[j] > 0 && at.multiplier[j] < t1 * r[j])
                t1 = std::max(0.0, at.multiplier[j]) / r[j], leaves = j;
        }
        const double zz = dot(z, z);
        const double t2 = zz > dependent * dependent ? (s - dot(n, dx)) / zz : unbounded;
        if (t1 == unbounded && t2 == unbounded) {
            // n = sum r_j n_j with all r_j <= 0: the planes face each other. The weights 1, -r_j sum the
            // normals to zero, so the same sum of the offsets must not be positive. Each plane must give way
            // by the weighted mean.
            double sum = planes.s[q], weight = 1;
            for (std::uint32_t j = 0; j < set.count; ++j)
                sum -= r[j] * planes.s[set.plane[j]], weight -= r[j];
            at.contradiction = sum / weight;
            return false;
        }
        const double t = std::min(t1, t2);
        if (t2 < unbounded) dx = dx + t * z;
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

bool is_possible(const ActiveSet& guess, std::uint32_t planes) noexcept {
    return guess.count - 1 < 3 && guess.plane[0] < planes && (guess.count < 2 || guess.plane[1] < planes) &&
           (guess.count < 3 || guess.plane[2] < planes);
}

[[gnu::always_inline]] inline bool all_push(const Meeting& met) noexcept {
    return met.exists && met.u0 >= 0 && met.u1 >= 0 && met.u2 >= 0;
}

// Takes in the worst violated plane until no plane is violated. Starts from the optimum of the guessed planes
// if they all push (it is the optimum of all planes if no other is violated), else from the probe.
[[gnu::noinline]] void search(const ContactPlanes& planes, double worst, double give,
                              ContactSolution& at) noexcept {
    at.status = Status::solved;
    at.iterations = 0;
    const double size = std::max(worst, worst - give);
    double unshifted = worst;  // the worst violation at dx, of the planes as they are
    Vec3 dx;
    if (!is_possible(at.active, planes.count)) at.active.count = 0;
    for (bool guessed = at.active.count > 0;; guessed = false) {
        if (at.active.count > 0) {
            const Meeting met = meet(planes, give, at.active);
            if (guessed && !all_push(met)) {
                at.active.count = 0;
                continue;
            }
            if (met.exists) take(met, dx, at);
            if (at.active.count == planes.count) break;
            unshifted = worst_violation(planes, {dx.x, dx.y, dx.z});
            if (unshifted - give <= tolerance(size, dx, at.iterations)) break;
        }
        const std::uint32_t q = find_violation(planes, {dx.x, dx.y, dx.z}, unshifted);
        if (holds(at.active, q))
            break;  // the worst plane is active, so its violation is rounding; all others are less violated
        if (at.iterations == max_contact_iterations) {
            at.status = Status::unfinished;
            break;
        }
        ++at.iterations;
        if (!take_in(planes, q, give, dx, at)) {
            at.status = Status::infeasible;
            break;
        }
    }
    at.dx = {dx.x, dx.y, dx.z};
    for (std::uint32_t i = 0; i < at.active.count; ++i) at.multiplier[i] = std::max(0.0, at.multiplier[i]);
}

// Do the guessed planes hold x, and does x violate no plane?
[[gnu::always_inline]] inline bool accepted(const ContactPlanes& planes, const Meeting& met, double limit,
                                            ContactSolution& at) noexcept {
    if (!all_push(met)) return false;
    at.status = Status::solved;
    at.iterations = 0;
    at.dx = {met.x, met.y, met.z};
    at.multiplier = {met.u0, met.u1, met.u2};
    if (at.active.count == planes.count) return true;
    const PlaneArrays shifted{planes.nx, planes.ny, planes.nz, planes.s};
    if (planes.count >= scan::many)
        return scan::none_of_many_above(shifted, planes.count, met.x, met.y, met.z, limit);
    return scan::none_above(shifted, planes.count, met.x, met.y, met.z, limit);
}

[[gnu::noinline]] bool held_sharply(const ContactPlanes& planes, double worst, double give,
                                    ContactSolution& at) noexcept {
    const Meeting met = meet_sharp(planes, give, at.active);
    return accepted(planes, met, give + tolerance(std::max(worst, worst - give), {met.x, met.y, met.z}, 0),
                    at);
}

// Nearly every cycle of a servo ends here: the planes that held x in the last cycle still hold it and form a
// blunt corner. Runs in registers, without a call. False: a search is needed.
template <std::uint32_t Count>
[[gnu::always_inline]] inline bool still_held(const ContactPlanes& planes, double worst, double give,
                                              ContactSolution& at) noexcept {
    for (std::uint32_t i = 0; i < Count; ++i) {
        if (at.active.plane[i] >= planes.count) return false;
    }
    const Meeting met = meet_blunt<Count>(planes, give, at.active);
    if (Count > 1 && !met.exists) return held_sharply(planes, worst, give, at);
    return accepted(planes, met, give + blunt_tolerance * worst, at);
}

[[gnu::always_inline]] inline bool solved_at_once(const ContactPlanes& planes, double worst, double give,
                                                  ContactSolution& at) noexcept {
    if (!(worst - give > 0)) {  // no contact
        at.status = Status::solved;
        at.iterations = 0;
        at.dx.setZero();
        at.active.count = 0;
        return true;
    }
    if (planes.count == 1) {  // nothing to guess
        const double u = worst - give;
        at.status = Status::solved;
        at.iterations = 0;
        at.dx = {u * planes.nx[0], u * planes.ny[0], u * planes.nz[0]};
        at.multiplier = {u, 0, 0};
        at.active.count = 1;
        at.active.plane[0] = 0;
        return true;
    }
    if (at.active.count == 1) return still_held<1>(planes, worst, give, at);
    if (at.active.count == 2) return still_held<2>(planes, worst, give, at);
    if (at.active.count == 3) return still_held<3>(planes, worst, give, at);
    return false;
}

// Newton's method on the largest contradiction. Each certificate is a lower bound that the next solve
// respects, and there are finitely many. A certificate that is no larger than the present give is rounding,
// of planes that touch exactly: then the give grows by the rounding of lengths of this size, fourfold each
// time.
[[gnu::noinline]] void relax(const ContactPlanes& planes, double worst, double& give,
                             ContactSolution& at) noexcept {
    search(planes, worst, give, at);
    double given = 0;
    double margin = 4 * std::numeric_limits<double>::epsilon() * worst;
    for (std::uint32_t i = 0; i < max_contact_relaxations && at.status == Status::infeasible; ++i) {
        if (at.contradiction > given) {
            given = at.contradiction;
        } else {
            given += margin;
            margin *= 4;
        }
        give = given;
        solve_contact(planes, worst, give, at);
    }
}

}  // namespace

void solve_contact(const ContactPlanes& planes, double worst, double give, ContactSolution& at) noexcept {
    if (!solved_at_once(planes, worst, give, at)) search(planes, worst, give, at);
}

void solve_contact_relaxed(const ContactPlanes& planes, double worst, double& give,
                           ContactSolution& at) noexcept {
    if (!solved_at_once(planes, worst, give, at)) relax(planes, worst, give, at);
}

}  // namespace knurl
