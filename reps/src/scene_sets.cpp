// Builds each probe's sets: the surfaces that act now, and while a fade lasts those that acted before.

#include <cmath>

#include "clamped.hpp"
#include "scene_core.hpp"

namespace knurl::detail {

// The plane that gives the present force here: what an interrupted fade goes on from. It rubs as its surfaces
// did; what their texture pushed is let go.
void SceneCore::make_bridge(Group& group) noexcept {
    const double force = group.force.norm();
    double k = 0;
    for (const ContactSet* set : {&group.now, &group.old}) {
        for (std::uint32_t j = 0; j < set->layers; ++j) {  // of those that push: the others may be far away
            if (!set->layer[j].solution.dx.isZero(0)) k = std::max(k, set->layer[j].stiffness);
        }
    }
    if (k == 0 && force > 0)
        k = std::min(world_stiffness(unlimited_stiffness, limits_),
                     limits_.max_stiffness);  // summed planes: no layer
    group.bridge_stiffness = force > 0 ? k : 0;
    if (group.bridge_stiffness <= 0) return;
    group.bridge.normal = group.force / force;
    const Eigen::Vector3d& p = group.replaced ? group.probe.position : group.position;
    group.bridge.offset = group.bridge.normal.dot(p) + force / k;
    group.bridge_law = group.law;
    if (group.relief != Eigen::Vector3d::Zero()) {
        group.friction.released += group.relief;
        group.friction.released_per_newton = group.friction.released.norm() / force;
        group.friction.residual_time = residual_decay;
    }
}

// The changes that were taken for this probe become one cross-fade: from the set that was felt, or, where
// that was a fade itself, from the plane that stands for it.
void SceneCore::begin_fade(Group& group, std::uint32_t probe) noexcept {
    if (!group.edited || !(group.fades || group.interrupted)) return;
    const double time = settle_ ? 0 : group.fades ? group.fade_time : group.time;
    const bool overtaken = group.fading || group.interrupted;
    if (overtaken && time > 0) make_bridge(group);
    group.bridged = overtaken;
    group.fading = group.fresh = time > 0;
    group.elapsed = 0;
    group.time = time;
    if (++group.fade == 0) group.fade = 1;
    if (!group.fading) return;
    for (std::uint32_t c = 0; c < changed_size_; ++c) {
        Slot& slot = slots_[changed_[c]];
        if (!slot.renewed) continue;
        if (slot.old_in_fade == 0 && slot.old_surface_of == static_cast<std::int32_t>(probe))
            slot.old_in_fade = group.fade;
        const Record& now = felt(changed_[c]);
        if (slot.felt && kind_ops()[now.kind].surface && now.probe == probe && !now.recovers)
            slot.new_in_fade = group.fade;
    }
}

// The owners of the fading set, into scratch_: what changed as it was, and what did not change as it is.
// Surfaces that recover by themselves are in both sets as they are now.
std::uint32_t SceneCore::list_old(Group& group, std::uint32_t probe) noexcept {
    group.olds_left_out = false;
    if (!group.fading) return 0;
    std::uint32_t n = 0;
    if (group.bridged) {
        if (group.bridge_stiffness > 0) scratch_[n++] = bridge_owner;
        return n;
    }
    // A plane that stood where one stands now: in the same order, so that no rounding differs from that of a
    // set that is copied (reshape_sets).
    const auto takes_its_place = [&](std::uint32_t i) {
        const Slot& slot = slots_[i];
        return slot.new_in_fade == group.fade && slot.old_in_fade == group.fade &&
               slot.old_surface_of == static_cast<std::int32_t>(probe) && slot.felt &&
               felt(i).probe == probe && felt(i).stands && faded(i).stands;
    };
    for (std::uint32_t f = 0; f < fading_olds_size_; ++f) {
        const std::uint32_t i = fading_olds_[f];
        if (slots_[i].old_surface_of != static_cast<std::int32_t>(probe) || takes_its_place(i)) continue;
        if (group.bounded > 0) {
            const std::optional<Bound> ball = ball_now(faded(i));
            const double within = group.near.margin + group.placement.radius;
            const double far = within + 1e-12 * (group.near.at.lpNorm<1>() + within);
            const double gap =
                !ball ? 0 : (ball->center - group.near.at).norm() - (ball->radius * (1 + 1e-12) + far);
            const double away = gap > 0 ? away_for(gap, ball->velocity.norm()) : 0;
            if (away > 0) {
                group.olds_left_out = true;
                group.near.until = std::min(group.near.until, now_.all + away);
                continue;
            }
        }
        scratch_[n++] = owner(i, true);
    }
    const auto take = [&](std::uint32_t i) {
        if (slots_[i].new_in_fade != group.fade) scratch_[n++] = owner(i, false);
    };
    for (std::uint32_t k = 0; k < always_size_; ++k) {
        if (takes_its_place(always_[k])) {
            scratch_[n++] = owner(always_[k], true);
        } else if (felt(always_[k]).probe == probe) {
            take(always_[k]);
        }
    }
    for (std::uint32_t k = 0; k < group.near.size; ++k) take(group.near.slots[k]);
    return n;
}

std::uint32_t SceneCore::list_now(const Group& group, std::uint32_t probe) noexcept {
    std::uint32_t n = 0;
    for (std::uint32_t k = 0; k < always_size_; ++k) {
        if (felt(always_[k]).probe == probe) scratch_[n++] = owner(always_[k], false);
    }
    for (std::uint32_t k = 0; k < group.near.size; ++k) scratch_[n++] = owner(group.near.slots[k], false);
    return n;
}

namespace {

// The distinct stiffnesses of a set, softest first. One too many and the nearest two become one, the softer:
// nobody feels more than was asked for.
struct Levels {
    std::array<double, max_layers + 1> k{};
    std::uint32_t count = 0;

