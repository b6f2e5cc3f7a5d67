#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include <knurl/geometry/mesh.hpp>

#include "build.hpp"
#include "unite.hpp"

namespace knurl {
namespace build {

void Slices::ask() {
    done_ = 0;
    if (go_on_ && !go_on_())
        throw MeshCancelled("the building of the mesh was cancelled; nothing is left of it");
}

void Named::add(std::uint64_t number) {
    if (count_ < first_.size()) first_[count_] = number;
    ++count_;
}

std::string Named::text() const {
    std::string text = count_ == 1 ? "triangle " : "triangles ";
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(count_, first_.size()); ++i)
        text += (i == 0 ? "" : ", ") + std::to_string(first_[i]);
    if (count_ > first_.size()) text += " and " + std::to_string(count_ - first_.size()) + " more";
    return text;
}

namespace {

/// Touches pages as the faces come, not all at once.
template <class F>
void write(const Faces& faces, const Links& links, const std::vector<std::uint8_t>& flags,
           std::span<const std::uint8_t> materials, std::vector<F>& out, Slices& slices) {
    using Real = std::remove_all_extents_t<decltype(F::corner)>;
    out.reserve(faces.corners.size());
    for (std::size_t i = 0; i < faces.corners.size(); ++i, slices(2)) {
        F& face = out.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t k = 0; k < 3; ++k)
                face.corner[c][k] = static_cast<Real>(faces.at[faces.corners[i][c]][k]);
            face.over[c] = links[i][c];
        }
        face.triangle = faces.given[i];
        face.material = materials.empty() ? std::uint8_t{0} : materials[face.triangle];
        face.flags = flags[i];
    }
}

void check(const Triangles& given, const MeshBuild& how) {
    constexpr std::size_t most = std::size_t{1} << 28;
    const std::size_t n = given.triangles.size();
    if (n == 0) throw MeshError("the mesh has no triangles; send at least one");
    if (n > most)
        throw MeshError("the mesh has " + std::to_string(n) + " triangles; send at most " +
                        std::to_string(most) + ", the rest as another mesh");
    if (given.vertices.size() >= std::numeric_limits<std::uint32_t>::max())
        throw MeshError("the mesh has " + std::to_string(given.vertices.size()) +
                        " vertices; send fewer than 2^32 - 1, the rest as another mesh");
    if (!given.materials.empty() && given.materials.size() != n)
        throw MeshError("the mesh has " + std::to_string(n) + " triangles but materials for " +
                        std::to_string(given.materials.size()) + "; give each its own, or none at all");
    if (!(how.weld >= 0 && how.weld <= 0.1))
        throw MeshError("the mesh's welding tolerance is " + std::to_string(how.weld) +
                        " of its size; set it to 0 ... 0.1");
    if (!(how.gap >= 0 && how.gap <= 0.01))
        throw MeshError("the mesh's gap is " + std::to_string(how.gap) +
                        " of its size; set it to 0 ... 0.01");
    const std::size_t need = mesh_budget(given.vertices.size(), n, how.exact);
    if (need > how.budget)
        throw MeshError("the mesh of " + std::to_string(n) + " triangles and " +
                        std::to_string(given.vertices.size()) + " vertices would take " +
                        std::to_string(need) + " bytes to build, but the budget is " +
                        std::to_string(how.budget) + "; raise it, or send fewer triangles");
}

/// Brings the faces into the tree's order and links each edge with its neighbour.
void link(Faces& faces, Links& links, SolidLinks& solid, std::vector<MeshNode>& nodes, MeshNotes& notes,
          Slices& slices) {
    do {
        if (faces.corners.empty())
            throw MeshError(
                "no triangle of the mesh is left: of " + std::to_string(notes.triangles_given) + ", " +
                std::to_string(notes.faces_dropped) + " have a vertex that is not a plausible number and " +
                std::to_string(notes.faces_degenerate) + " have no area; check its vertices and their unit");
        nodes = sort_into_tree(faces, slices);
    } while (pair_edges(faces, links, solid, notes, slices));
}

/// The pieces of cut faces that the budget allows, and a bound where everything crosses.
std::size_t most_pieces(const Triangles& given, const MeshBuild& how) {
    constexpr std::size_t bytes = 512;  // of an unfinished piece, at most
    const std::size_t n = given.triangles.size();
    return std::min((how.budget - mesh_budget(given.vertices.size(), n, how.exact)) / bytes, 16 * n + 1024);
}

/// A surface between the given triangles and the finished mesh.
class Surface {
  public:
    Surface(const Triangles& given, const MeshBuild& how, const Frame& frame, MeshData& data,
            std::vector<MeshNode>& nodes, Slices& slices)
        : given_(given), how_(how), frame_(frame), data_(data), nodes_(nodes), slices_(slices) {}

    /// Cuts faces that meet, if they can be cut soundly; a larger tolerance for equal points may be needed. A
    /// surface with a hole is worse than one that crosses itself, which the flags tell the walk.
    void make() {
        const MeshNotes before = data_.notes;
        const double touch = std::max({tolerance(frame_, how_), 4 * frame_.noise, 1e-9 * frame_.size});
        const double gap = how_.gap * frame_.size, coarsest = std::max(4 * touch, std::min(64 * touch, gap));
        Near near{.touch = touch, .gap = gap, .as_float = !how_.exact};
        bool cuts = how_.find_crossings && how_.unite;
        while (!make(near, cuts)) {
            data_.notes = before;
            near.touch *= 4;
            if (near.touch <= coarsest) continue;
            cuts = false;
            data_.notes.not_united = 1;
        }
    }

    Faces faces;
    Links links;
    std::vector<std::uint8_t> flags;

