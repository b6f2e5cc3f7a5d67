#include <cmath>
#include <limits>

#include <knurl/reps/shape.hpp>

#include "surfaces/shape_beside.hpp"
#include "surfaces/surface.hpp"

namespace knurl {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using shapes::at;
using shapes::put;
using shapes::touches;

// The pose of the shape in this cycle, extrapolated from its last update.
struct Pose {
    Quaterniond turn;
    Vector3d position;
    Pose(const Shape& params, const Motion& motion) noexcept
        : turn(to_eigen(params.orientation)),
          position(to_eigen(params.position) + motion.time * to_eigen(params.velocity)) {
        const Vector3d spin = to_eigen(params.angular_velocity);
        const double rate = spin.norm(), angle = rate * motion.time;
        if (angle > 0) turn = (Eigen::AngleAxisd(angle, spin / rate) * turn).normalized();
    }
    Vector3d to_asset(const Vector3d& world) const noexcept { return turn.conjugate() * (world - position); }
};

AssetMaterial material_of(const Shape::State& state) noexcept {
    const auto& materials = state.asset->materials;
    return state.material < materials.size() ? materials[state.material] : AssetMaterial{};
}

constexpr double out = std::numeric_limits<double>::infinity();  // m, the height of an untouched surface

}  // namespace

Shape prepared(Shape params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    params.orientation = to_plain(to_eigen(params.orientation).normalized());
    return params;
}

void adopt(const Shape& params, const Shape* previous, Shape::State& state, const Probe& probe) noexcept {
    const bool placed = !previous || !(params.position == previous->position) ||
                        !(params.orientation == previous->orientation) ||
                        !(params.velocity == previous->velocity) ||
                        !(params.angular_velocity == previous->angular_velocity);
    Motion before = state.motion;
    if (placed) place(state.motion);
    if (state.asset == state.met) return;
    // Another asset replaces the touched one: the proxy continues from its place in the world.
    if (previous && state.asset && state.met && touches(state.proxy.phase)) {
        const Pose then(*previous, before), now(params, state.motion);
        put(state.proxy.at, now.to_asset(then.turn * at(state.proxy.at) + then.position));
        const Vector3d hand = now.to_asset(probe.position);
        put(state.proxy.last, hand);
        Work work;
        knurl::adopt(*state.asset, state.proxy, hand, work);
    } else {
        state.proxy = {};
    }
    state.height = out;
    state.handed = 0;
    state.anew = 1;
    state.met = state.asset;
}

namespace {

// Of the plane by which it holds the probe; the normal is in the world frame.
Contact felt(const Shape& params, const Shape::State& state, const Pose& pose, const Probe& probe,
             const Vector3d& normal, double height) noexcept {
    const AssetMaterial share = material_of(state);
    // A softer material is expressed as a shorter depth: one surface has one stiffness when solved jointly.
    Contact contact = contact_of(params, normal, height < 0 ? share.stiffness * height : height);
    contact.damping *= share.damping;
    contact.friction = share.friction;
    const Vector3d arm = (probe.position - height * normal) - pose.position;
    contact.velocity += to_eigen(params.angular_velocity).cross(arm);
    return contact;
}

// Follows the path of the proxy.
[[gnu::cold, gnu::noinline]] Contact contact_of_proxy(const Shape& params, Shape::State& state,
                                                      const Pose& pose, const Probe& probe,
                                                      double dt) noexcept {
    const double far = probe.position.lpNorm<1>() + pose.position.lpNorm<1>();
    const double rounding = 16 * std::numeric_limits<double>::epsilon() * far;
    shapes::Beside beside(state, pose.turn, pose.to_asset(probe.position), rounding, probe.radius,
                          *probe.path);
    if (!take_stage(beside, probe.path->stage, dt)) return {.height = out};
    const Vector3d normal = pose.turn * to_eigen(state.normal);
    const double height = beside.height();
    state.height = height;
    if (touches(state.proxy.phase)) put(state.proxy.last, pose.to_asset(probe.position));
    if (!std::isfinite(height)) return contact_of(params, normal, out);
    return felt(params, state, pose, probe, normal, height);
}

// Where no time passes and it alone has held the probe, it is evaluated at its own answer. An evaluation that
// is repeated in a cycle gives the same answer.
bool goes_by_proxy(const Shape& params, Shape::State& state, const ProxyPath& path, double dt) noexcept {
    using Stage = ProxyPath::Stage;
    if (path.stage == Stage::free || params.shading != Shading::flat) return false;
    if (path.stage != Stage::answer) {
        if (path.stage == Stage::brush) state.tries = 0;
        return true;
    }
    if (path.first) state.tries = !(dt > 0) && path.to.isZero(0);
    return state.tries == 0;
}

// Reports to the path what the probe's motion has led to in this cycle.
[[gnu::cold, gnu::noinline]] void report_to_path(const Shape::State& state, const Vector3d& hand,
                                                 ProxyPath& path) noexcept {
    const bool held = touches(state.was_phase), holds = touches(state.proxy.phase);
    path.entered = path.entered || (!held && holds);
    path.left = path.left || (held && !holds);
    if (held || holds || path.grazed || state.was_phase == Proxy::Phase::fresh) return;
    Foot foot;
    Work work;
    const Vector3d from = to_eigen(state.start);
    path.grazed =
        first_front(*state.asset, from, hand, shapes::seam_of(*state.asset), from - hand, foot, work) <= 1;
}

}  // namespace

