// Checks everything that was built, in long double and with maps, which is slow but simple.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include <knurl/geometry/proxy.hpp>

#include "mesh_data.hpp"
#include "raw_mesh.hpp"

namespace knurl::test {
namespace {

constexpr int deepest = 22;  // levels of nodes

struct AnyFace {
    Point3 corner[3];
    Link over[3];
    std::uint32_t triangle;
    std::uint8_t material, flags;
};

template <class F>
std::vector<AnyFace> any(std::span<F> faces) {
    std::vector<AnyFace> out;
    for (const F& f : faces) {
        AnyFace a{{}, {f.over[0], f.over[1], f.over[2]}, f.triangle, f.material, f.flags};
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 3; ++k) a.corner[c][k] = f.corner[c][k];
        out.push_back(a);
    }
    return out;
}

std::vector<AnyFace> all_faces(const Mesh& mesh) {
    return mesh.data().exact ? any(mesh.data().exact_faces) : any(mesh.data().faces);
}

class Check {
  public:
    Check(const Mesh& mesh, const RawMesh& raw, const MeshBuild& how)
        : mesh_(mesh), data_(mesh.data()), raw_(raw), how_(how), faces_(all_faces(mesh)) {}

    std::string run() {
        counts();
        origins();
        links();
        fans();
        rims();
        tree();
        return said_.str();
    }

  private:
    template <class... What>
    void say(const What&... what) {
        if (++times_ <= 5) ((said_ << what), ...), said_ << "\n";
    }

    void counts() {
        const MeshNotes& n = mesh_.notes();
        if (n.triangles_given != raw_.triangles.size()) say("triangles_given ", n.triangles_given);
        if (n.faces_dropped + n.faces_degenerate + n.faces_duplicate + n.faces_inside + faces_.size() !=
            n.triangles_given + n.faces_added)
            say("the notes do not account for all triangles");
        if (mesh_.faces() != faces_.size() || data_.faces.empty() == data_.exact_faces.empty())
            say("faces()");
        std::uint64_t crossed = 0;
        bool open = false;
        for (const AnyFace& f : faces_) {
            crossed += (f.flags & face_crossed) != 0;
            open = open || std::count(f.over, f.over + 3, no_link) > 0;
        }
        if (crossed != n.faces_crossed) say("faces_crossed ", n.faces_crossed, " but flags ", crossed);
        if (open != data_.open) say("open");
    }

    /// Each face is at its triangle, within the distance that welding and rounding allow.
    void origins() {
        std::set<std::uint32_t> seen;
        long double largest = 0;
        for (const Point3& p : raw_.vertices)
            for (const double x : p)
                if (std::abs(x) < 1e7) largest = std::max<long double>(largest, std::abs(x));
        const long double may = 1.01L * how_.weld * data_.size +
                                (data_.exact ? 0 : std::ldexp(data_.size, -24)) + largest * 0x1p-51L;
        const MeshNotes& n = mesh_.notes();
        if (n.faces_cut + n.faces_inside + n.vertices_moved > 0)
            return pieces(may + 2 * how_.gap * data_.size);
        for (const AnyFace& f : faces_) {
            if (f.triangle >= raw_.triangles.size() || !seen.insert(f.triangle).second) {
                say("triangle ", f.triangle, " twice or from nowhere");
                continue;
            }
            const Triangle& t = raw_.triangles[f.triangle];
            const auto off = [&](std::size_t a, std::size_t b, std::size_t c) {
                long double most = 0;
                const std::size_t order[3] = {a, b, c};
                for (std::size_t i = 0; i < 3; ++i)
                    for (std::size_t k = 0; k < 3; ++k)
                        most = std::max(most, std::abs(static_cast<long double>(f.corner[i][k]) +
                                                       data_.origin[static_cast<int>(k)] -
                                                       raw_.vertices[t[order[i]]][k]));
                return most;
            };
            const long double as_given = off(0, 1, 2), turned = off(0, 2, 1);
            if (!(std::min(as_given, turned) <= may))
                say("triangle ", f.triangle, " is elsewhere, by ", as_given);
            if (mesh_.notes().faces_turned == 0 && !(as_given <= may))
                say("triangle ", f.triangle, " turned");
            const std::uint8_t material = raw_.materials.empty() ? 0 : raw_.materials[f.triangle];
            if (f.material != material) say("material of triangle ", f.triangle);
        }
    }

