#include "shapes.hpp"

namespace knurl::capi {

namespace {

// Beyond that a count is a mistake, and its bytes would overflow.
constexpr std::uint64_t most = std::uint64_t{1} << 32;

void require_count(std::uint64_t count, const char* what) {
    if (count >= most)
        throw Failed(KNURL_BAD_PARAMETERS,
                     std::string(what) + " = " + std::to_string(count) + "; no mesh has so many");
}

AssetMaterial from_c(const knurl_asset_material& material) {
    return {.stiffness = material.stiffness, .damping = material.damping, .friction = material.friction};
}

template <class T, class U>
bool one_of(const T* a, const U* b) {
    return (a == nullptr) != (b == nullptr);
}

}  // namespace

GivenMesh::GivenMesh(const knurl_mesh* given) {
    require_pointer(given, "knurl_mesh");
    const knurl_mesh mesh = read_struct(given, knurl_mesh{}, "knurl_mesh");
    require_count(mesh.vertex_count, "knurl_mesh: vertex_count");
    require_count(mesh.triangle_count, "knurl_mesh: triangle_count");
    if (mesh.vertex_count > 0 && !one_of(mesh.vertices, mesh.vertices_float))
        throw Failed(KNURL_BAD_ARGUMENT,
                     "knurl_mesh: give vertices or vertices_float, and leave the other one NULL");
    if (mesh.triangle_count > 0) require_pointer(mesh.triangles, "knurl_mesh: triangles");
    if (mesh.material_count > 256 || (mesh.material_count > 0 && mesh.materials == nullptr))
        throw Failed(KNURL_BAD_ARGUMENT, "knurl_mesh: " + std::to_string(mesh.material_count) +
                                             " materials; give at most 256, and their address");

    static_assert(sizeof(Point3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));
    if (mesh.vertices_float != nullptr) {
        converted_.resize(mesh.vertex_count);
        for (std::size_t i = 0; i < converted_.size(); ++i)
            for (std::size_t axis = 0; axis < 3; ++axis)
                converted_[i][axis] = static_cast<double>(mesh.vertices_float[3 * i + axis]);
        triangles_.vertices = converted_;
    } else {
        triangles_.vertices = {reinterpret_cast<const Point3*>(mesh.vertices), mesh.vertex_count};
    }
    triangles_.triangles = {reinterpret_cast<const Triangle*>(mesh.triangles), mesh.triangle_count};
    if (mesh.triangle_materials != nullptr)
        triangles_.materials = {mesh.triangle_materials, mesh.triangle_count};

    options_.exact = mesh.exact != 0;
    options_.find_crossings = mesh.no_crossings == 0;
    if (mesh.scale != 0) options_.scale = mesh.scale;
    if (mesh.weld != 0) options_.weld = mesh.weld;
    for (std::uint64_t i = 0; i < mesh.material_count; ++i)
        options_.materials.push_back(from_c(mesh.materials[i]));
}

Heights given_heights(const knurl_heights* given) {
    require_pointer(given, "knurl_heights");
    const knurl_heights field = read_struct(given, knurl_heights{}, "knurl_heights");
    if (!one_of(field.heights, field.heights_float))
        throw Failed(KNURL_BAD_ARGUMENT,
                     "knurl_heights: give heights or heights_float, and leave the other one NULL");
    const std::uint64_t count = std::uint64_t{field.columns} * field.rows;
    require_count(count, "knurl_heights: columns x rows");
    const knurl_asset_material& material = field.material;
    const bool unset = material.stiffness == 0 && material.damping == 0 && material.friction == 0;
    Heights heights{.grid = {.columns = field.columns,
                             .rows = field.rows,
                             .dx = field.dx,
                             .dy = field.dy,
                             .corner = {field.corner.x, field.corner.y, field.corner.z}},
                    .heights = std::span<const float>{},
                    .material = unset ? AssetMaterial{} : from_c(material)};
    if (field.heights != nullptr)
        heights.heights = std::span(field.heights, count);
    else
        heights.heights = std::span(field.heights_float, count);
    return heights;
}

knurl_sent sent_to_c(const SentShape& sent) {
    const MeshNotes& notes = sent.notes;
    return {.size = 0,
            .asset = sent.asset,
            .reserved = 0,
            .faces = sent.faces,
            .bytes = sent.bytes,
            .low = {sent.low.x, sent.low.y, sent.low.z},
            .high = {sent.high.x, sent.high.y, sent.high.z},
            .vertices_welded = notes.vertices_welded,
            .faces_dropped = notes.faces_dropped + notes.faces_degenerate + notes.faces_duplicate,
            .faces_turned = notes.faces_turned,
            .edges_open = notes.edges_open,
            .edges_non_manifold = notes.edges_non_manifold,
            .faces_crossed = notes.faces_crossed,
            .parts = notes.parts};
}

}  // namespace knurl::capi
