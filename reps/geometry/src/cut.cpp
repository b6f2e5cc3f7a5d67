// Cuts faces where they meet, by the simplest steps there are: an edge is split at a vertex, a face is split
// at a vertex, an edge within a plane is turned. What is pierced gets a vertex there, in both; two faces that meet along a segment then
// have its ends as corners, and so the segment as an edge, or one more edge crosses it and is next. No face
// is triangulated anew, and the sum of all faces stays closed where it was.
//
// Points nearer than `touch` are one, in this order: vertex at vertex, vertex at edge, edge at edge, vertex at
// face, edge through face. So each test is decided by lengths far above what rounding moves.

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <set>
#include <unordered_map>

#include <Eigen/Geometry>

#include "unite.hpp"

namespace knurl::build {
namespace {

using Eigen::Vector3d;

struct Meeting {
    enum class Kind { none, vertices, vertex_edge, edges, vertex_face, edge_face } kind = Kind::none;
    std::uint32_t a = 0, b = 0, c = 0, d = 0;  // vertices: of the one, then of the other
    int whose = 0;                             // the face: of the one (0) or of the other
    Vector3d at = Vector3d::Zero();
};
using Kind = Meeting::Kind;

/// Edges that were split at a vertex: vertex, lower end, higher end. Of four points nearly on a line two pairs
/// of slivers may become each other for ever; what was split once stays as it is when it comes again.
using Splits = std::set<std::array<std::uint32_t, 3>>;
std::array<std::uint32_t, 3> split_of(std::uint32_t v, std::uint32_t a, std::uint32_t b) {
    return {v, std::min(a, b), std::max(a, b)};
}

bool has(const Triangle& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
}

Meeting vertex_on_edge(const Triangle& s, const Vector3d (&p)[3], const Triangle& t, const Vector3d (&q)[3],
                       double touch, const Splits& splits) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (has(t, s[i])) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t k2 = (k + 1) % 3;
            const Vector3d side = q[k2] - q[k], from = p[i] - q[k];
            const double length = side.squaredNorm(), along = side.dot(from);
            if (!(along > 0 && along < length)) continue;
            if ((from - side * (along / length)).squaredNorm() <= touch * touch &&
                !splits.contains(split_of(s[i], t[k], t[k2])))
                return {.kind = Kind::vertex_edge, .a = s[i], .b = t[k], .c = t[k2]};
        }
    }
    return {};
}
bool edges_meet(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d, double touch,
                Vector3d& x) {
    const Vector3d u = b - a, v = d - c, w = c - a;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
    const double sine = uu * vv - uv * uv;
    if (!(sine > 1e-14 * uu * vv)) return false;  // side by side: their ends tell
    const double i = (u.dot(w) * vv - v.dot(w) * uv) / sine, k = (u.dot(w) * uv - v.dot(w) * uu) / sine;
    if (!(i > 0 && i < 1 && k > 0 && k < 1)) return false;
    const Vector3d on = a + u * i, other = c + v * k;
    x = (on + other) / 2;
    return (on - other).squaredNorm() <= touch * touch;
}
bool within(const Vector3d& x, const Vector3d (&q)[3], const Vector3d& normal) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(normal.dot((q[(i + 1) % 3] - q[i]).cross(x - q[i])) > 0)) return false;
    }
    return true;
}
Meeting pierced(const Triangle& s, const Vector3d (&p)[3], const double (&height)[3], const Triangle& t,
                const Vector3d (&q)[3], const Vector3d& normal, int whose, double touch) {
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = (i + 1) % 3;
        if (has(t, s[i]) || has(t, s[k])) continue;
        const double low = std::min(height[i], height[k]), high = std::max(height[i], height[k]);
        if (!(low < -touch && high > touch)) continue;
        const Vector3d x = p[i] + (p[k] - p[i]) * (height[i] / (height[i] - height[k]));
        if (within(x, q, normal))
            return {.kind = Kind::edge_face, .a = s[i], .b = s[k], .whose = whose, .at = x};
    }
    return {};
}

