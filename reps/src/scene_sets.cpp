// Builds each probe's sets: the surfaces that act now, and while a fade lasts those that acted before.

#include <cmath>

#include "scene_core.hpp"

namespace knurl::detail {

// The plane that gives the present force here: what an interrupted fade goes on from.
void SceneCore::make_bridge(Group& group) noexcept {
    const double force = group.force.norm();
    double k = 0;
    for (const ContactSet* set : {&group.now, &group.old}) {
        if (set->layers > 0) k = std::max(k, set->layer[set->layers - 1].stiffness);
    }
    group.bridge_stiffness = force > 0 ? k : 0;
    if (group.bridge_stiffness <= 0) return;
    group.bridge.normal = group.force / force;
    const Eigen::Vector3d& p = group.replaced ? group.probe.position : group.position;
    group.bridge.offset = group.bridge.normal.dot(p) + force / k;
}

// The owners of the fading set, into scratch_. Surfaces that recover by themselves are in both sets as they
// are now.
std::uint32_t SceneCore::list_old(Group& group, std::uint32_t probe) noexcept {
    const Arena& arena = arenas_[arena_];
    const bool was_fading = group.fading;
    for (std::uint32_t i = group.old.begin; i < group.old.begin + group.old.count; ++i) {
        const Owner owner = arena.owner[i];
        if (owner != bridge_owner && (owner & 1)) slots_[owner >> 1].old_surface_of = -1;
    }
    if (group.edited && (group.fades || group.interrupted)) {
        const double time = settle_ ? 0 : group.fades ? group.fade_time : group.time;
        group.fading = group.fresh = time > 0;
        group.elapsed = 0;
        group.time = time;
        if (!group.fading) return 0;
        if (was_fading || group.interrupted) {
            make_bridge(group);
            scratch_[0] = bridge_owner;
            return group.bridge_stiffness > 0 ? 1 : 0;
        }
    } else if (!was_fading) {
        return 0;
    }

    const ContactSet& from = was_fading ? group.old : group.now;
    const auto recovers_here = [&](std::uint32_t slot) {
        return slots_[slot].felt && kind_ops()[now_[slot].kind].surface && now_[slot].use.probe == probe &&
               now_[slot].recovers;
    };
    std::uint32_t n = 0;
    for (std::uint32_t i = from.begin; i < from.begin + from.count; ++i) {
        const Owner owner = arena.owner[i];
        if (owner == bridge_owner || !slots_[owner >> 1].renewed) {
            scratch_[n++] = owner;
        } else if (!recovers_here(owner >> 1) && !was_fading &&
                   !(old_[owner >> 1].recovers && !slots_[owner >> 1].felt)) {
            scratch_[n++] = owner_of(owner >> 1, true);
        }
    }
    for (std::uint32_t c = 0; c < changed_size_; ++c) {
        if (slots_[changed_[c]].renewed && recovers_here(changed_[c]))
            scratch_[n++] = owner_of(changed_[c], false);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        if (scratch_[i] != bridge_owner && (scratch_[i] & 1)) {
            slots_[scratch_[i] >> 1].old_surface_of = static_cast<std::int32_t>(probe);
        }
    }
    return n;
}

std::uint32_t SceneCore::list_now(std::uint32_t probe) noexcept {
    std::uint32_t n = 0;
    for (std::uint32_t i = 0; i < surfaces_size_; ++i) {
        if (now_[surfaces_[i]].use.probe == probe) scratch_[n++] = owner_of(surfaces_[i], false);
    }
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
    set.count = 0;
    set.layers = 0;
    set.moving_begin = into.moving_used;
    set.moving_count = 0;
    set.infeasible = false;
    const auto stiffness_of = [&](Owner o) {
        return o == bridge_owner ? group.bridge_stiffness : record(o).stiffness;
    };
    const auto weight_of = [&](Owner o) { return o == bridge_owner ? 1.0 : record(o).weight; };

    // One weight for all scales the force; unequal weights make unequal stiffnesses, which the layers keep
    // continuous.
    bool uniform = true;
    for (const Owner o : owners) uniform = uniform && weight_of(o) == weight_of(owners.front());
    set.scale = uniform && !owners.empty() ? weight_of(owners.front()) : 1;

    Levels levels;
    for (const Owner o : owners) {
        const double k = stiffness_of(o) * (uniform ? 1 : weight_of(o));
        if (k > 0) levels.take(k);
    }
    set.layers = levels.count;
    if (set.layers == 0) return;
    std::array<std::uint32_t, max_layers> members{};
    constexpr std::uint8_t none = 0xff;
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const double k = stiffness_of(owners[i]) * (uniform ? 1 : weight_of(owners[i]));
        level_[i] = k > 0 ? levels.of(k) : none;
        if (k > 0) ++members[level_[i]];
    }
    std::array<std::uint32_t, max_layers> next{};
    for (std::uint32_t j = set.layers; j-- > 0;) {  // hardest first: each layer is a prefix
        next[j] = set.count;
        set.count += members[j];
        set.layer[j] = Layer{};
        set.layer[j].stiffness = levels.k[j];
        set.layer[j].count = set.count;
        set.layer[j].proxy = group.probe.position;
    }
    for (std::size_t i = 0; i < owners.size(); ++i) {
        const Owner o = owners[i];
        if (level_[i] == none) {
            if (!(o & 1)) slots_[o >> 1].member = gone;
            continue;
        }
        const std::uint32_t at = set.begin + next[level_[i]]++;
        const bool stands = o == bridge_owner || record(o).stands;
        const HalfSpace& plane = o == bridge_owner ? group.bridge : record(o).plane;
        into.owner[at] = o;
        into.nx[at] = stands ? plane.normal.x() : 0;
        into.ny[at] = stands ? plane.normal.y() : 0;
        into.nz[at] = stands ? plane.normal.z() : 0;
        // A surface that moves is asked each cycle; until then it is out of reach.
        into.c[at] = !stands ? -std::numeric_limits<double>::infinity()
                             : plane.offset + (o == bridge_owner ? 0 : group.probe.radius);
        into.b[at] = stands && o != bridge_owner ? plane.damping * (uniform ? 1 : weight_of(o)) : 0;
        if (!stands) into.moving[into.moving_used++] = at;
        if (o != bridge_owner && &set == &group.now) slots_[o >> 1].member = at;
    }
    set.moving_count = into.moving_used - set.moving_begin;
    into.used += (set.count + 3) / 4 * 4;
}

