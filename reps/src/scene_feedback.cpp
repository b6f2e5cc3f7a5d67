// What the application and the servo learn after a cycle.

#include <cmath>

#include "scene_core.hpp"

namespace knurl {

using Eigen::Vector3d;
using namespace detail;

namespace {

// The share of one plane in its set's force: sum_j (k_j - k_{j-1}) u_j n.
double share(const ContactSet& set, std::uint32_t member) noexcept {
    double sum = 0, below = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        const Layer& layer = set.layer[j];
        for (std::uint32_t i = 0; i < layer.solution.active.count; ++i) {
            if (layer.solution.active.plane[i] == member) {
                sum += (layer.stiffness - below) * layer.solution.multiplier[i];
            }
        }
        below = layer.stiffness;
    }
    return sum;
}

double layer_stiffness(const ContactSet& set, std::uint32_t member) noexcept {
    double k = 0;
    for (std::uint32_t j = 0; j < set.layers; ++j) {
        if (member < set.layer[j].count) k = set.layer[j].stiffness;
    }
    return k;
}

Vector3d point_of(const Group& group) noexcept {
    const Vector3d& p = group.probe.position;
    if (!group.now.touching || group.now.layers == 0) return p;
    const Vector3d dx = group.now.layer[0].solution.dx;
    const double depth = dx.norm();
    return depth > 0 ? Vector3d(p + dx - (group.probe.radius / depth) * dx) : p;
}

void touching_feedback(const SceneCore& core, std::uint32_t i, Feedback& out) noexcept {
    const Record& r = core.felt(i);
    const Group& group = core.groups_[r.probe];
    const ContactSet& set = group.now;
    const std::uint32_t first = core.slots_[i].member;
    const Arena& a = core.arenas_[core.arena_];
    const double s = group.fading ? group.elapsed / group.time : 1;
    double push = 0;  // N; 0 too where damping outweighs the depth, and touched all the same
    bool touched = false;
    for (std::uint32_t at = first; at < first + kind_ops()[r.kind].contacts; ++at) {
        const double part = r.summed ? r.stiffness * std::max(0.0, a.s[at]) : share(set, at - set.begin);
        if (!(part > 0)) continue;
        touched = true;
        const double felt = s * (r.summed ? set.scale : set.per_elastic) * part;
        push += felt;
        out.wrench.force += felt * Vector3d(a.nx[at], a.ny[at], a.nz[at]);
    }
    if (!touched) return;
    out.flags |= Feedback::touching;
    const double whole = group.force.norm();
    if (group.rough && whole > 0) out.wrench.force += (push / whole) * (group.along + group.relief);
    if (group.placement.offset != Vec3{}) out.wrench.torque = group.arm.cross(out.wrench.force);
    out.contact_point = point_of(group);
}

void surface_feedback(const SceneCore& core, std::uint32_t i, const Record& r, Feedback& out) noexcept {
    const Slot& slot = core.slots_[i];
    const Group& group = core.groups_[r.probe];
    const ContactSet& set = group.now;
    if (r.rough) out.tangential_stiffness = core.rough(core.owner(i, false)).law.stiffness;
    if (group.fading) out.flags |= Feedback::fading;
    if (slot.bounded && !slot.near) return;
    if (slot.member == SceneCore::gone || set.count + set.summed == 0) return;
    if (set.infeasible) out.flags |= Feedback::infeasible;
    if (!r.summed && (set.scale != 1 || r.weight == 1))
        out.stiffness = layer_stiffness(set, slot.member - set.begin);
    if (set.touching) touching_feedback(core, i, out);
}

void effect_feedback(const Slot& slot, Feedback& out) noexcept {
    out.wrench = slot.last;
    if (slot.last.force.squaredNorm() + slot.last.torque.squaredNorm() > 0) out.flags |= Feedback::touching;
    if (slot.from != Slot::From::none) out.flags |= Feedback::fading;
}

}  // namespace

Vector3d Scene::contact_point() const noexcept {
    return point_of(impl_->groups_[0]);
}

std::uint32_t Scene::size() const noexcept {
    return impl_->size_;
}
std::uint32_t Scene::count(Kind kind) const noexcept {
    return kind < Representations::size ? impl_->counts_[kind] : 0;
}
std::uint32_t Scene::evaluated() const noexcept {
    return impl_->evaluated_;
}

double Scene::stiffness_sum() const noexcept {
    double sum = 0;
    for (const Group& group : impl_->groups_) {
        double k = 0;
        for (const ContactSet* set : {&group.now, &group.old}) {
            if (set->layers > 0) k = std::max(k, set->layer[set->layers - 1].stiffness);
        }
        sum += k;
    }
    for (std::uint32_t e = 0; e < impl_->effects_size_; ++e) sum += impl_->felt(impl_->effects_[e]).stiffness;
    return sum;
}

std::size_t Scene::feedback(std::span<Feedback> out) const noexcept {
    const SceneCore& core = *impl_;
    const std::uint32_t silent = core.silence_ > 0 ? Feedback::silent : 0;
    std::size_t n = 0;
    const auto take = [&](std::span<const std::uint32_t> list, auto fill) {
        for (const std::uint32_t i : list) {
            const Record& r = core.felt(i);
            if (!r.reported) continue;
            if (n == out.size()) return;
            Feedback& f = out[n++];
            f.handle = {i, core.slots_[i].felt_generation};
            f.wrench = Wrench{};
            f.contact_point = core.groups_[r.probe].probe.position;
            f.stiffness = r.stiffness;
            f.tangential_stiffness = 0;
            f.flags = silent;
            f.reserved = 0;
            fill(i, r, f);
            if (r.clamped || f.stiffness < r.stiffness) f.flags |= Feedback::stiffness_clamped;
        }
    };
    take(std::span(core.surfaces_.data(), core.surfaces_size_),
         [&](std::uint32_t i, const Record& r, Feedback& f) { surface_feedback(core, i, r, f); });
    take(std::span(core.effects_.data(), core.effects_size_),
         [&](std::uint32_t i, const Record&, Feedback& f) { effect_feedback(core.slots_[i], f); });
    return n;
}

}  // namespace knurl
