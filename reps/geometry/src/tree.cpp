// A tree of boxes, eight to a node: binned surface area heuristic from the top (Wald 2007), halving where the
// tree would grow too deep. The lowest nodes are filled, since they are most of the tree's memory.

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "build.hpp"

namespace knurl::build {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr std::uint32_t leaf_faces = 4, bins = 16;
constexpr std::uint32_t filling = 24;  // faces that become one node with leaves only
constexpr int deep = 12;               // levels of nodes; below them halving needs at most 10 more

struct Box {
    float low[3] = {inf, inf, inf}, high[3] = {-inf, -inf, -inf};

    void add(const Box& o) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], o.low[k]);
            high[k] = std::max(high[k], o.high[k]);
        }
    }
    void add(const float (&p)[3]) {
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    float area() const {  // half of it; 0 for an empty box
        if (!(low[0] <= high[0])) return 0;
        const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x * y + y * z + z * x;
    }
    int longest() const {
        const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    }
};

struct Leaflet {  // a face to be put into a leaf
    Box box;
    std::uint32_t face;
    float middle(int k) const { return box.low[k] + box.high[k]; }  // twice the middle
};

struct Range {
    std::uint32_t first = 0, last = 0;
    Box box, middles;
    std::uint32_t count() const { return last - first; }
};

float below(double x) {
    const auto f = static_cast<float>(x);
    return f > x ? std::nextafter(f, -inf) : f;
}
float above(double x) {
    const auto f = static_cast<float>(x);
    return f < x ? std::nextafter(f, inf) : f;
}

class Builder {
  public:
    Builder(const Faces& faces, Slices& slices) : slices_(slices) {
        leaflets_.reserve(faces.corners.size());
        for (std::uint32_t f = 0; f < faces.corners.size(); ++f, slices_(2)) {
            Leaflet leaflet{.box = {}, .face = f};
            for (const std::uint32_t v : faces.corners[f]) {
                for (std::size_t k = 0; k < 3; ++k) {
                    leaflet.box.low[k] = std::min(leaflet.box.low[k], below(faces.at[v][k]));
                    leaflet.box.high[k] = std::max(leaflet.box.high[k], above(faces.at[v][k]));
                }
            }
            leaflets_.push_back(leaflet);
        }
    }

    std::vector<MeshNode> build() {
        struct Task {
            Range range;
            std::uint32_t parent, place;
            int depth;
        };
        std::vector<MeshNode> nodes;
        nodes.reserve(leaflets_.size() / 6 + 1);
        std::vector<Task> tasks{{measured(0, static_cast<std::uint32_t>(leaflets_.size())), 0, 0, 0}};
        while (!tasks.empty()) {
            const Task task = tasks.back();
            tasks.pop_back();
            const auto self = static_cast<std::uint32_t>(nodes.size());
            if (self > 0) nodes[task.parent].child[task.place] = self;
            const bool lowest = task.range.count() <= filling;
            std::array<Range, MeshNode::fan> children;
            children[0] = task.range;
            std::uint32_t count = 1;
            while (count < MeshNode::fan) {
                const std::uint32_t big = worst({children.data(), count}, task.depth, lowest);
                if (big == MeshNode::fan) break;
                children[count++] = split(children[big], task.depth);
            }
            MeshNode& node = nodes.emplace_back();
            for (std::uint32_t i = 0; i < MeshNode::fan; ++i) {
                const Range& child = children[i];
                for (int k = 0; k < 3; ++k) {
                    node.low[k][i] = child.box.low[k];
                    node.high[k][i] = child.box.high[k];
                }
                node.child[i] = child.count() == 0 || child.count() > leaf_faces
                                    ? MeshNode::leaf_bit
                                    : MeshNode::leaf_bit | (child.count() - 1) << 28 | child.first;
            }
            for (std::uint32_t i = count; i-- > 0;) {
                if (children[i].count() > leaf_faces) tasks.push_back({children[i], self, i, task.depth + 1});
            }
        }
        std::vector<MeshNode> fitting;
        fitting.reserve(nodes.size());
        for (const MeshNode& node : nodes) fitting.push_back(node), slices_(8);
        return fitting;
    }

    std::uint32_t face(std::size_t i) const { return leaflets_[i].face; }

  private:
    Range measured(std::uint32_t first, std::uint32_t last) {
        Range range{.first = first, .last = last, .box = {}, .middles = {}};
        for (std::uint32_t i = first; i < last; ++i, slices_()) {
            const Leaflet& leaflet = leaflets_[i];
            range.box.add(leaflet.box);
            range.middles.add({leaflet.middle(0), leaflet.middle(1), leaflet.middle(2)});
        }
        return range;
    }

