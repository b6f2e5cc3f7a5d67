#include "contact.hpp"

#include <limits>

namespace exact {

namespace {

// dx = sum u_i n_i with n_i . dx = s_i for the planes of one subset, by orthogonalising. `width` is the part
// of each normal that is perpendicular to the others: the factor by which a weight affects dx.
struct Subset {
    bool independent = false;
    V dx;
    Real weight[3] = {}, width[3] = {1, 1, 1};
};

Subset hold(const V& n, Real s) {
    Subset out;
    out.independent = true;
    out.dx = s * n;
    out.weight[0] = s;
    return out;
}

Subset hold(const V& a, Real sa, const V& b, Real sb) {
    Subset out;
    // Subtract before multiplying: b - a is exact where a and b are almost parallel.
    const V d = b - a;
    const V e = b + a;
    const bool alike = dot(a, b) > 0;
    const V w = alike ? d - dot(a, d) * a : e - dot(a, e) * a;
    const Real ww = dot(w, w);
    if (!(ww > 1e-36L)) return out;
    const Real gap = alike ? (sb - sa) - sa * dot(a, d) : (sb + sa) - sa * dot(a, e);
    out.independent = true;
    out.weight[1] = gap / ww;
    out.dx = sa * a + out.weight[1] * w;
    out.weight[0] = sa - out.weight[1] * dot(a, b);
    out.width[0] = out.width[1] = std::sqrt(ww);
    return out;
}

Subset hold(const V& a, Real sa, const V& b, Real sb, const V& c, Real sc) {
    Subset out;
    const V bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
    const Real det = dot(a, bc);
    const Real largest_face = std::max({length(bc), length(ca), length(ab)});
    if (!(std::fabs(det) > 1e-17L * largest_face) || largest_face < 1e-17L) return out;
    out.independent = true;
    out.dx = (1 / det) * (sa * bc + sb * ca + sc * ab);
    // One step of refinement.
    const Real ra = sa - dot(a, out.dx), rb = sb - dot(b, out.dx), rc = sc - dot(c, out.dx);
    out.dx += (1 / det) * (ra * bc + rb * ca + rc * ab);
    const V faces[3] = {bc, ca, ab};
    for (int i = 0; i < 3; ++i) {
        out.weight[i] = dot(out.dx, faces[i]) / det;
        out.width[i] = std::fabs(det) / std::max(length(faces[i]), Real(1e-30L));
    }
    return out;
}

struct Candidate {
    Real residual;
    V dx;
    Holding holding;
};

Real sharpness_of(std::span<const Touch> planes, const std::vector<int>& meeting) {
    Real sharpest = 1;
    for (std::size_t i = 0; i < meeting.size(); ++i) {
        for (std::size_t j = i + 1; j < meeting.size(); ++j) {
            const V& a = planes[static_cast<std::size_t>(meeting[i])].normal;
            const V& b = planes[static_cast<std::size_t>(meeting[j])].normal;
            const Real sine = length(cross(a, b));
            if (sine > 0) sharpest = std::min(sharpest, sine);
            for (std::size_t k = j + 1; k < meeting.size(); ++k) {
                const V& c = planes[static_cast<std::size_t>(meeting[k])].normal;
                const Real faces = std::max({length(cross(a, b)), length(cross(b, c)), length(cross(c, a))});
                const Real width = faces > 0 ? std::fabs(dot(cross(a, b), c)) / faces : 0;
                if (width > 0) sharpest = std::min(sharpest, width);
            }
        }
    }
    return sharpest;
}

}  // namespace

Real smallest_give(std::span<const Touch> planes) {
    // min over x of the worst violation = max of sum w s over weights w >= 0 with sum w n = 0, sum w = 1.
    Real give = -std::numeric_limits<Real>::infinity();
    const std::size_t n = planes.size();
    const auto take = [&](std::initializer_list<std::size_t> index, std::initializer_list<Real> weight) {
        Real sum = 0, with = 0, smallest = 1, most = 0;
        for (const Real w : weight) sum += w, most = std::max(most, std::fabs(w));
        if (!(most > 1e-13L)) return;
        auto i = index.begin();
        for (const Real w : weight) {
            smallest = std::min(smallest, w / sum);
            with += w / sum * -planes[*i++].height;
        }
        if (smallest >= -1e-17L) give = std::max(give, with);
    };
    for (std::size_t i = 0; i < n; ++i) {
        const V& a = planes[i].normal;
        for (std::size_t j = i + 1; j < n; ++j) {
            const V& b = planes[j].normal;
            const V ab = cross(a, b);
            if (length(a + b) < 1e-17L) take({i, j}, {1, 1});
            for (std::size_t k = j + 1; k < n; ++k) {
                const V& c = planes[k].normal;
                const V bc = cross(b, c), ca = cross(c, a);
                const Real det = dot(ab, c);
                if (std::fabs(det) < 1e-18L) {
                    const V m = length(ab) > 1e-3L ? unit(ab) : (length(bc) > 1e-3L ? unit(bc) : V{});
                    if (length(m) > 0) take({i, j, k}, {dot(bc, m), dot(ca, m), dot(ab, m)});
                }
                for (std::size_t l = k + 1; l < n; ++l) {
                    const V& d = planes[l].normal;
                    take({i, j, k, l}, {dot(bc, d), -dot(cross(a, c), d), dot(ab, d), -det});
                }
            }
        }
    }
    return give;
}

Nearest nearest_free(std::span<const Touch> planes, Real rounding) {
    Nearest out;
    const std::size_t n = planes.size();
    std::vector<Real> s(n);
    Real worst = 0, size = 0;
    for (std::size_t i = 0; i < n; ++i) {
        s[i] = -planes[i].height;
        worst = std::max(worst, s[i]);
    }
    if (!(worst > -rounding)) return out;
    if (!(worst > 0)) {
        for (std::size_t i = 0; i < n; ++i) {  // out of touch by rounding only: any of these may hold
            if (s[i] > -rounding) out.holdings.push_back({{static_cast<int>(i)}, {1}});
        }
        return out;
    }
    const Real give = smallest_give(planes);
    if (give > 0) {
        out.give = give;
        for (Real& si : s) si -= give;
    }
    for (const Real si : s) size = std::max(size, si);
    if (!(size > 0)) {
        return out;
    }
    std::vector<Candidate> candidates;
    const auto consider = [&](const Subset& subset, std::initializer_list<std::size_t> index) {
        if (!subset.independent) return;
        Real residual = 0;
        int at = 0;
        Holding holding;
        for (const std::size_t i : index) {
            residual = std::max(residual, -subset.weight[at] * std::min(Real(1), subset.width[at]));
            residual = std::max(residual, std::fabs(s[i] - dot(planes[i].normal, subset.dx)));
            holding.plane.push_back(static_cast<int>(i));
            holding.weight.push_back(subset.weight[at++]);
        }
        for (std::size_t i = 0; i < n; ++i)
            residual = std::max(residual, s[i] - dot(planes[i].normal, subset.dx));
        if (finite(subset.dx)) candidates.push_back({residual, subset.dx, holding});
    };
    for (std::size_t i = 0; i < n; ++i) {
        if (s[i] > 0) consider(hold(planes[i].normal, s[i]), {i});
        for (std::size_t j = i + 1; j < n; ++j) {
            consider(hold(planes[i].normal, s[i], planes[j].normal, s[j]), {i, j});
            for (std::size_t k = j + 1; k < n; ++k) {
                consider(hold(planes[i].normal, s[i], planes[j].normal, s[j], planes[k].normal, s[k]),
                         {i, j, k});
            }
        }
    }
    if (candidates.empty()) return out;
    const auto best = std::min_element(candidates.begin(), candidates.end(),
                                       [](const auto& a, const auto& b) { return a.residual < b.residual; });
    out.dx = best->dx;
    out.residual = best->residual;
    const Real reach = std::max(size, length(out.dx));
    for (const Candidate& c : candidates) {
        if (c.residual <= best->residual + 1e-15L * reach + rounding) out.holdings.push_back(c.holding);
    }
    std::vector<int> meeting;
    for (std::size_t i = 0; i < n; ++i) {
        if (std::fabs(s[i] - dot(planes[i].normal, out.dx)) <= 1e-13L * reach + rounding)
            meeting.push_back(static_cast<int>(i));
    }
    out.sharpness = sharpness_of(planes, meeting);
    return out;
}

Push push(std::span<const Touch> touches, const V& velocity, Real rounding) {
    Push out;
    std::vector<Real> layers;
    for (const Touch& t : touches) {
        if (t.stiffness > 0) layers.push_back(t.stiffness);
    }
    std::sort(layers.begin(), layers.end());
    layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
    std::vector<std::vector<Touch>> planes;
    std::vector<Nearest> nearest;
    Real below = 0;
    for (const Real k : layers) {
        std::vector<Touch> layer;
        for (const Touch& t : touches) {
            if (t.stiffness >= k) layer.push_back(t);
        }
        planes.push_back(layer);
        nearest.push_back(nearest_free(layer, rounding));
        const Nearest& x = nearest.back();
        out.force += (k - below) * x.dx;
        below = k;
        out.give = std::max(out.give, x.give);
        out.sharpness = std::min(out.sharpness, x.sharpness);
    }
    out.stiffness = below;
    if (!nearest.empty()) out.dx = nearest.front().dx;
    const Real undamped = length(out.force);
    out.undamped = out.least = out.most = undamped;
    if (!(undamped > 0)) return out;

    // The planes that hold in the stiffest touched layer determine the damping.
    const V m = unit(out.force);
    bool first = true;
    for (std::size_t j = layers.size(); j-- > 0;) {
        for (const Holding& h : nearest[j].holdings) {
            Real sum = 0, b = 0;
            V v;
            for (std::size_t i = 0; i < h.plane.size(); ++i) {
                const Touch& t = planes[j][static_cast<std::size_t>(h.plane[i])];
                const Real u = std::max(Real(0), h.weight[i]);
                sum += u, b += u * t.damping, v += u * t.velocity;
            }
            if (!(sum > 0)) continue;
            const Real damped = std::max(Real(0), undamped - b / sum * dot(m, velocity - (1 / sum) * v));
            out.least = first ? damped : std::min(out.least, damped);
            out.most = first ? damped : std::max(out.most, damped);
            first = false;
        }
        if (length(nearest[j].dx) > rounding) break;  // touched beyond rounding
    }
    out.force = (out.least + out.most) / 2 * m;
    return out;
}

V summed(std::span<const Touch> touches, const V& velocity) {
    V force;
    for (const Touch& t : touches) {
        const Real depth = -t.height;
        if (!(depth > 0)) continue;
        const Real f = t.stiffness * depth - t.damping * dot(velocity - t.velocity, t.normal);
        force += std::max(Real(0), f) * t.normal;
    }
    return force;
}

}  // namespace exact
