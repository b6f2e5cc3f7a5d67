// Surfaces of unequal stiffness: a harder surface is entered by the proxy of all surfaces together, which is
// that of the softest layer. The proxies of harder layers are held by fewer surfaces, so they may lie deeper:
//
//        soft          | hard               x0: proxy of the layer of both, slides on to the hard surface
//      ======== x0 --->|======== face       x1: proxy of the layer of the hard one alone: nothing has held it
//               :      |
//               x1 - ->| - - - - lowered    `gap` under the face it holds x1, too
//
// If the hard surface took hold of x1 by its face, the force would step, and the hand that slides in deep and
// is pushed out would gain k1 - k0 times half the square of that depth. So the face lies lower for x1, by as
// much as x1 lay behind it when x0 entered. Where x1 rises, the gap closes behind it: no work is done.

#include <cmath>

#include "contact/contact_stage.hpp"

namespace knurl::detail {

using Eigen::Vector3d;

namespace {

constexpr double nowhere = -std::numeric_limits<double>::infinity();

bool holds_below(const ContactSet& set, const Layer& layer, const Record& r, const Gap& gap) noexcept {
    return layer.stiffness > gap.softer * r.stiffness * own_weight(set, r.weight) * (1 + 1e-12);
}

}  // namespace

// The surface has just been entered. The layers are solved without it still.
void ContactStage::begin_gap(ContactSet& set, const Vector3d& p, std::uint32_t i) noexcept {
    const Arena& a = sets_.arena();
    const Record& r = state_.records[a.owner[i]];
    Gap& gap = state_.records.gap(a.owner[i]);
    gap = {};
    // A shape of an asset has many faces: a gap under one of them says nothing about the next.
    if (set.layers < 2 || !(a.s[i] > nowhere) || kind_ops()[r.kind].asset(r) != nullptr) return;
    const Vector3d n(a.nx[i], a.ny[i], a.nz[i]);
    const auto depth_before = [&](const Layer& layer) {
        return a.s[i] - n.dot(lead_.before + lead_.contact->last.of(layer.stiffness) - p);
    };
    // One that was sent to where the hand is has found x0 behind its face too.
    const double entered = std::max(0.0, depth_before(set.layer[0]));
    double softer = set.layer[0].stiffness;  // up to here the proxies have come to the face with x0
    for (std::uint32_t j = 1; j < set.layers && i - set.begin < set.layer[j].count; ++j) {
        const Layer& layer = set.layer[j];
        const double now = a.s[i] - n.dot(layer.solution.dx), before = depth_before(layer) - entered;
        if (std::min(now, before) > 0) {
            gap.depth = std::max(gap.depth, std::min(now, before));
        } else if (!(gap.depth > 0)) {
            softer = layer.stiffness;
        }
    }
    if (!(gap.depth > 0)) return;
    gap.softer = softer / (r.stiffness * own_weight(set, r.weight));
    set.gaps = true;
}

// Before this layer is solved, and those above it. True: there is one.
bool ContactStage::lower_by_gaps(const ContactSet& set, const Layer& layer, PlanesApart& apart) noexcept {
    Arena& a = sets_.arena();
    bool any = false;
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t i = a.moving[m].member;
        if (i - set.begin >= layer.count || !(a.s[i] > nowhere)) continue;
        const Gap& gap = state_.records.gap(a.owner[i]);
        if (!(gap.depth > 0) || !holds_below(set, layer, state_.records[a.owner[i]], gap) || apart.full() ||
            apart.has(i))
            continue;
        apart.keep(a, i);
        a.s[i] -= gap.depth;
        any = true;
    }
    return any;
}

void ContactStage::remember_layers(ContactState& contact, const Vector3d& p) noexcept {
    const ContactSet& now = contact.now;
    contact.last.count = now.layers;
    for (std::uint32_t j = 0; j < now.layers; ++j) {
        contact.last.stiffness[j] = static_cast<float>(now.layer[j].stiffness);
        contact.last.from_probe[j] = (now.layer[j].proxy - p).cast<float>();
    }
}

// At the end of a cycle: within it, a repeated evaluation gives the same answer.
void ContactStage::close_gaps(ContactSet& set) noexcept {
    if (!set.gaps) return;
    const Arena& a = sets_.arena();
    set.gaps = false;
    for (std::uint32_t m = set.moving_begin; m < set.moving_begin + set.moving_count; ++m) {
        const std::uint32_t i = a.moving[m].member;
        Gap& gap = state_.records.gap(a.owner[i]);
        if (!(gap.depth > 0)) continue;
        const Record& r = state_.records[a.owner[i]];
        const Vector3d n(a.nx[i], a.ny[i], a.nz[i]);
        double deepest = 0;
        for (std::uint32_t j = 0; j < set.layers && i - set.begin < set.layer[j].count; ++j) {
            if (holds_below(set, set.layer[j], r, gap))
                deepest = std::max(deepest, a.s[i] - n.dot(set.layer[j].solution.dx));
        }
        gap.depth = a.s[i] > nowhere ? std::min(gap.depth, deepest) : 0;
        set.gaps = set.gaps || gap.depth > 0;
    }
}

}  // namespace knurl::detail
