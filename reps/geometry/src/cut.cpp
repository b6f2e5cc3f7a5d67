// Cuts faces where they meet, in the simplest steps: split an edge at a vertex, split a face at a vertex,
// turn an edge within a plane. A pierced face gets a vertex there, and so does the piercing edge. Two faces
// that meet along a segment then have its ends as corners. So the segment is an edge, or an edge crosses it,
// which is the next step. No face is triangulated anew, and the sum of all faces stays closed where it was.

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <unordered_map>

#include <Eigen/Geometry>

#include "meeting.hpp"
#include "unite.hpp"

namespace knurl::build {
namespace {

using Eigen::Vector3d;

using Kind = Meeting::Kind;

class Cutter {
  public:
    Cutter(Faces& faces, const Near& near, std::size_t most, Slices& slices)
        : faces_(faces), near_(near), most_(most), slices_(slices) {}

    /// False: it takes too much.
    bool run(const Pairs& pairs, std::vector<bool>& touched) {
        const std::size_t vertices = faces_.at.size();
        add_roots(pairs);
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
        if (steps_ == 0) {
            pieces_.clear();
            return true;
        }
        for (const auto& [face, root] : root_of_) touched[face] = true;
        return true;
    }
    std::vector<Piece> take() { return std::move(pieces_); }
    std::uint64_t moved() const { return moved_; }

  private:
    /// Adds the faces that meet others, and the faces around their corners, which are only split with them.
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

    /// The edges over which another face continues in the same plane.
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

    /// Splits f until it meets nothing, or no longer exists.
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
                if (apply(m, m.whose == 0 ? f : g)) return;  // the remaining pieces are in the queue
            }
        }
    }

    /// A face no wider than a point: its longest edge is split at the opposite corner.
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

    /// False: put off, since another step may settle it.
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

    /// An edge between two pieces of one plane is not needed there. Instead of being split it becomes the
    /// other diagonal (Sloan 1993). Where the quadrangle is not convex, other edges around it are turned
    /// first. Splits alone might approach a point for ever.
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
        if (first.corners[i] == second.corners[k]) return Turn::no;  // the windings contradict each other
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
    /// From now on, pieces of either face may lie in both.
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
                // The rest of the edge begins or ends at v; the opposite edge is new.
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
    /// The piece with v as its corner i, and one flat edge.
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
    std::deque<std::uint32_t> queue_;                               // first in, first out, so that no face
                                                                    // waits for ever
    std::unordered_map<std::uint32_t, std::uint32_t> root_of_;      // of faces
    std::vector<std::vector<std::uint32_t>> partners_, pieces_of_;  // of roots
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> around_;  // pieces, of vertices
    Splits splits_;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> turns_;  // attempts, of edges
    std::size_t steps_ = 0;
    std::uint64_t moved_ = 0;  // vertices that were merged into another one
};

}  // namespace

std::optional<std::vector<Piece>> cut(Faces& faces, const Pairs& pairs, const Near& near, std::size_t most,
                                      std::vector<bool>& touched, MeshNotes& notes, Slices& slices) {
    Cutter cutter(faces, near, most, slices);
    if (!cutter.run(pairs, touched)) return std::nullopt;
    notes.vertices_moved += cutter.moved();
    return cutter.take();
}

}  // namespace knurl::build
