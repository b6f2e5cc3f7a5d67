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

void surface_feedback(const SceneCore& core, std::uint32_t i, Feedback& out) noexcept {
    const Record& r = core.felt(i);
    const Group& group = core.groups_[r.probe];
    const ContactSet& set = group.now;
    const std::uint32_t first = core.slots_[i].member;
    out.stiffness = r.stiffness;
    if (r.rough) out.tangential_stiffness = core.rough(core.owner(i, false)).law.stiffness;
    if (group.fading) out.flags |= Feedback::fading;
    if (core.slots_[i].bounded && !core.slots_[i].near) return;
    if (first == SceneCore::gone || set.count + set.summed == 0) return;
    if (set.infeasible) out.flags |= Feedback::infeasible;
    if (!r.summed && (set.scale != 1 || r.weight == 1))
        out.stiffness = layer_stiffness(set, first - set.begin);
    if (!set.touching) return;
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
    std::size_t n = 0;
    for (const auto& [list, size] : {std::pair{&impl_->surfaces_, impl_->surfaces_size_},
                                     std::pair{&impl_->effects_, impl_->effects_size_}}) {
        for (std::uint32_t e = 0; e < size; ++e) {
            const std::uint32_t i = (*list)[e];
            const Slot& slot = impl_->slots_[i];
            const Record& r = impl_->felt(i);
            if (!r.reported) continue;
            if (n == out.size()) return n;
            Feedback& f = out[n++];
            f = Feedback{};
            f.handle = {i, slot.felt_generation};
            f.contact_point = impl_->groups_[r.probe].probe.position;
            if (kind_ops()[r.kind].surface) {
                surface_feedback(*impl_, i, f);
            } else {
                f.wrench = slot.last;
                f.stiffness = r.stiffness;
                if (slot.last.force.squaredNorm() + slot.last.torque.squaredNorm() > 0)
                    f.flags |= Feedback::touching;
                if (slot.from != Slot::From::none) f.flags |= Feedback::fading;
            }
            if (r.clamped || f.stiffness < r.stiffness) f.flags |= Feedback::stiffness_clamped;
            if (impl_->silence_ > 0) f.flags |= Feedback::silent;
        }
    }
    return n;
}

}  // namespace knurl
