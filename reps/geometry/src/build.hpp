#pragma once
// The steps of building a mesh, and the data that they pass to each other.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "mesh_data.hpp"

namespace knurl::build {

/// Counts work and asks after every slice whether to continue.
class Slices {
  public:
    explicit Slices(const std::function<bool()>& go_on) : go_on_(go_on) {}
    void operator()(std::uint32_t work = 1) {
        if ((done_ += work) >= slice) ask();
    }
    void ask();  // throws MeshCancelled

  private:
    static constexpr std::uint32_t slice = 1 << 15;  // steps of some 10 ns each
    const std::function<bool()>& go_on_;
    std::uint32_t done_ = 0;
};

/// Triangles' numbers for a message: the first few, and how many there are.
class Named {
  public:
    void add(std::uint64_t number);
    std::uint64_t count() const { return count_; }
    std::string text() const;  // "triangle 7", "triangles 7, 8, 9 and 4 more"

  private:
    std::array<std::uint64_t, 3> first_{};
    std::uint64_t count_ = 0;
};

/// The place of the mesh, and the lengths that tolerances refer to.
struct Frame {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m, about the middle
    Point3 low{}, high{};                              // m, of the plausible vertices
    double size = 0;                                   // m, the diagonal
    double spread = 0;                                 // m, of the middle half of the vertices
    double noise = 0;                                  // m, by which rounding moves a corner at most

    bool holds(const Point3& p) const {  // false for NaN
        return p[0] >= low[0] && p[0] <= high[0] && p[1] >= low[1] && p[1] <= high[1] && p[2] >= low[2] &&
               p[2] <= high[2];
    }
};

/// The faces that are left at this step.
struct Faces {
    std::vector<Point3> at;            // m from the origin, of each vertex, rounded as in the mesh
    std::vector<Triangle> corners;     // of each face, indices into `at`
    std::vector<std::uint32_t> given;  // the number of the original triangle
};

using Links = std::vector<std::array<Link, 3>>;

Frame find_frame(const Triangles& given, bool exact, MeshNotes& notes, Slices& slices);
/// Vertices within this distance are merged (m). A few distant vertices do not enlarge it.
double tolerance(const Frame& frame, const MeshBuild& how);
Faces weld(const Triangles& given, const Frame& frame, const MeshBuild& how, MeshNotes& notes,
           Slices& slices);
/// Brings faces and vertices into the order of the returned tree.
std::vector<MeshNode> sort_into_tree(Faces& faces, Slices& slices);
/// Where more than two faces meet in an edge: the pair of faces with the same solid between them. All entries
/// start as no_link.
using SolidLinks = std::vector<std::pair<Link, Link>>;
/// Finds each edge's neighbour. May turn faces over and drop duplicates. Then it returns true, and the tree
/// is outdated.
bool pair_edges(Faces& faces, Links& links, SolidLinks& solid, MeshNotes& notes, Slices& slices);
/// Which faces are connected, and which of these parts are closed.
struct Parts {
    std::vector<std::uint32_t> of;  // of each face
    std::vector<bool> closed;       // of each part
};
Parts find_parts(const Links& links, Slices& slices);
/// Bounds the fans and returns each face's flags.
std::vector<std::uint8_t> split_fans(const Faces& faces, Links& links, MeshNotes& notes, Slices& slices);
/// Flags the faces that others cross; a distance below `touch` (m) counts as a touch.
void find_crossings(const MeshData& data, const Faces& faces, double touch, std::vector<std::uint8_t>& flags,
                    MeshNotes& notes, Slices& slices);

}  // namespace knurl::build