    /// Where faces are cut, each piece lies wholly on the given surface, and names a triangle of its
    /// material. A piece with a swapped edge (cut.cpp) lies on two of them.
    void pieces(long double may) {
        for (const AnyFace& f : faces_) {
            if (f.triangle >= raw_.triangles.size()) {
                say("triangle ", f.triangle, " is from nowhere");
                continue;
            }
            if (f.material != (raw_.materials.empty() ? 0 : raw_.materials[f.triangle]))
                say("material of triangle ", f.triangle);
            for (int i = 0; i <= 3; ++i) {
                Real3 p{};
                for (std::size_t k = 0; k < 3; ++k) {
                    for (int c = 0; c < 3; ++c)
                        p[k] += (i == 3 ? 1.0L / 3 : i == c ? 1.0L : 0.0L) * f.corner[c][k];
                    p[k] += data_.origin[static_cast<int>(k)];
                }
                long double least = HUGE_VALL;
                for (const Triangle& t : raw_.triangles) {
                    bool finite = true;
                    for (const std::uint32_t v : t)
                        for (const double x : raw_.vertices[v]) finite = finite && std::abs(x) < 1e7;
                    if (finite) least = std::min(least, distance(p, t));
                }
                if (!(least <= may))
                    say("a piece of triangle ", f.triangle, " is off the surface by ", double(least));
            }
        }
    }
    using Real3 = std::array<long double, 3>;
    static long double dot(const Real3& a, const Real3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Real3 minus(const Real3& a, const Real3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    static Real3 cross(const Real3& a, const Real3& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    long double distance(const Real3& p, const Triangle& t) const {
        Real3 q[3];
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 3; ++k) q[c][k] = raw_.vertices[t[c]][k];
        const Real3 normal = cross(minus(q[1], q[0]), minus(q[2], q[0]));
        const long double length = std::sqrt(dot(normal, normal));
        bool over = length > 0;
        long double least = HUGE_VALL;
        for (std::size_t c = 0; c < 3; ++c) {
            const Real3 side = minus(q[(c + 1) % 3], q[c]), from = minus(p, q[c]);
            over = over && dot(normal, cross(side, from)) >= 0;
            const long double square = dot(side, side);
            const long double along = square > 0 ? std::clamp(dot(side, from) / square, 0.0L, 1.0L) : 0;
            Real3 off = from;
            for (std::size_t k = 0; k < 3; ++k) off[k] -= along * side[k];
            least = std::min(least, std::sqrt(dot(off, off)));
        }
        return over ? std::min(least, std::abs(dot(normal, minus(p, q[0]))) / length) : least;
    }

    void links() {
        for (std::uint32_t f = 0; f < faces_.size(); ++f) {
            for (std::uint32_t e = 0; e < 3; ++e) {
                const Link over = faces_[f].over[e];
                if (over == no_link) continue;
                const std::uint32_t g = face_of(over), i = edge_of(over);
                if (g >= faces_.size() || i > 2 || g == f) {
                    say("link of face ", f, " leads nowhere");
                } else if (faces_[g].over[i] != link_to(f, e)) {
                    say("link of face ", f, " does not lead back");
                } else if (faces_[f].corner[e] != faces_[g].corner[(i + 1) % 3] ||
                           faces_[f].corner[(e + 1) % 3] != faces_[g].corner[i]) {
                    say("faces ", f, " and ", g, " do not share their edge, or both go the same way");
                }
            }
        }
    }

    /// No fan has more faces than the walk visits.
    void fans() {
        if (times_ > 0) return;
        for (std::uint32_t f = 0; f < faces_.size(); ++f) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                std::uint32_t count = 1, face = f, corner = c;
                for (bool ahead = true; count <= max_fan;) {
                    const Link over = faces_[face].over[ahead ? (corner + 2) % 3 : corner];
                    if (over == no_link) {
                        if (!ahead) break;
                        ahead = false, face = f, corner = c;
                        continue;
                    }
                    face = face_of(over);
                    corner = ahead ? edge_of(over) : (edge_of(over) + 1) % 3;
                    if (face == f) break;
                    ++count;
                }
                if (count > max_fan) say("a fan at face ", f, " has more than ", max_fan, " faces");
            }
        }
    }

    /// All faces at an end of an edge without a neighbour have the rim flag.
    void rims() {
        std::set<Point3> ends;
        for (const AnyFace& f : faces_) {
            for (std::size_t e = 0; e < 3; ++e)
                if (f.over[e] == no_link) ends.insert({f.corner[e], f.corner[(e + 1) % 3]});
        }
        for (const AnyFace& f : faces_) {
            const bool touches =
                ends.count(f.corner[0]) + ends.count(f.corner[1]) + ends.count(f.corner[2]) > 0;
            if (touches && (f.flags & face_rim) == 0)
                say("triangle ", f.triangle, " is on a rim and does not say so");
            if (!touches && (f.flags & face_rim) != 0 && mesh_.notes().vertices_split == 0)
                say("triangle ", f.triangle, " says that it is on a rim");
        }
    }

