// Which faces are near each other, and the gaps between parts.

#include "unite.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace knurl::build {
namespace {

using Eigen::Vector3d;

constexpr double parallel = 0.9998;  // cosine: within about 1 degree

struct Extent {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    void add(const Point3& p) {
        for (std::size_t k = 0; k < 3; ++k)
            low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    }
    void add(const Extent& o) {
        for (std::size_t k = 0; k < 3; ++k)
            low[k] = std::min(low[k], o.low[k]), high[k] = std::max(high[k], o.high[k]);
    }
    bool meets(const Extent& o, double more) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (!(low[k] <= o.high[k] + more && o.low[k] <= high[k] + more)) return false;
        return true;
    }
};

Extent extent_of(const Faces& faces, std::uint32_t f) {
    Extent box;
    for (const std::uint32_t v : faces.corners[f]) box.add(faces.at[v]);
    return box;
}

bool has_child(const MeshNode& node, std::uint32_t place) {
    return node.low[0][place] <= node.high[0][place];
}

bool child_meets(const MeshNode& node, std::uint32_t place, const Extent& box, double reach) {
    bool meets = has_child(node, place);
    for (std::size_t k = 0; k < 3; ++k)
        meets =
            meets && node.low[k][place] <= box.high[k] + reach && node.high[k][place] >= box.low[k] - reach;
    return meets;
}

/// Faces first ... end - 1, and what they lie in.
struct Leaf {
    std::uint32_t first, end;
    Extent box;
};

Leaf leaf_of(const Faces& faces, std::uint32_t child) {
    Leaf leaf{leaf_first(child), leaf_first(child) + leaf_count(child), {}};
    for (std::uint32_t f = leaf.first; f < leaf.end; ++f) leaf.box.add(extent_of(faces, f));
    return leaf;
}

/// Calls see(f, g), f < g, for the leaf's faces f and the faces g of another leaf. False when see() does, or when
/// no more than `left` may be looked at.
template <class See>
bool for_near_in(const Faces& faces, const Leaf& leaf, std::uint32_t other_leaf, double reach, Slices& slices,
                 std::uint64_t& left, See&& see) {
    const std::uint32_t last = leaf_first(other_leaf) + leaf_count(other_leaf);
    for (std::uint32_t g = std::max(leaf_first(other_leaf), leaf.first + 1); g < last; ++g) {
        const Extent other = extent_of(faces, g);
        slices();
        if (left-- == 0) return false;
        for (std::uint32_t f = leaf.first; f < leaf.end && f < g; ++f) {
            if (extent_of(faces, f).meets(other, reach) && !see(f, g)) return false;
        }
    }
    return true;
}

/// Calls see(f, g), f < g, for the leaf's faces f: as for_near.
template <class Skipped, class See>
bool for_near_leaf(const Faces& faces, std::span<const MeshNode> nodes, const Leaf& leaf, double reach,
                   Slices& slices, std::vector<std::uint32_t>& stack, Skipped&& skipped, std::uint64_t& left,
                   See&& see) {
    stack.assign(1, 0);
    while (!stack.empty()) {
        const MeshNode& node = nodes[stack.back()];
        stack.pop_back();
        slices(4);
        for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
            if (!child_meets(node, i, leaf.box, reach)) continue;
            const std::uint32_t child = node.child[i];
            if (is_leaf(child)) {
                if (!for_near_in(faces, leaf, child, reach, slices, left, see)) return false;
            } else if (!skipped(child, leaf)) {
                stack.push_back(child);
            }
        }
    }
    return true;
}

/// Calls see(f, g), f < g, for faces whose boxes are within `reach` of each other; `asked` says whether f's
/// leaf needs to be looked at, and `skipped` which nodes do not. False when see() does.
template <class Asked, class Skipped, class See>
bool for_near(const Faces& faces, std::span<const MeshNode> nodes, double reach, Slices& slices,
              Asked&& asked, Skipped&& skipped, std::uint64_t& left, See&& see) {
    std::vector<std::uint32_t> stack;
    for (const MeshNode& from : nodes) {
        for (std::uint32_t place = 0; place < MeshNode::fan; ++place) {
            if (!has_child(from, place) || !is_leaf(from.child[place])) continue;
            const Leaf leaf = leaf_of(faces, from.child[place]);
            slices();
            if (!asked(leaf)) continue;
            if (!for_near_leaf(faces, nodes, leaf, reach, slices, stack, skipped, left, see)) return false;
        }
    }
    return true;
}

std::uint32_t shared_corners(const Triangle& s, const Triangle& t) {
    std::uint32_t count = 0;
    for (const std::uint32_t a : s)
        for (const std::uint32_t b : t) count += a == b;
    return count;
}

enum class Beside { no, facing, flush };

