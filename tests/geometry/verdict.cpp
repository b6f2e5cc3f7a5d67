#include "verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace knurl::test {

using exact::distance;
using exact::Real;
using exact::V;

namespace {

/// As a share of the size: a place nearer to a rim than this may be taken for a seam that was not welded (4
/// um at 0.2 m).
constexpr Real rim = 2e-5L;

V to_v(const Eigen::Vector3d& p) {
    return {p.x(), p.y(), p.z()};
}

Real tilted(const exact::Surface& truth, const V& at, Real depth, const Allowed& allowed) {
    const int f = truth.nearest_face_near(at);
    Real longest = 0;
    for (int i = 0; i < 3; ++i)
        longest = std::max(longest, distance(truth.corner(f, i), truth.corner(f, (i + 1) % 3)));
    const V across = cross(truth.corner(f, 1) - truth.corner(f, 0), truth.corner(f, 2) - truth.corner(f, 0));
    return allowed.same + depth * allowed.rounding * longest / length(across);
}

std::string where(std::size_t cycle, const Hand& hand, const char* what, const V& is, const V& should) {
    std::ostringstream text;
    text.precision(17);
    const auto point = [&](const V& p) {
        text << static_cast<double>(p.x) << ' ' << static_cast<double>(p.y) << ' '
             << static_cast<double>(p.z);
    };
    text << "cycle " << cycle << ": " << what << "; hand ";
    point(exact::to_exact(hand[cycle]));
    text << ", before ";
    point(exact::to_exact(hand[cycle > 0 ? cycle - 1 : 0]));
    text << ", is ";
    point(is);
    text << ", should be ";
    point(should);
    text << ", apart " << static_cast<double>(distance(is, should)) << " m";
    return text.str();
}

}  // namespace

double Verdict::error_at(double share) {
    if (errors.empty()) return 0;
    const auto at =
        errors.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), at, errors.end());
    return *at;
}

void Verdict::add(const Verdict& v) {
    cycles += v.cycles, touching += v.touching, reference_touching += v.reference_touching;
    other_place += v.other_place, border += v.border, capped += v.capped, wrong += v.wrong, lost += v.lost;
    not_finite += v.not_finite, over_work += v.over_work, misfit += v.misfit;
    jumps += v.jumps, reference_jumps += v.reference_jumps;
    errors.insert(errors.end(), v.errors.begin(), v.errors.end());
    worst_gain = std::max(worst_gain, v.worst_gain);
    most.faces = std::max(most.faces, v.most.faces), most.nodes = std::max(most.nodes, v.most.nodes);
    most.pieces = std::max(most.pieces, v.most.pieces), most.sweeps = std::max(most.sweeps, v.most.sweeps);
    most.guards = std::max(most.guards, v.most.guards), most.fans = std::max(most.fans, v.most.fans);
    most.tangles = std::max(most.tangles, v.most.tangles);
    if (first_wrong.empty()) first_wrong = v.first_wrong;
}

std::ostream& operator<<(std::ostream& out, Verdict v) {
    out << v.cycles << " cycles, " << v.touching << " touching (reference " << v.reference_touching
        << "), error " << v.error_at(0.5) << " / " << v.error_at(0.99) << " / " << v.error_at(1)
        << " m, wrong " << v.wrong << ", lost " << v.lost << ", other place " << v.other_place << ", border "
        << v.border << ", capped " << v.capped << ", jumps " << v.jumps << " (" << v.reference_jumps
        << "), gain " << v.worst_gain << " m, not finite " << v.not_finite << ", misfit " << v.misfit
        << ", over work " << v.over_work << ", most faces " << v.most.faces << " nodes " << v.most.nodes
        << " pieces " << v.most.pieces << " sweeps " << v.most.sweeps << " fans " << v.most.fans << " guards "
        << v.most.guards << " tangles " << v.most.tangles;
    if (!v.first_wrong.empty()) out << "\n    " << v.first_wrong;
    return out;
}

Allowed allowed_of(const exact::Surface& surface, bool exact, bool crossed) {
    const Real far = std::max(length(surface.low()), length(surface.high()));
    const double size = static_cast<double>(surface.size());
    // The rounding of a place at that distance from the origin, which is a double.
    const double place = 0x1p-51 * static_cast<double>(far);
    return {.same = (crossed ? 1e-6
                     : exact ? 5e-11
                             : 5e-7) *
                        size +
                    place,
            .rounding = exact ? 0 : 6e-8 * size};
}