/// How two pieces meet where they do not as corners and edges: the simplest way of all.
/// `s_flat` and `t_flat` say which of their edges are flat (a bit each): where the two lie in one plane those
/// may cross, since what is dropped there goes by outlines, and two triangulations of one plane would cut each
/// other without end.
Meeting meet(const Triangle& s, const Vector3d (&p)[3], std::uint32_t s_flat, const Triangle& t,
             const Vector3d (&q)[3], std::uint32_t t_flat, double touch, const Splits& splits) {
    const Vector3d p_normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized(),
                   q_normal = (q[1] - q[0]).cross(q[2] - q[0]).normalized();
    double p_height[3], q_height[3];
    for (int i = 0; i < 3; ++i) {
        p_height[i] = q_normal.dot(p[i] - q[0]);
        q_height[i] = p_normal.dot(q[i] - p[0]);
    }
    // Corners that stay two are farther apart than what makes them lie on an edge: so they are in order there.
    const double on = touch / 2;
    const auto clear = [touch](const double(&h)[3]) {
        return (h[0] > touch && h[1] > touch && h[2] > touch) ||
               (h[0] < -touch && h[1] < -touch && h[2] < -touch);
    };
    if (clear(p_height) || clear(q_height)) return {};
    const auto level = [touch](const double(&h)[3]) {
        return std::max({std::abs(h[0]), std::abs(h[1]), std::abs(h[2])}) <= 2 * touch;
    };
    const bool one_plane = level(p_height) || level(q_height);
    for (std::size_t i = 0; i < 3; ++i) {
        if (has(t, s[i])) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            if (!has(s, t[k]) && (p[i] - q[k]).squaredNorm() <= touch * touch / 16)
                return {.kind = Kind::vertices, .a = s[i], .b = t[k]};
        }
    }
    if (const Meeting m = vertex_on_edge(s, p, t, q, on, splits); m.kind != Kind::none) return m;
    if (const Meeting m = vertex_on_edge(t, q, s, p, on, splits); m.kind != Kind::none) return m;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i2 = (i + 1) % 3, k2 = (k + 1) % 3;
            if (s[i] == t[k] || s[i] == t[k2] || s[i2] == t[k] || s[i2] == t[k2]) continue;
            if (one_plane && (s_flat >> i & 1) != 0 && (t_flat >> k & 1) != 0) continue;
            Vector3d x;
            if (!edges_meet(p[i], p[i2], q[k], q[k2], on, x)) continue;
            return {.kind = Kind::edges, .a = s[i], .b = s[i2], .c = t[k], .d = t[k2], .at = x};
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (!has(t, s[i]) && std::abs(p_height[i]) <= on && within(p[i], q, q_normal))
            return {.kind = Kind::vertex_face, .a = s[i], .whose = 1};
        if (!has(s, t[i]) && std::abs(q_height[i]) <= on && within(q[i], p, p_normal))
            return {.kind = Kind::vertex_face, .a = t[i], .whose = 0};
    }
    if (const Meeting m = pierced(s, p, p_height, t, q, q_normal, 1, on); m.kind != Kind::none) return m;
    return pierced(t, q, q_height, s, p, p_normal, 0, on);
}

class Cutter {
  public:
    Cutter(Faces& faces, const Near& near, std::size_t most, Slices& slices)
        : faces_(faces), near_(near), most_(most), slices_(slices) {}

    bool run(const Pairs& pairs, std::vector<bool>& touched) {
        const std::size_t vertices = faces_.at.size();
        add_roots(pairs);
        if (queue_.empty()) return false;
        while (!queue_.empty()) {
            const std::uint32_t f = queue_.front();
            queue_.pop_front();
            queued_[f] = false;
            if (pieces_[f].there) settle(f);
            if (pieces_.size() > most_ || steps_ > 2 * most_) {
                faces_.at.resize(vertices);
                return false;
            }
        }
        for (const auto& [face, root] : root_of_) touched[face] = true;
        return steps_ > 0;
    }
    std::vector<Piece> take() { return std::move(pieces_); }
    std::uint64_t moved() const { return moved_; }

  private:
    /// Faces that meet others, and all around their corners, which are split with them but not asked.
    void add_roots(const Pairs& pairs) {
        std::vector<bool> meets(faces_.at.size());
        for (const auto& [f, g] : pairs) {
            for (const std::uint32_t v : faces_.corners[f]) meets[v] = true;
            for (const std::uint32_t v : faces_.corners[g]) meets[v] = true;
        }
        for (std::uint32_t f = 0; f < faces_.corners.size(); ++f, slices_()) {
            const Triangle& t = faces_.corners[f];
            if (!meets[t[0]] && !meets[t[1]] && !meets[t[2]]) continue;
            root_of_.emplace(f, static_cast<std::uint32_t>(pieces_of_.size()));
            partners_.emplace_back();
            pieces_of_.emplace_back();
            add({t, f, 0, false, true});
        }
        for (std::uint32_t p = 0; p < pieces_.size(); ++p, slices_()) pieces_[p].flat = flat_edges(p);
        for (const auto& [f, g] : pairs) {
            slices_();
            const std::uint32_t a = root_of_.at(f), b = root_of_.at(g);
            partners_[a].push_back(b);
            partners_[b].push_back(a);
            for (const std::uint32_t root : {a, b}) pieces_[pieces_of_[root].front()].meets = true;
        }
        for (const auto& [f, g] : pairs) {
            push(pieces_of_[root_of_.at(f)].front());
            push(pieces_of_[root_of_.at(g)].front());
        }
    }