/// facing: the two sides of a gap, or of walls that lie on each other. flush: they face the same way, side by
/// side, perhaps with a gap.
Beside beside(const Faces& faces, std::uint32_t f, std::uint32_t g, const Near& near, Vector3d& normal) {
    const auto corners = [&](std::uint32_t face, Vector3d(&p)[3]) {
        for (std::size_t i = 0; i < 3; ++i) p[i] = Vector3d(faces.at[faces.corners[face][i]].data());
    };
    Vector3d p[3], q[3];
    corners(f, p), corners(g, q);
    normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    const Vector3d other = (q[1] - q[0]).cross(q[2] - q[0]).normalized();
    const double cosine = normal.dot(other);
    if (std::abs(cosine) < parallel) return Beside::no;
    const auto apart = [&](const Vector3d& axis) {
        double p_low = HUGE_VAL, p_high = -HUGE_VAL, q_low = HUGE_VAL, q_high = -HUGE_VAL;
        for (std::size_t i = 0; i < 3; ++i) {
            p_low = std::min(p_low, axis.dot(p[i])), p_high = std::max(p_high, axis.dot(p[i]));
            q_low = std::min(q_low, axis.dot(q[i])), q_high = std::max(q_high, axis.dot(q[i]));
        }
        return std::max(p_low - q_high, q_low - p_high);
    };
    const double most = cosine < 0 ? -near.touch : 2 * near.gap;
    for (std::size_t i = 0; i < 3; ++i) {
        if (apart(normal.cross(p[(i + 1) % 3] - p[i]).normalized()) > most) return Beside::no;
        if (apart(normal.cross(q[(i + 1) % 3] - q[i]).normalized()) > most) return Beside::no;
    }
    return cosine < 0 ? Beside::facing : Beside::flush;
}

}  // namespace

Parts find_parts(Links links, const SolidLinks& solid, Slices& slices) {
    for (const auto& [a, b] : solid) {
        links[face_of(a)][edge_of(a)] = b;
        if (b != no_link) links[face_of(b)][edge_of(b)] = a;
    }
    return find_parts(links, slices);
}

namespace {

/// What each part lies in. None if there are many: few parts far from each other need no look at their faces.
std::vector<Extent> boxes_of_few(const Faces& faces, const Parts& parts, Slices& slices) {
    constexpr std::size_t few = 64;
    std::vector<Extent> boxes;
    if (parts.closed.size() > few) return boxes;
    boxes.resize(parts.closed.size());
    for (std::uint32_t f = 0; f < faces.corners.size(); ++f, slices())
        boxes[parts.of[f]].add(extent_of(faces, f));
    return boxes;
}

/// A face of the leaf is within reach of another part's box.
bool near_other_part(const Leaf& leaf, const Parts& parts, const std::vector<Extent>& boxes, double reach) {
    for (std::uint32_t part = 0; part < boxes.size(); ++part) {
        if (!leaf.box.meets(boxes[part], reach)) continue;
        for (std::uint32_t f = leaf.first; f < leaf.end; ++f)
            if (parts.of[f] != part) return true;
    }
    return false;
}

constexpr std::uint32_t many_parts = 0xffffffff;  // more than one part

/// The part that all faces below a child are of.
std::uint32_t part_of_child(std::uint32_t child, const Parts& parts,
                            const std::vector<std::uint32_t>& of_node) {
    if (!is_leaf(child)) return of_node[child];
    const std::uint32_t part = parts.of[leaf_first(child)];
    for (std::uint32_t f = 1; f < leaf_count(child); ++f)
        if (parts.of[leaf_first(child) + f] != part) return many_parts;
    return part;
}

/// The part that all faces below each node are of.
std::vector<std::uint32_t> parts_of_nodes(std::span<const MeshNode> nodes, const Parts& parts,
                                          Slices& slices) {
    std::vector<std::uint32_t> of_node(nodes.size(), many_parts);
    for (std::size_t n = of_node.size(); n-- > 0; slices()) {
        bool first = true;
        for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
            if (!has_child(nodes[n], i)) continue;
            const std::uint32_t part = part_of_child(nodes[n].child[i], parts, of_node);
            of_node[n] = first || of_node[n] == part ? part : many_parts;
            first = false;
        }
    }
    return of_node;
}

/// Pairs of different parts whose boxes are that near (m); of one part those that meet, where faces cross at
/// all. False: more than `most`.
bool find_pairs(const Faces& faces, std::span<const MeshNode> nodes, const Parts& parts, bool crossed,
                const Near& near, std::size_t most, Pairs& pairs, Slices& slices) {
    const double reach = 3 * near.gap + near.touch;
    const std::vector<Extent> boxes = boxes_of_few(faces, parts, slices);
    const auto asked = [&](const Leaf& leaf) {
        return crossed || boxes.empty() || near_other_part(leaf, parts, boxes, reach);
    };
    // Nodes of one part alone, which a face of that part need not look into.
    std::vector<std::uint32_t> of_node;
    if (!crossed) of_node = parts_of_nodes(nodes, parts, slices);
    const auto skipped = [&](std::uint32_t node, const Leaf& leaf) {
        bool own = !crossed;
        for (std::uint32_t f = leaf.first; f < leaf.end; ++f) own = own && of_node[node] == parts.of[f];
        return own;
    };
    // Where very many boxes overlap, there would be too many cuts.
    std::uint64_t left = 64 * faces.corners.size() + 100'000;
    return for_near(faces, nodes, reach, slices, asked, skipped, left, [&](std::uint32_t f, std::uint32_t g) {
        if (parts.of[f] != parts.of[g]) {
            pairs.emplace_back(f, g);
        } else if (crossed && extent_of(faces, f).meets(extent_of(faces, g), near.touch)) {
            const std::uint32_t shared = shared_corners(faces.corners[f], faces.corners[g]);
            if (shared < 2 && meet(faces, f, g, shared > 0, near.touch)) pairs.emplace_back(f, g);
        }
        return pairs.size() <= most;
    });
}