    void take(double stiffness) noexcept {
        std::uint32_t at = 0;
        while (at < count && k[at] < stiffness) ++at;
        if (at < count && k[at] == stiffness) return;
        for (std::uint32_t i = count; i > at; --i) k[i] = k[i - 1];
        k[at] = stiffness;
        if (++count <= max_layers) return;
        std::uint32_t nearest = 0;
        for (std::uint32_t i = 1; i + 1 < count; ++i) {
            if (k[i + 1] * k[nearest] < k[nearest + 1] * k[i]) nearest = i;  // by ratio
        }
        for (std::uint32_t i = nearest + 1; i + 1 < count; ++i) k[i] = k[i + 1];
        --count;
    }
    std::uint8_t of(double stiffness) const noexcept {
        std::uint32_t at = count - 1;
        while (at > 0 && k[at] > stiffness) --at;
        return static_cast<std::uint8_t>(at);
    }
};

}  // namespace

void SceneCore::build(ContactSet& set, const Group& group, Arena& into,
                      std::span<const Owner> owners) noexcept {
    set.begin = into.used;
    set.count = set.standing = set.summed = 0;
    set.layers = 0;
    set.moving_begin = into.moving_used;
    set.moving_count = set.room = set.moving_room = set.inside = 0;
    set.infeasible = set.rough = set.curved = false;
    if (owners.empty()) {
        set.force.setZero();
        set.touching = false;
        return;
    }
    const auto stiffness_of = [&](Owner o) {
        return o == bridge_owner ? group.bridge_stiffness : record(o).stiffness;
    };
    const auto weight_of = [&](Owner o) { return o == bridge_owner ? 1.0 : record(o).weight; };

    // One weight for all scales the force; unequal weights make unequal stiffnesses, which the layers keep
    // continuous.
    bool uniform = true;
    for (const Owner o : owners) uniform = uniform && weight_of(o) == weight_of(owners.front());
    set.scale = uniform ? weight_of(owners.front()) : 1;

    Levels levels;
    constexpr std::uint8_t none = 0xff, summed = 0xfe;
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const Owner o = owners[i];
        const double k = stiffness_of(o) * (uniform ? 1 : weight_of(o));
        level_[i] = !(k > 0) ? none : o != bridge_owner && record(o).summed ? summed : 0;
        if (level_[i] == 0) levels.take(k);
        set.rough = set.rough || (o == bridge_owner ? group.bridge_law.rubs() : record(o).rough);
    }
    set.layers = levels.count;
    std::array<std::uint32_t, max_layers> members{};
    std::uint32_t sums = 0;
    const auto parts_of = [&](Owner o) {
        return o == bridge_owner || record(o).stands ? 1u : kind_ops()[record(o).kind].contacts;
    };
    for (std::size_t i = 0; i < owners.size(); ++i) {
        if (level_[i] == none) continue;
        if (level_[i] == summed) {
            ++sums;
            continue;
        }
        level_[i] = levels.of(stiffness_of(owners[i]) * (uniform ? 1 : weight_of(owners[i])));
        members[level_[i]] += parts_of(owners[i]);
    }
    std::array<std::uint32_t, max_layers> next{};
    for (std::uint32_t j = set.layers; j-- > 0;) {  // hardest first: each layer is a prefix
        next[j] = set.count;
        set.count += members[j];
        set.layer[j].stiffness = levels.k[j];
        set.layer[j].count = set.count;
    }
    forget_solution(set, group);
    set.summed = sums;
    std::uint32_t next_sum = set.count, surfaces = 0;
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const Owner o = owners[i];
        if (level_[i] == none) {
            if (o != bridge_owner && !fades_out(o)) slots_[o >> 1].member = gone;
            continue;
        }
        std::uint32_t& place = level_[i] == summed ? next_sum : next[level_[i]];
        const std::uint32_t at = set.begin + place, parts = parts_of(o);
        place += parts;
        const bool stands = o == bridge_owner || record(o).stands;
        surfaces += level_[i] != summed;
        if (stands && level_[i] != summed) ++set.standing;
        const HalfSpace& plane = o == bridge_owner ? group.bridge : record(o).plane;
        for (std::uint32_t part = at; part < at + parts; ++part) {
            into.owner[part] = o;
            into.nx[part] = stands ? plane.normal.x() : 0;
            into.ny[part] = stands ? plane.normal.y() : 0;
            into.nz[part] = stands ? plane.normal.z() : 0;
            // A surface that moves is asked each cycle; until then it is out of reach.
            into.c[part] = !stands ? -std::numeric_limits<double>::infinity()
                                   : plane.offset + (o == bridge_owner ? 0 : group.probe.radius);
            into.s[part] = -std::numeric_limits<double>::infinity();
            into.b[part] = stands && o != bridge_owner ? plane.damping * (uniform ? 1 : weight_of(o)) : 0;
        }
        if (!stands) {
            set.curved = set.curved || (level_[i] != summed && kind_ops()[record(o).kind].curved);
            Eigen::Vector3d center = Eigen::Vector3d::Zero();
            double reach = std::numeric_limits<double>::infinity();
            // One that moves may come near: it is asked while it is in a set.
            const std::optional<Bound> ball = kind_ops()[record(o).kind].bound(record(o));
            if (ball && ball->velocity.isZero(0)) {
                center = ball->center;
                reach = ball->radius + group.probe.radius;
                reach += 1e-12 * (reach + center.lpNorm<1>());  // what the rounding of coordinates may hide
            }
            into.balls->put(into.moving_used, center, reach);
            into.moving[into.moving_used++] = {.member = at};
        }
        if (o != bridge_owner && &set == &group.now) slots_[o >> 1].member = at;
    }
    set.curved = set.curved && surfaces > 1 && surfaces_size_ <= max_curved_surfaces;
    set.moving_count = set.moving_room = into.moving_used - set.moving_begin;
    set.room = (set.count + set.summed + 3) / 4 * 4;
    into.used += set.room;
}