Verdict judge(const Mesh& mesh, const exact::Surface& truth, const Hand& hand, const Allowed& allowed) {
    Verdict v;
    Proxy proxy;
    exact::GodObject god(truth);
    const Real deep = truth.size() / 1000, jump = truth.size() / 200;
    V offset, reference_offset, before;
    // Walk and reference both let out a hand that begins inside, so it is not judged.
    if (truth.nearly_closed() && truth.winding(exact::to_exact(hand[0])) > 0.5L) return v;
    for (std::size_t i = 0; i < hand.size(); ++i) {
        const V h = exact::to_exact(hand[i]);
        Foot foot;
        Work work;
        const bool touches = follow(mesh, proxy, {hand[i][0], hand[i][1], hand[i][2]}, 0, foot, work);
        const bool should = god.step(h);
        const V at = touches ? to_v(foot.point) : h, right = god.at();
        ++v.cycles, v.touching += touches, v.reference_touching += should;
        v.over_work += !within_limits(work);
        Verdict most;
        most.most = work;
        v.add(most);
        if (!finite(at) || !foot.normal.allFinite() || !std::isfinite(foot.depth)) {
            ++v.not_finite;
            god.let_go(h);
            continue;
        }
        const auto blame = [&](std::uint64_t& count, const char* what) {
            ++count;
            if (v.first_wrong.empty()) v.first_wrong = where(i, hand, what, at, right);
        };
        if (touches &&
            !(foot.depth == 0 && work.faces >= max_walk_faces)) {  // not there yet, and without force
            const V back = at - h;
            const bool fits = std::fabs(foot.normal.norm() - 1) < 1e-9 && foot.depth >= 0 &&
                              distance(back, foot.depth * to_v(foot.normal)) < allowed.same;
            if (!fits) blame(v.misfit, "normal and depth do not lead to the point");
        }
        if (i > 0) {
            const Real step = distance(h, before);
            v.jumps += distance(at - h, offset) > jump + step;
            v.reference_jumps += distance(right - h, reference_offset) > jump + step;
        }
        offset = at - h, before = h;
        // Where several parts touch, the face that the walk names; a spoiled mesh has other triangle numbers.
        const auto face_at = [&](const V& p, const Foot& its) {
            const int said = truth.face_of(static_cast<int>(its.triangle));
            const bool there = said >= 0 && distance(truth.nearest(said, p).point, p) <= allowed.same;
            return there ? said : truth.nearest_face_near(p);
        };
        const Real apart = distance(at, right);
        const auto one_place = [&](const V& other) {
            const Real far = distance(other, at);
            return far <= allowed.same ||
                   (allowed.rounding > 0 && touches && far <= tilted(truth, at, distance(at, h), allowed));
        };
        if (one_place(right)) {
            if (touches && should) v.errors.push_back(static_cast<double>(apart));
            if (touches != should) {  // by rounding; the reference goes on from the walk's state
                ++v.border;
                if (touches) god.put(right, face_at(right, foot));
                if (!touches) god.let_go(h);
            }
        } else if (work.faces >= max_walk_faces) {
            ++v.capped;
        } else if (touches && truth.near_rim(at, rim * truth.size())) {
            ++v.border;
            god.put(at, face_at(at, foot));
        } else if (!touches) {
            const bool inside = !truth.nearly_closed() || truth.winding(h) > 0.5L;
            const int face = truth.nearest_face_near(h);
            const bool far_inside = distance(truth.nearest(face, h).point, h) > deep;
            if (inside && far_inside) blame(v.lost, "lost");
            if (inside)
                blame(v.wrong, "does not touch");
            else
                ++v.other_place;
            god.let_go(h);
        } else {
            const int face = face_at(at, foot);
            const exact::Nearest3 on = truth.nearest(face, at);
            exact::GodObject there(truth);  // where a god-object from that place comes to rest
            there.put(on.point, face);
            const Real gain =
                there.step(h) ? truth.gain(there.at(), h, 1e-13L * truth.size(), there.face()) : INFINITY;
            if (one_place(there.at()) && gain <= 1e-16L * truth.size()) {
                ++v.other_place;
                v.worst_gain = std::max(v.worst_gain, static_cast<double>(gain));
            } else {
                blame(v.wrong,
                      distance(on.point, at) <= allowed.same ? "another face is nearer" : "off the surface");
            }
            god.put(on.point, face);
        }
        reference_offset = god.at() - h;
    }
    return v;
}

Verdict judge_all(const Mesh& mesh, const exact::Surface& truth, const MadeMesh& shape,
                  const Allowed& allowed, std::uint64_t seed, int times) {
    Verdict all;
    Hands hands(shape, seed);
    for (int i = 0; i < times; ++i) {
        for (const Hand& hand : {hands.stroke(), hands.poke(), hands.stroke(), hands.graze(),
                                 hands.around_an_edge(), hands.into_a_corner(), hands.hover()}) {
            all.add(judge(mesh, truth, hand, allowed));
        }
    }
    return all;
}

std::uint64_t seed() {
    const char* text = std::getenv("KNURL_SEED");
    return text != nullptr ? std::strtoull(text, nullptr, 0) : 1;
}
bool long_form() {
    const char* text = std::getenv("KNURL_STROKES");
    return text != nullptr && std::string(text) == "long";
}

}  // namespace knurl::test