    /// Over which another face goes on in the same plane.
    std::uint8_t flat_edges(std::uint32_t f) const {
        const Triangle& t = pieces_[f].corners;
        const Vector3d origin = at(t[0]), normal = (at(t[1]) - origin).cross(at(t[2]) - origin).normalized();
        std::uint8_t flat = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = t[i], b = t[(i + 1) % 3];
            std::uint32_t others = 0, third = 0;
            Vector3d other = Vector3d::Zero();
            for (const std::uint32_t g : around_.at(a)) {
                const Triangle& u = pieces_[g].corners;
                if (g == f || !has(u, b)) continue;
                ++others;
                third = u[0] != a && u[0] != b ? u[0] : u[1] != a && u[1] != b ? u[1] : u[2];
                other = (at(u[1]) - at(u[0])).cross(at(u[2]) - at(u[0])).normalized();
            }
            if (others == 1 && normal.dot(other) > 0.99 &&
                std::abs(normal.dot(at(third) - origin)) <= near_.touch / 4)
                flat |= static_cast<std::uint8_t>(1U << i);
        }
        return flat;
    }

    Vector3d at(std::uint32_t v) const { return Vector3d(faces_.at[v].data()); }

    void push(std::uint32_t piece) {
        if (queued_[piece]) return;
        queued_[piece] = true;
        queue_.push_back(piece);
    }
    void add(const Piece& piece) {
        const auto self = static_cast<std::uint32_t>(pieces_.size());
        pieces_.push_back(piece);
        queued_.push_back(false);
        Box box;
        for (const std::uint32_t v : piece.corners) {
            around_[v].push_back(self);
            box.add(at(v));
        }
        boxes_.push_back(box);
        pieces_of_[root_of_.at(piece.face)].push_back(self);
    }
    void drop(std::uint32_t piece) {
        pieces_[piece].there = false;
        auto& of = pieces_of_[root_of_.at(pieces_[piece].face)];
        of.erase(std::find(of.begin(), of.end(), piece));
        for (const std::uint32_t v : pieces_[piece].corners) {
            auto& around = around_[v];
            const auto it = std::find(around.begin(), around.end(), piece);
            if (it != around.end()) *it = around.back(), around.pop_back();
        }
    }

    /// Until f meets nothing, or is no more.
    void settle(std::uint32_t f) {
        if (slim(f)) return;
        const std::uint32_t root = root_of_.at(pieces_[f].face);
        for (std::size_t p = 0; p < partners_[root].size(); ++p) {
            const auto& others = pieces_of_[partners_[root][p]];
            for (std::size_t i = 0; i < others.size(); ++i) {
                const std::uint32_t g = others[i];
                slices_();
                if (!boxes_[f].meets(boxes_[g], near_.touch)) continue;
                slices_(4);
                const Triangle &a = pieces_[f].corners, &b = pieces_[g].corners;
                const Meeting m = meet(a, {at(a[0]), at(a[1]), at(a[2])}, pieces_[f].flat, b,
                                       {at(b[0]), at(b[1]), at(b[2])}, pieces_[g].flat, near_.touch, splits_);
                if (m.kind == Kind::none) continue;
                push(f), push(g);
                if (apply(m, m.whose == 0 ? f : g)) return;  // what is left of it is in the queue
            }
        }
    }

    /// One that is no wider than a point: its longest edge goes through its corner instead.
    bool slim(std::uint32_t f) {
        const Triangle t = pieces_[f].corners;
        std::size_t longest = 0;
        double most = -1;
        for (std::size_t i = 0; i < 3; ++i) {
            const double length = (at(t[(i + 1) % 3]) - at(t[i])).norm();
            if (length > most) most = length, longest = i;
        }
        const Vector3d a = at(t[longest]), side = at(t[(longest + 1) % 3]) - a;
        const double height = side.cross(at(t[(longest + 2) % 3]) - a).norm() / most;
        if (height > near_.touch / 4) return false;
        if (!splits_.insert(split_of(t[(longest + 2) % 3], t[longest], t[(longest + 1) % 3])).second)
            return false;
        split_edge(t[longest], t[(longest + 1) % 3], t[(longest + 2) % 3]);
        ++steps_;
        return true;
    }

    /// False: put off, since something else may do for it.
    bool apply(const Meeting& m, std::uint32_t face) {
        ++steps_;
        switch (m.kind) {
            case Kind::vertices:
                become(std::max(m.a, m.b), std::min(m.a, m.b));
                break;
            case Kind::vertex_edge:
                splits_.insert(split_of(m.a, m.b, m.c));
                split_edge(m.b, m.c, m.a);
                break;
            case Kind::edges: {
                const Turn first = turn(m.a, m.b), second = first == Turn::no ? turn(m.c, m.d) : Turn::no;
                if (first == Turn::done || second == Turn::done) break;
                if (first == Turn::later || second == Turn::later) return false;
                const std::uint32_t v = vertex(m.at);
                split_edge(m.a, m.b, v);
                split_edge(m.c, m.d, v);
                break;
            }
            case Kind::vertex_face:
                split_face(face, m.a);
                break;
            case Kind::edge_face: {
                const Turn turned = turn(m.a, m.b);
                if (turned == Turn::done) break;
                if (turned == Turn::later) return false;
                const std::uint32_t v = vertex(m.at);
                split_edge(m.a, m.b, v);
                split_face(face, v);
                break;
            }
            case Kind::none:
                break;
        }
        return true;
    }

    /// An edge between two pieces of one plane is nothing that must be there: instead of being split it becomes
    /// the other diagonal (Sloan 1993). Where it is not the diagonal of a convex quadrangle others around it
    /// are turned first. Vertices alone, put on it again and again, may come near a point for ever.
    enum class Turn { no, later, done };
    Turn turn(std::uint32_t a, std::uint32_t b) {
        std::uint32_t f = 0, g = 0, count = 0;
        for (const std::uint32_t p : around_[a]) {
            if (has(pieces_[p].corners, b)) (count++ == 0 ? f : g) = p;
        }
        if (count != 2) return Turn::no;
        std::size_t i = edge_of_piece(f, a, b), k = edge_of_piece(g, a, b);
        const Piece first = pieces_[f], second = pieces_[g];
        if (!first.meets || !second.meets || (first.flat >> i & 1) == 0 || (second.flat >> k & 1) == 0)
            return Turn::no;
        if (first.corners[i] == second.corners[k]) return Turn::no;  // wound against each other
        std::uint32_t& tries = turns_[split_of(0, a, b)];
        constexpr std::uint32_t enough = 16;
        if (++tries > enough) return Turn::no;
        // f is (p, q, c), g is (q, p, d); they become (p, d, c) and (d, q, c).
        const std::uint32_t p = first.corners[i], q = first.corners[(i + 1) % 3],
                            c = first.corners[(i + 2) % 3], d = second.corners[(k + 2) % 3];
        const Vector3d normal = (at(q) - at(p)).cross(at(c) - at(p)).normalized();
        if (std::abs(normal.dot(at(d) - at(p))) > near_.touch) return Turn::no;
        const Vector3d across = at(c) - at(d);
        const double length = across.norm(), thin = near_.touch * length;
        if (!(normal.dot(across.cross(at(p) - at(d))) > thin &&
              normal.dot(across.cross(at(q) - at(d))) < -thin))
            return Turn::later;
        const auto bit = [](const Piece& of, std::size_t edge) -> unsigned {
            return of.flat >> edge % 3 & 1U;
        };
        Piece one = first, other = second;
        one.corners = {p, d, c}, other.corners = {d, q, c};
        one.flat = static_cast<std::uint8_t>(bit(second, k + 1) | 1U << 1 | bit(first, i + 2) << 2);
        other.flat = static_cast<std::uint8_t>(bit(second, k + 2) | bit(first, i + 1) << 1 | 1U << 2);
        drop(f), drop(g);
        join(root_of_.at(first.face), root_of_.at(second.face));
        put(one), put(other);
        return Turn::done;
    }
    std::size_t edge_of_piece(std::uint32_t f, std::uint32_t a, std::uint32_t b) const {
        const Triangle& t = pieces_[f].corners;
        for (std::size_t i = 0; i < 3; ++i) {
            if ((t[i] == a && t[(i + 1) % 3] == b) || (t[i] == b && t[(i + 1) % 3] == a)) return i;
        }
        return 0;
    }
    /// Pieces of either may from now on lie in both.
    void join(std::uint32_t one, std::uint32_t other) {
        if (one == other) return;
        for (const auto& [to, from] : {std::pair(one, other), std::pair(other, one)}) {
            for (const std::uint32_t p : std::vector<std::uint32_t>(partners_[from])) {
                auto& mine = partners_[to];
                if (p == to || std::find(mine.begin(), mine.end(), p) != mine.end()) continue;
                mine.push_back(p);
                partners_[p].push_back(to);
            }
        }
    }
    std::uint32_t vertex(const Vector3d& p) {
        Point3 at{p.x(), p.y(), p.z()};
        if (near_.as_float) {
            for (double& x : at) x = static_cast<float>(x);
        }
        faces_.at.push_back(at);
        return static_cast<std::uint32_t>(faces_.at.size() - 1);
    }
    void become(std::uint32_t from, std::uint32_t to) {
        ++moved_;
        const std::vector<std::uint32_t> all = around_[from];
        for (const std::uint32_t f : all) {
            Piece piece = pieces_[f];
            drop(f);
            std::replace(piece.corners.begin(), piece.corners.end(), from, to);
            put(piece);
        }
    }
    void split_edge(std::uint32_t a, std::uint32_t b, std::uint32_t v) {
        const std::vector<std::uint32_t> all = around_[a];
        for (const std::uint32_t f : all) {
            const Piece piece = pieces_[f];
            if (!has(piece.corners, b)) continue;
            drop(f);
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t end = piece.corners[i], next = piece.corners[(i + 1) % 3];
                // What is left of the edge begins at v, or ends there; the edge across is new.
                if (end == a || end == b) put(with(piece, i, v, (next == a || next == b) ? (i + 2) % 3 : i));
            }
        }
    }
    void split_face(std::uint32_t f, std::uint32_t v) {
        const Piece piece = pieces_[f];
        if (!piece.there) return;
        drop(f);
        for (std::size_t i = 0; i < 3; ++i) {
            Piece third = with(piece, i, v, i);
            third.flat |= static_cast<std::uint8_t>(1U << (i + 2) % 3);
            put(third);
        }
    }
    /// With v as its corner i, and an edge that is flat.
    static Piece with(const Piece& piece, std::size_t i, std::uint32_t v, std::size_t flat) {
        Piece out = piece;
        out.there = true;
        out.corners[i] = v;
        out.flat |= static_cast<std::uint8_t>(1U << flat);
        return out;
    }
    void put(const Piece& piece) {
        const auto [a, b, c] = piece.corners;
        if (a == b || b == c || c == a) return;
        add(piece);
        if (piece.meets) push(static_cast<std::uint32_t>(pieces_.size() - 1));
    }

    struct Box {
        Vector3d low = Vector3d::Constant(HUGE_VAL), high = Vector3d::Constant(-HUGE_VAL);
        void add(const Vector3d& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
        bool meets(const Box& o, double more) const {
            return (low.array() <= o.high.array() + more).all() &&
                   (o.low.array() <= high.array() + more).all();
        }
    };

    Faces& faces_;
    const Near& near_;
    const std::size_t most_;
    Slices& slices_;
    std::vector<Piece> pieces_;
    std::vector<Box> boxes_;  // of the pieces
    std::vector<bool> queued_;
    std::deque<std::uint32_t> queue_;                               // the first first: none may wait for ever
    std::unordered_map<std::uint32_t, std::uint32_t> root_of_;      // of faces
    std::vector<std::vector<std::uint32_t>> partners_, pieces_of_;  // of roots
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> around_;  // pieces, of vertices
    Splits splits_;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> turns_;  // tries, of edges
    std::size_t steps_ = 0;
    std::uint64_t moved_ = 0;  // vertices that became another
};

}  // namespace

bool meet(const Faces& faces, std::uint32_t f, std::uint32_t g, bool across, double touch) {
    const auto at = [&](std::uint32_t v) { return Vector3d(faces.at[v].data()); };
    const Triangle &s = faces.corners[f], &t = faces.corners[g];
    const Meeting m =
        meet(s, {at(s[0]), at(s[1]), at(s[2])}, 0, t, {at(t[0]), at(t[1]), at(t[2])}, 0, touch, {});
    return across ? m.kind == Kind::edges || m.kind == Kind::edge_face : m.kind != Kind::none;
}

std::vector<Piece> cut(Faces& faces, const Pairs& pairs, const Near& near, std::size_t most,
                       std::vector<bool>& touched, MeshNotes& notes, Slices& slices) {
    Cutter cutter(faces, near, most, slices);
    if (!cutter.run(pairs, touched)) return {};
    notes.vertices_moved += cutter.moved();
    return cutter.take();
}

}  // namespace knurl::build