/// Moves vertices of one body into the plane of another body's face within a gap. So the two become one wall,
/// or level, and nothing is left that is nearly so. Returns how many.
std::uint64_t shut_gaps(Faces& faces, const Pairs& pairs, const Parts& parts, const Near& near,
                        Slices& slices) {
    std::uint64_t moved = 0;
    for (const auto& [f, g] : pairs) {
        slices(2);
        if (parts.of[f] == parts.of[g] || !parts.closed[parts.of[f]] || !parts.closed[parts.of[g]]) continue;
        const bool first = parts.of[f] < parts.of[g];
        const std::uint32_t stays = first ? f : g, moves = first ? g : f;
        Vector3d normal;
        const Beside how = beside(faces, stays, moves, near, normal);
        if (how == Beside::no) continue;
        const Vector3d from(faces.at[faces.corners[stays][0]].data());
        for (const std::uint32_t v : faces.corners[moves]) {
            const Vector3d p(faces.at[v].data());
            const double height = normal.dot(p - from);
            // Walls that overlap slightly likewise: such a thin overlap is cut badly.
            if (!(std::abs(height) <= near.gap) || std::abs(height) < near.touch / 16) continue;
            const Vector3d to = p - normal * height;
            for (std::size_t k = 0; k < 3; ++k) {
                const double x = to[static_cast<int>(k)];
                faces.at[v][k] = near.as_float ? static_cast<float>(x) : x;
            }
            ++moved;
        }
    }
    return moved;
}

}  // namespace

namespace {

/// The result of a cut: untouched faces, and the pieces of the others.
struct Cut {
    Faces faces;
    std::vector<std::uint32_t> part;  // of each face
    std::vector<bool> changed;        // a piece of a face that meets others
};

Cut gather(Faces& faces, const Parts& parts, std::span<const Piece> pieces, const std::vector<bool>& touched,
           MeshNotes& notes, Slices& slices) {
    Cut out;
    out.faces.at = std::move(faces.at);
    const auto add = [&](const Triangle& corners, std::uint32_t face, bool is_new) {
        out.faces.corners.push_back(corners);
        out.faces.given.push_back(faces.given[face]);
        out.part.push_back(parts.of[face]);
        out.changed.push_back(is_new);
        slices();
    };
    for (std::uint32_t f = 0; f < faces.corners.size(); ++f) {
        if (!touched[f]) add(faces.corners[f], f, false);
    }
    std::vector<std::uint32_t> count(faces.corners.size());
    for (const Piece& piece : pieces) {
        if (!piece.there) continue;
        add(piece.corners, piece.face, piece.meets);
        ++count[piece.face];
    }
    for (std::uint32_t f = 0; f < count.size(); ++f) {
        notes.faces_cut += count[f] > 1;
        if (count[f] > 1) notes.faces_added += count[f] - 1;
        if (touched[f] && count[f] == 0) ++notes.faces_inside;
    }
    return out;
}

}  // namespace

United unite(Faces& faces, std::span<const MeshNode> nodes, const Parts& parts, bool crossed,
             const Near& near, std::size_t most, MeshNotes& notes, Slices& slices) {
    slices.ask();
    Pairs pairs;
    if (!find_pairs(faces, nodes, parts, crossed, near, most, pairs, slices)) {
        notes.not_united = 1;  // a larger tolerance would find even more of them
        return United::nothing;
    }
    if (pairs.empty()) return United::nothing;
    std::sort(pairs.begin(), pairs.end());
    const std::uint64_t shut = near.gap > 0 ? shut_gaps(faces, pairs, parts, near, slices) : 0;
    notes.vertices_moved += shut;
    std::erase_if(pairs, [&](const auto& pair) {
        slices();
        const auto& [f, g] = pair;
        return parts.of[f] != parts.of[g] && !meet(faces, f, g, false, near.touch);
    });
    std::vector<bool> touched(faces.corners.size());
    const auto pieces = cut(faces, pairs, near, most, touched, notes, slices);
    if (!pieces) return shut > 0 ? United::changed : United::too_much;
    if (pieces->empty()) return shut > 0 ? United::changed : United::nothing;
    Cut out = gather(faces, parts, *pieces, touched, notes, slices);
    const auto dropped = drop_inside(out.faces, out.part, out.changed, parts.closed, near, slices);
    if (!dropped) return United::unsound;
    notes.faces_inside += *dropped;
    faces = std::move(out.faces);
    return United::changed;
}

}  // namespace knurl::build
