#include <knurl/reps/box.hpp>

#include "surfaces/box_beside.hpp"
#include "surfaces/box_faces.hpp"
#include "surfaces/solid.hpp"

namespace knurl {

using namespace boxes;

namespace {

Seen see(const Box& box, Box::State& state, const Probe& probe, double dt) noexcept {
    move_on(state.motion, dt);
    const Matrix3d axes = to_eigen(box.orientation).toRotationMatrix();
    return {axes, axes.transpose() * from_surface(box.center, box.velocity, state.motion, probe)};
}

double wall_height(const Box& box, const Seen& seen, const Probe& probe, int axis) noexcept {
    return room(to_eigen(box.half_size)[axis], probe) - std::abs(seen.y[axis]);
}

Contact wall(const Box& box, const Seen& seen, const Probe& probe, int axis) noexcept {
    return contact_of(box, (seen.y[axis] < 0 ? 1 : -1) * seen.axes.col(axis),
                      wall_height(box, seen, probe, axis));
}

int nearest_wall(const Box& box, const Seen& seen, const Probe& probe) noexcept {
    int nearest = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (wall_height(box, seen, probe, axis) < wall_height(box, seen, probe, nearest)) nearest = axis;
    }
    return nearest;
}

void remember(const Seen& seen, const Hold& hold, Box::State& state, double dt) noexcept {
    if (!(dt > 0)) return;
    begin_cycle(state);
    state.handed = state.out = 0;
    state.last = to_plain(seen.y);
    state.met = 1;
    state.face = static_cast<std::uint16_t>(hold.face);
    state.slipped = hold.slipped;
}

}  // namespace

Box prepared(Box params, const Limits& limits) noexcept {
    prepare_surface(params, limits);
    params.reserved = 0;
    params.orientation = to_plain(to_eigen(params.orientation).normalized());
    return params;
}

// The state keeps the probe's last place in the box's frame. So a box that is sent elsewhere meets the probe
// on its way.
void adopt(const Box& params, const Box* previous, Box::State& state, const Probe&) noexcept {
    if (!previous) {
        state = {};
        place(state.motion);
        return;
    }
    if (!(params.center == previous->center) || !(params.orientation == previous->orientation) ||
        !(params.half_size == previous->half_size) || !(params.velocity == previous->velocity)) {
        place(state.motion);
    }
}

Contact contact(const Box& params, Box::State& state, const Probe& probe, double dt) noexcept {
    const Seen seen = see(params, state, probe, dt);
    if (params.side == Side::outside && probe.path && probe.path->stage != ProxyPath::Stage::free)
        return contact_beside(Beside(params, state, seen, probe.radius, *probe.path), probe.path->stage, dt);
    Hold hold{};
    if (params.side == Side::outside) hold = follow(state, seen.y, to_eigen(params.half_size), probe.radius);
    if (probe.path) probe.path->holds = hold.face != 0;
    if (probe.path && dt > 0 && params.side == Side::outside)
        report_to_path(state, hold, seen.y, to_eigen(params.half_size), *probe.path);
    const Contact out = params.side == Side::outside
                            ? solid(params, seen, probe.radius, hold)
                            : wall(params, seen, probe, nearest_wall(params, seen, probe));
    remember(seen, hold, state, dt);
    return out;
}

std::uint32_t contacts(const Box& params, Box::State& state, const Probe& probe, double dt,
                       std::span<Contact> out) noexcept {
    if (params.side == Side::outside || out.size() < Box::max_contacts) {
        if (out.empty()) return 0;
        out[0] = contact(params, state, probe, dt);
        return 1;
    }
    const Seen seen = see(params, state, probe, dt);
    for (int axis = 0; axis < 3; ++axis)
        out[static_cast<std::size_t>(axis)] = wall(params, seen, probe, axis);
    remember(seen, {}, state, dt);
    return Box::max_contacts;
}

std::optional<Bound> bound(const Box& params, const Box::State& state) noexcept {
    if (params.side == Side::inside || (state.face != 0 && state.out == 0)) return std::nullopt;
    return Bound{.center = to_eigen(params.center) + state.motion.time * to_eigen(params.velocity),
                 .radius = to_eigen(params.half_size).norm()};
}

void out_of_reach(const Box&, Box::State& state) noexcept {
    state.met = 0;
    state.face = state.slipped = state.out = 0;
}

}  // namespace knurl