    void tree() {
        std::vector<int> in_leaf(faces_.size()), reached(data_.nodes.size()), depth(data_.nodes.size());
        if (data_.nodes.empty()) return say("no tree");
        reached[0] = 1;
        for (std::uint32_t n = 0; n < data_.nodes.size(); ++n) {
            const MeshNode& node = data_.nodes[n];
            if (depth[n] >= deepest) say("node ", n, " is too deep");
            for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
                if (!(node.low[0][i] <= node.high[0][i])) continue;
                const std::uint32_t child = node.child[i];
                if (is_leaf(child)) {
                    for (std::uint32_t f = leaf_first(child); f < leaf_first(child) + leaf_count(child);
                         ++f) {
                        if (f >= faces_.size()) return say("a leaf of faces that are not there");
                        ++in_leaf[f];
                        for (const Point3& c : faces_[f].corner)
                            for (std::size_t k = 0; k < 3; ++k)
                                if (c[k] < node.low[k][i] || c[k] > node.high[k][i])
                                    say("face ", f, " outside of its leaf");
                    }
                    if (leaf_count(child) > 4) say("a leaf of ", leaf_count(child));
                    continue;
                }
                if (child <= n || child >= data_.nodes.size()) return say("child ", child, " of node ", n);
                ++reached[child];
                depth[child] = depth[n] + 1;
                const MeshNode& below = data_.nodes[child];
                for (std::uint32_t j = 0; j < MeshNode::fan; ++j) {
                    if (!(below.low[0][j] <= below.high[0][j])) continue;
                    for (std::size_t k = 0; k < 3; ++k)
                        if (below.low[k][j] < node.low[k][i] || below.high[k][j] > node.high[k][i])
                            say("node ", child, " outside of its parent");
                }
            }
        }
        for (std::size_t f = 0; f < in_leaf.size(); ++f)
            if (in_leaf[f] != 1) say("face ", f, " in ", in_leaf[f], " leaves");
        for (std::size_t n = 0; n < reached.size(); ++n)
            if (reached[n] != 1) say("node ", n, " has ", reached[n], " parents");
        for (const AnyFace& f : faces_)
            for (const Point3& c : f.corner)
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto x = static_cast<long double>(c[k]) + data_.origin[static_cast<int>(k)];
                    if (x < mesh_.low[static_cast<int>(k)] || x > mesh_.high[static_cast<int>(k)])
                        say("triangle ", f.triangle, " outside of the asset's box");
                }
    }

    const Mesh& mesh_;
    const MeshData& data_;
    const RawMesh& raw_;
    const MeshBuild& how_;
    const std::vector<AnyFace> faces_;
    std::ostringstream said_;
    int times_ = 0;
};

}  // namespace

std::string wrong(const Mesh& mesh, const RawMesh& raw, const MeshBuild& how) {
    return Check(mesh, raw, how).run();
}

std::size_t crossed(const Mesh& mesh) {
    const auto faces = all_faces(mesh);
    return static_cast<std::size_t>(std::count_if(
        faces.begin(), faces.end(), [](const AnyFace& f) { return (f.flags & face_crossed) != 0; }));
}

std::size_t on_rim(const Mesh& mesh) {
    const auto faces = all_faces(mesh);
    return static_cast<std::size_t>(std::count_if(
        faces.begin(), faces.end(), [](const AnyFace& f) { return (f.flags & face_rim) != 0; }));
}

bool is_crossed(const Mesh& mesh, std::uint32_t triangle) {
    for (const AnyFace& f : all_faces(mesh))
        if (f.triangle == triangle) return (f.flags & face_crossed) != 0;
    return false;
}

int over(const Mesh& mesh, const RawMesh& raw, std::uint32_t triangle, std::uint32_t a, std::uint32_t b) {
    const auto faces = all_faces(mesh);
    for (const AnyFace& f : faces) {
        if (f.triangle != triangle) continue;
        const Triangle& t = raw.triangles[triangle];
        const bool turned = std::abs(f.corner[1][0] + mesh.data().origin[0] - raw.vertices[t[1]][0]) +
                                std::abs(f.corner[1][1] + mesh.data().origin[1] - raw.vertices[t[1]][1]) +
                                std::abs(f.corner[1][2] + mesh.data().origin[2] - raw.vertices[t[1]][2]) >
                            1e-5 * mesh.data().size;
        for (std::size_t e = 0; e < 3; ++e) {
            const std::size_t from = turned ? (3 - e) % 3 : e, to = turned ? (5 - e) % 3 : (e + 1) % 3;
            if (std::minmax(t[from], t[to]) != std::minmax(a, b)) continue;
            return f.over[e] == no_link ? -1 : static_cast<int>(faces[face_of(f.over[e])].triangle);
        }
    }
    return -2;
}

}  // namespace knurl::test