    /// The child to be split next, first those that cannot be leaves; MeshNode::fan: none.
    static std::uint32_t worst(std::span<const Range> children, int depth, bool lowest) {
        const auto badness = [=](const Range& r) {
            if (r.count() < 2 || (r.count() > leaf_faces && r.count() <= filling && !lowest)) return -1.0F;
            if (r.count() <= leaf_faces) return r.box.area() / (r.box.area() + 1);  // < 1
            return depth < deep ? 2 + r.box.area() : static_cast<float>(r.count());
        };
        std::uint32_t best = MeshNode::fan;
        float most = -1;
        for (std::uint32_t i = 0; i < children.size(); ++i) {
            if (const float bad = badness(children[i]); bad > most) most = bad, best = i;
        }
        return best;
    }

    /// Leaves one part in `range` and returns the other.
    Range split(Range& range, int depth) {
        std::uint32_t middle = range.first;
        if (range.count() > filling && depth < deep) middle = split_by_area(range);
        if (middle == range.first || middle == range.last) {
            const bool whole_leaves = range.count() > leaf_faces && range.count() <= filling;
            middle =
                range.first + (whole_leaves ? (range.count() + 7) / 8 * leaf_faces : (range.count() + 1) / 2);
            const int axis = range.middles.longest();
            if (range.middles.low[axis] < range.middles.high[axis]) {
                const auto at = [this](std::uint32_t i) {
                    return leaflets_.begin() + static_cast<std::ptrdiff_t>(i);
                };
                std::nth_element(at(range.first), at(middle), at(range.last),
                                 [this, axis](const Leaflet& a, const Leaflet& b) {
                                     slices_();
                                     return a.middle(axis) < b.middle(axis);
                                 });
            }
        }
        const std::uint32_t last = range.last;
        range = measured(range.first, middle);
        return measured(middle, last);
    }

    std::uint32_t split_by_area(const Range& range) {
        const int axis = range.middles.longest();
        const float low = range.middles.low[axis], width = range.middles.high[axis] - low;
        if (!(width > 0)) return range.first;
        const float scale = static_cast<float>(bins) * (1 - 1e-6F) / width;
        if (!std::isfinite(scale)) return range.first;
        const auto bin_of = [=](const Leaflet& leaflet) {
            return static_cast<std::uint32_t>(
                std::clamp((leaflet.middle(axis) - low) * scale, 0.0F, bins - 1.0F));
        };
        Box boxes[bins];
        std::uint32_t counts[bins] = {};
        for (std::uint32_t i = range.first; i < range.last; ++i, slices_()) {
            const std::uint32_t bin = bin_of(leaflets_[i]);
            boxes[bin].add(leaflets_[i].box);
            ++counts[bin];
        }
        float right_cost[bins] = {};
        Box right;
        std::uint32_t right_count = 0;
        for (std::uint32_t b = bins; b-- > 1;) {
            right.add(boxes[b]);
            right_count += counts[b];
            right_cost[b] = right.area() * static_cast<float>(right_count);
        }
        Box left;
        std::uint32_t left_count = 0, best = 0;
        float least = inf;
        for (std::uint32_t b = 1; b < bins; ++b) {
            left.add(boxes[b - 1]);
            left_count += counts[b - 1];
            const float cost = left.area() * static_cast<float>(left_count) + right_cost[b];
            if (left_count > 0 && left_count < range.count() && cost < least) least = cost, best = b;
        }
        if (best == 0) return range.first;
        const auto at = [this](std::uint32_t i) {
            return leaflets_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        const auto middle = std::partition(at(range.first), at(range.last), [&](const Leaflet& leaflet) {
            slices_();
            return bin_of(leaflet) < best;
        });
        return static_cast<std::uint32_t>(middle - leaflets_.begin());
    }

    std::vector<Leaflet> leaflets_;
    Slices& slices_;
};

/// The faces in their new order, and the vertices in the order in which the faces name them.
Faces ordered(const Faces& faces, const Builder& builder, Slices& slices) {
    constexpr std::uint32_t none = 0xffffffff;
    Faces out;
    out.at.reserve(faces.at.size());
    out.corners.reserve(faces.corners.size());
    out.given.reserve(faces.corners.size());
    std::vector<std::uint32_t> number(faces.at.size(), none);
    for (std::size_t i = 0; i < faces.corners.size(); ++i, slices(4)) {
        const std::uint32_t f = builder.face(i);
        Triangle corners = faces.corners[f];
        for (std::uint32_t& v : corners) {
            if (number[v] == none) {
                number[v] = static_cast<std::uint32_t>(out.at.size());
                out.at.push_back(faces.at[v]);
            }
            v = number[v];
        }
        out.corners.push_back(corners);
        out.given.push_back(faces.given[f]);
    }
    return out;
}

}  // namespace

std::vector<MeshNode> sort_into_tree(Faces& faces, Slices& slices) {
    slices.ask();
    Builder builder(faces, slices);
    std::vector<MeshNode> nodes = builder.build();
    faces = ordered(faces, builder, slices);
    return nodes;
}

}  // namespace knurl::build