  private:
    /// Makes the surface from the beginning. False: the cuts are not sound.
    bool make(Near near, bool cuts) {
        faces = weld(given_, frame_, how_, data_.notes, slices_);
        constexpr int rounds = 3;  // faces bent by a cut may meet others
        MeshNotes& notes = data_.notes;
        std::uint64_t duplicates = 0;
        bool closed = false;
        for (int round = 0;; ++round) {
            SolidLinks solid;
            link(faces, links, solid, nodes_, notes, slices_);
            if (round == 0) closed = notes.edges_open == 0, duplicates = notes.faces_duplicate;
            if (closed && notes.edges_open > 0) return false;
            notes.faces_inside += notes.faces_duplicate - duplicates;  // pieces that lie on each other
            notes.faces_duplicate = duplicates;
            data_.nodes = nodes_;
            const bool may_unite = cuts && round < rounds;
            Parts parts;
            if (may_unite) parts = parts_apart(solid);
            mark();
            const bool crossed = notes.faces_crossed > 0;
            if (!may_unite || (parts.closed.size() < 2 && !crossed)) return true;
            if (parts.of.empty())
                parts = {std::vector<std::uint32_t>(faces.corners.size()), {notes.edges_open == 0}};
            const United united =
                unite(faces, nodes_, parts, crossed, near, most_pieces(given_, how_), notes, slices_);
            if (united == United::unsound || (united == United::too_much && closed)) return false;
            if (united != United::changed) {
                if (united == United::too_much) notes.not_united = 1;
                return true;
            }
            near.gap = 0;
            notes.edges_open = notes.edges_non_manifold = notes.vertices_split = notes.faces_crossed = 0;
        }
    }

    /// Which parts there are; nothing if all is one.
    Parts parts_apart(const SolidLinks& solid) const {
        if (data_.notes.parts <= 1 && solid.empty()) return {};
        return find_parts(links, solid, slices_);
    }

    void mark() {
        flags = split_fans(faces, links, data_.notes, slices_);
        const double touch = std::max(tolerance(frame_, how_), 2 * frame_.noise);
        if (how_.find_crossings) find_crossings(data_, faces, touch, flags, data_.notes, slices_);
    }

    const Triangles& given_;
    const MeshBuild& how_;
    const Frame& frame_;
    MeshData& data_;
    std::vector<MeshNode>& nodes_;
    Slices& slices_;
};

}  // namespace
}  // namespace build

std::size_t mesh_budget(std::size_t vertices, std::size_t triangles, bool exact) noexcept {
    // The larger of two phases: sorting into the tree's order, and writing.
    return std::max(vertices * 52 + triangles * 97, vertices * 24 + triangles * (exact ? 148 : 116)) + 8192;
}

Mesh::Mesh(const Triangles& given, const MeshBuild& how)
    : Asset(AssetKind::mesh), data_(std::make_unique<MeshData>()) {
    build::check(given, how);
    MeshData& data = *data_;
    const auto memory = std::make_shared<MeshMemory>();
    data.keeper = memory;
    MeshNotes& notes = data.notes;
    notes.triangles_given = given.triangles.size();
    notes.vertices_given = given.vertices.size();
    build::Slices slices(how.go_on);

    const build::Frame frame = build::find_frame(given, how.exact, notes, slices);
    data.origin = frame.origin;
    data.size = frame.size;
    data.exact = how.exact;
    build::Surface surface(given, how, frame, data, memory->nodes, slices);
    surface.make();
    for (const auto& over : surface.links) {
        slices();
        data.open = data.open || over[0] == no_link || over[1] == no_link || over[2] == no_link;
    }
    if (how.exact) {
        build::write(surface.faces, surface.links, surface.flags, given.materials, memory->exact_faces,
                     slices);
    } else {
        build::write(surface.faces, surface.links, surface.flags, given.materials, memory->faces, slices);
    }
    data.faces = memory->faces;
    data.exact_faces = memory->exact_faces;
    const MeshNode& root = data.nodes.front();
    for (int k = 0; k < 3; ++k) {
        const double below = *std::min_element(root.low[k], root.low[k] + MeshNode::fan);
        const double above = *std::max_element(root.high[k], root.high[k] + MeshNode::fan);
        low[k] = std::nextafter(data.origin[k] + below, -std::numeric_limits<double>::infinity());
        high[k] = std::nextafter(data.origin[k] + above, std::numeric_limits<double>::infinity());
    }
}

Mesh::~Mesh() = default;

std::size_t Mesh::bytes() const noexcept {
    return sizeof(*this) + sizeof(MeshData) + data_->faces.size_bytes() + data_->exact_faces.size_bytes() +
           data_->nodes.size_bytes();
}

DrawnTriangles Mesh::drawn() const {
    DrawnTriangles drawn;
    drawn.vertices.reserve(9 * faces());
    drawn.triangles.reserve(3 * faces());
    const auto add = [&](const auto& face) {
        for (const auto& corner : face.corner) {
            drawn.triangles.push_back(static_cast<std::uint32_t>(drawn.vertices.size() / 3));
            for (int i = 0; i < 3; ++i)
                drawn.vertices.push_back(static_cast<float>(data_->origin[i] + double{corner[i]}));
        }
    };
    for (const Face& face : data_->faces) add(face);
    for (const ExactFace& face : data_->exact_faces) add(face);
    return drawn;
}

std::size_t Mesh::faces() const noexcept {
    return data_->exact ? data_->exact_faces.size() : data_->faces.size();
}

const MeshNotes& Mesh::notes() const noexcept {
    return data_->notes;
}

}  // namespace knurl