Contact contact(const Shape& params, Shape::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    if (!state.asset) return {.height = out};
    const Pose pose(params, state.motion);
    if (probe.path && goes_by_proxy(params, state, *probe.path, dt))
        return contact_of_proxy(params, state, pose, probe, dt);
    const Vector3d hand = pose.to_asset(probe.position);
    Vector3d normal = to_eigen(state.normal);
    double height = state.height, offset = state.offset;
    std::uint32_t material = state.material;
    const bool fresh = state.proxy.phase == Proxy::Phase::fresh;
    if (dt > 0) shapes::begin_cycle(state);
    // A repeated evaluation within a cycle gives the same answer.
    if (dt > 0 || fresh || hand != at(state.proxy.last)) {
        Proxy proxy = state.proxy;
        Foot foot;
        Work work;
        height = out;
        if (follow(*state.asset, proxy, hand, probe.radius, foot, work)) {
            material = foot.material;
            height = -foot.depth;
            normal = foot.normal;
            offset = normal.dot(foot.point);
            if (params.shading == Shading::smooth) normal = shaded_normal(*state.asset, foot);
        }
        if (dt > 0 || fresh) {
            state.proxy = proxy;
            state.height = height;
            state.handed = state.anew = 0;
            state.brushed = touches(proxy.phase) && -height < probe.radius;
            shapes::hold_by(state, normal, offset, material);
        }
    }
    if (probe.path) {
        probe.path->holds = touches(state.proxy.phase) && height < -probe.radius;
        if (probe.path->beside && dt > 0) report_to_path(state, hand, *probe.path);
    }
    normal = pose.turn * normal;
    if (!(height < 0)) return contact_of(params, normal, out);
    return felt(params, state, pose, probe, normal, height);
}

// While it holds the hand it may hold it at any depth, so it has no bound. The ball is about its middle. If
// it turns, the ball is about the nearest point of its axis, which moves straight, so the ball holds over
// time.
std::optional<Bound> bound(const Shape& params, const Shape::State& state) noexcept {
    if (touches(state.proxy.phase)) return std::nullopt;
    if (!state.asset) return Bound{.center = to_eigen(params.position)};
    const Pose pose(params, state.motion);
    const Vector3d middle = (state.asset->low + state.asset->high) / 2;
    Vector3d arm = pose.turn * middle;
    double radius = (state.asset->high - state.asset->low).norm() / 2;
    const Vector3d spin = to_eigen(params.angular_velocity);
    if (const double rate = spin.norm(); rate > 0) {
        const Vector3d axis = spin / rate, along = axis.dot(arm) * axis;
        radius += (arm - along).norm();
        arm = along;
    }
    // Adds the rounding of its pose, where its origin is far away.
    radius += 1e-14 * (middle.lpNorm<1>() + pose.position.lpNorm<1>());
    return Bound{.center = arm + pose.position, .radius = radius, .velocity = to_eigen(params.velocity)};
}

void out_of_reach(const Shape&, Shape::State& state) noexcept {
    state.proxy = {};
    state.height = out;
    state.handed = state.anew = state.brushed = 0;
}

}  // namespace knurl
