#include "surface.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace exact {

namespace {

constexpr Real tiny = 1e-15L;  // share of an edge: a point this near to an end is that end
constexpr Real flat = 1e-12L;  // a sum of normals that is smaller cancels out

V least(const V& a, const V& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
V most(const V& a, const V& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// The nearest point as a share of the segment, between 0 and 1.
Real nearest_of(const V& a, const V& b, const V& p) {
    const V d = b - a;
    const Real t = dot(p - a, d) / dot(d, d);
    return std::clamp<Real>(t, 0, 1);
}

}  // namespace

Surface::Surface(std::span<const std::array<double, 3>> vertices,
                 std::span<const std::array<std::uint32_t, 3>> triangles) {
    for (const auto& v : vertices) vertex_.push_back(to_exact(v));
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto& t = triangles[i];
        const V across = cross(vertex_[t[1]] - vertex_[t[0]], vertex_[t[2]] - vertex_[t[0]]);
        if (!(length(across) > 0)) continue;
        face_.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
        normal_.push_back(unit(across));
        given_.push_back(static_cast<int>(i));
    }
    low_ = high_ = corner(0, 0);
    for (std::size_t f = 0; f < face_.size(); ++f) {
        for (int i = 0; i < 3; ++i) {
            low_ = least(low_, corner(static_cast<int>(f), i));
            high_ = most(high_, corner(static_cast<int>(f), i));
        }
    }
    size_ = distance(low_, high_);
    connect();
    fill_grid();
}

/// Sorts half edges by their two vertices, so that those of one edge are adjacent.
void Surface::connect() {
    struct Half {
        int from, to;  // the smaller vertex first
        int at;        // 3 face + edge
        bool turned;   // it goes from the larger to the smaller
    };
    std::vector<Half> halves;
    for (std::size_t f = 0; f < face_.size(); ++f) {
        for (int i = 0; i < 3; ++i) {
            const int a = face_[f][i], b = face_[f][(i + 1) % 3];
            halves.push_back({std::min(a, b), std::max(a, b), static_cast<int>(3 * f) + i, a > b});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
        return std::tie(a.from, a.to, a.at) < std::tie(b.from, b.to, b.at);
    });
    over_.assign(face_.size(), {-1, -1, -1});
    for (std::size_t first = 0; first < halves.size();) {
        std::size_t end = first + 1;
        while (end < halves.size() && halves[end].from == halves[first].from &&
               halves[end].to == halves[first].to) {
            ++end;
        }
        const V& a = vertex_[halves[first].from];
        const V axis = unit(vertex_[halves[first].to] - a);
        const auto away = [&](const Half& h) {  // from the edge, in its face
            const V& apex = corner(h.at / 3, (h.at % 3 + 2) % 3);
            return unit(flattened(apex - a, axis));
        };
        for (std::size_t i = first; i < end; ++i) {
            const V from = away(halves[i]);
            const V front = normal_[halves[i].at / 3];
            Real best = 7;
            for (std::size_t j = first; j < end; ++j) {
                if (halves[j].turned == halves[i].turned) continue;  // the walk would meet its back
                const V to = away(halves[j]);
                Real angle = std::atan2(dot(to, front), dot(to, from));
                // A face and its reverse are the two sides of a sheet: the angle between them is a full turn.
                if (angle < 0) angle += 2 * pi;
                if (angle < 1e-12L && dot(normal_[halves[j].at / 3], front) < 0) angle = 2 * pi;
                if (angle < best) best = angle, over_[halves[i].at / 3][halves[i].at % 3] = halves[j].at;
            }
            if (best > 6.9L) ++open_edges_;
        }
        first = end;
    }
}

std::vector<int> Surface::fan(int face, int corner) const {
    std::vector<int> faces{face};
    const int vertex = face_[face][corner];
    for (const bool ahead : {true, false}) {
        for (int f = face;;) {
            const int i =
                static_cast<int>(std::find(face_[f].begin(), face_[f].end(), vertex) - face_[f].begin());
            const int next = over_[f][ahead ? i : (i + 2) % 3];
            if (next < 0) break;
            f = next / 3;
            if (std::find(faces.begin(), faces.end(), f) != faces.end()) break;
            faces.push_back(f);
        }
    }
    return faces;
}

Nearest3 Surface::nearest(int face, const V& p) const {
    const V n = normal_[face];
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
        const V& a = corner(face, i);
        inside = inside && dot(cross(n, corner(face, (i + 1) % 3) - a), p - a) >= 0;
    }
    if (inside) return {p - dot(p - corner(face, 0), n) * n, -1, -1};
    Nearest3 best;
    Real shortest = std::numeric_limits<Real>::infinity();
    for (int i = 0; i < 3; ++i) {
        const V &a = corner(face, i), &b = corner(face, (i + 1) % 3);
        const Real t = nearest_of(a, b, p);
        const V at = t <= tiny ? a : t >= 1 - tiny ? b : a + t * (b - a);
        const Real d = distance(at, p);
        if (!(d < shortest)) continue;
        shortest = d;
        best.point = at;
        best.corner = t <= tiny ? i : t >= 1 - tiny ? (i + 1) % 3 : -1;
        best.edge = best.corner < 0 ? i : -1;
    }
    return best;
}

int Surface::nearest_face(const V& p) const {
    int best = -1;
    Real shortest = std::numeric_limits<Real>::infinity();
    for (int f = 0; f < static_cast<int>(face_.size()); ++f) {
        const Real d = distance(nearest(f, p).point, p);
        if (d < shortest) shortest = d, best = f;
    }
    return best;
}

V Surface::weighted(int face, const Nearest3& at) const {
    if (at.edge >= 0) {
        const int other = over_[face][at.edge];
        return other < 0 ? normal_[face] : normal_[face] + normal_[other / 3];
    }
    if (at.corner < 0) return normal_[face];
    const int vertex = face_[face][at.corner];
    V sum;
    for (const int f : fan(face, at.corner)) {
        const int i =
            static_cast<int>(std::find(face_[f].begin(), face_[f].end(), vertex) - face_[f].begin());
        const V u = corner(f, (i + 1) % 3) - corner(f, i), v = corner(f, (i + 2) % 3) - corner(f, i);
        sum += std::atan2(length(cross(u, v)), dot(u, v)) * normal_[f];
    }
    return sum;
}

V Surface::pseudonormal(int face, const Nearest3& at) const {
    const V sum = weighted(face, at);
    return length(sum) > flat ? unit(sum) : normal_[face];
}

bool Surface::rim(int face, const Nearest3& at) const {
    if (at.edge >= 0 && over_[face][at.edge] < 0) return true;
    if (at.corner >= 0) {
        const int vertex = face_[face][at.corner];
        for (const int f : fan(face, at.corner)) {
            for (int i = 0; i < 3; ++i) {
                const bool of_it = face_[f][i] == vertex || face_[f][(i + 1) % 3] == vertex;
                if (of_it && over_[f][i] < 0) return true;
            }
        }
    }
    return !(length(weighted(face, at)) > flat);
}

Real Surface::winding(const V& p) const {
    double sum = 0;  // double is enough for an integer (Van Oosterom and Strackee 1983)
    for (int f = 0; f < static_cast<int>(face_.size()); ++f) {
        const V a = corner(f, 0) - p, b = corner(f, 1) - p, c = corner(f, 2) - p;
        const Real la = length(a), lb = length(b), lc = length(c);
        const Real over = dot(a, cross(b, c));
        const Real under = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        sum += std::atan2(static_cast<double>(over), static_cast<double>(under));
    }
    return static_cast<Real>(sum) / (2 * pi);
}

}  // namespace exact