void forget_solution(ContactSet& set, const Group& group) noexcept {
    set.infeasible = false;
    set.clear.distance = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        Layer& layer = set.layer[j];
        layer.give = layer.given_at = 0;
        layer.solution = ContactSolution{};
        layer.reached[0].cycle = layer.reached[1].cycle = 0;
        layer.started = false;
        layer.far = 0;
        layer.joined = false;
        layer.proxy = group.probe.position;
    }
}

namespace {

// Where nothing rubs the tip is not followed: what rubs next begins where the tip is then.
void leave_anchor(Group& group) noexcept {
    if (!group.rough && !(group.friction.residual_time > 0)) group.friction.held = false;
}

}  // namespace

void SceneCore::end_fade(Group& group) noexcept {
    group.old.slack = 0;
    group.old.count = group.old.summed = group.old.layers = group.old.moving_count = 0;
    group.fading = group.fresh = group.bridged = false;
    group.rough = group.now.rough;
    leave_anchor(group);
}

void SceneCore::rebuild_sets() noexcept {
    Arena& into = arenas_[arena_ ^ 1];
    into.used = into.moving_used = 0;
    contacts_used_ = 0;
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
        if (probes_used_ >> p & 1) begin_fade(groups_[p], p);
    }
    std::uint32_t kept = 0;
    for (std::uint32_t f = 0; f < fading_olds_size_; ++f) {
        Slot& slot = slots_[fading_olds_[f]];
        const bool used = slot.old_surface_of >= 0 && [&] {
            const Group& group = groups_[static_cast<std::uint32_t>(slot.old_surface_of)];
            return group.fading && !group.bridged && group.fade == slot.old_in_fade;
        }();
        if (used) {
            fading_olds_[kept++] = fading_olds_[f];
        } else {
            slot.old_surface_of = -1;
            slot.old_listed = false;
        }
    }
    fading_olds_size_ = kept;
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
        Group& group = groups_[p];
        if (!(probes_used_ >> p & 1)) continue;
        const std::uint32_t olds = list_old(group, p);
        const CurvedStarts now = starts_of(group.now, group);
        const CurvedStarts old = starts_of(group.old.layers > 0 ? group.old : group.now, group);
        build(group.old, group, into, std::span<const Owner>(scratch_.data(), olds));
        build(group.now, group, into, std::span<const Owner>(scratch_.data(), list_now(group, p)));
        if (!group.edited) take_starts(group.now, into, now);  // what is new is felt for what it is
        take_starts(group.old, into, old);
        built(group, p);
    }
    arena_ ^= 1;
    sets_edited_ = false;
    told_.edited = true;
}

void SceneCore::built(Group& group, std::uint32_t probe) noexcept {
    group.rough = group.now.rough || group.old.rough;
    leave_anchor(group);
    if (group.now.count + group.now.summed > 0 || group.fading) {
        contacts_used_ |= 1u << probe;
    } else {
        release(group);
    }
    group.edited = group.fades = group.interrupted = group.replaced = false;
    group.fade_time = 0;
}

// Nothing is touched any more.
void SceneCore::release(Group& group) noexcept {
    group.force.setZero();
    group.along.setZero();
    group.relief.setZero();
    group.law = FrictionLaw{};
    group.friction = FrictionState{.generator = group.friction.generator, .seed = group.friction.seed};
    group.pulse_left = 0;
    group.apart = 1;
}

}  // namespace knurl::detail