void SceneCore::end_fade(Group& group) noexcept {
    const Arena& arena = arenas_[arena_];
    for (std::uint32_t i = group.old.begin; i < group.old.begin + group.old.count; ++i) {
        if (arena.owner[i] != bridge_owner && (arena.owner[i] & 1))
            slots_[arena.owner[i] >> 1].old_surface_of = -1;
    }
    group.old.count = group.old.layers = group.old.moving_count = 0;
    group.fading = group.fresh = false;
}

void SceneCore::rebuild_sets() noexcept {
    Arena& into = arenas_[arena_ ^ 1];
    into.used = into.moving_used = 0;
    contacts_used_ = 0;
    for (std::uint32_t p = 0; p < groups_.size(); ++p) {
        Group& group = groups_[p];
        if (!(probes_used_ >> p & 1)) continue;
        // The lists of before are read from the present arena before the sets' places are overwritten.
        const std::uint32_t olds = list_old(group, p);
        build(group.old, group, into, std::span<const Owner>(scratch_.data(), olds));
        build(group.now, group, into, std::span<const Owner>(scratch_.data(), list_now(p)));
        if (group.now.count > 0 || group.fading) contacts_used_ |= 1u << p;
        if (group.now.count == 0 && !group.fading) group.force.setZero();
        group.edited = group.fades = group.interrupted = group.replaced = false;
        group.fade_time = 0;
    }
    arena_ ^= 1;
    sets_edited_ = false;
}

}  // namespace knurl::detail
