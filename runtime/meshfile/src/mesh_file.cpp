#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <knurl/meshfile/mesh_file.hpp>
#include <knurl/meshfile/polygons.hpp>
#include <knurl/meshfile/soup.hpp>

#include "words.hpp"

namespace knurl::meshfile {

void bad(const std::string& path, const std::string& text) {
    throw std::runtime_error(path + ": " + text);
}

void bad_at(const Soup& soup, std::uint64_t place, const std::string& text) {
    bad(fmt::format("{}{}{}", soup.path, soup.text ? ":" : ": face ", place), text);
}

namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{2} << 30;
constexpr double bent_much = 1e-3;  // of its size

std::string bytes_of(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        bad(path, std::filesystem::exists(path, error) ? "is no file; give a mesh as STL, OBJ or PLY"
                                                       : "is not there; give the path of a mesh");
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) bad(path, "cannot be read: " + error.message() + "; check the path and that you may read it");
    if (size == 0) bad(path, "is empty; write or fetch it again");
    if (size > most_bytes)
        bad(path, fmt::format("is {:.1f} GB large, at most {} GB are read; send fewer triangles",
                              static_cast<double>(size) * 1e-9, most_bytes >> 30));
    std::string bytes(size, '\0');
    std::ifstream in(path, std::ios::binary);
    if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(size)))
        bad(path, "cannot be read; check the path and that you may read it");
    return bytes;
}

Soup soup_of(std::string_view bytes, const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    const auto is = [&](const char* lower_case) { return same_word(extension, lower_case); };
    // By content first, then by the name.
    if (is_ply(bytes)) return read_ply(bytes, path);
    if (is(".ply")) bad(path, "is no PLY: its first line is not \"ply\"; write or fetch it again");
    if (is(".obj")) return read_obj(bytes, path);
    if (is(".stl") || is_stl(bytes)) return read_stl(bytes, path);
    return read_by_assimp(path);
}

std::string counted(std::uint64_t n, const char* one, const char* many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

}  // namespace

double MeshFile::size() const {
    Eigen::AlignedBox3d box;
    for (const knurl::Point3& v : vertices)
        if (std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]))
            box.extend(Eigen::Vector3d(v.data()));
    return box.isEmpty() ? 0 : box.diagonal().norm();
}

std::optional<knurl::Point3> MeshFile::far_middle() const {
    constexpr double far = 1e3;  // of its size
    Eigen::AlignedBox3d box;
    for (const knurl::Point3& v : vertices)
        if (std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]))
            box.extend(Eigen::Vector3d(v.data()));
    if (box.isEmpty() || !(box.center().norm() > far * box.diagonal().norm())) return std::nullopt;
    return knurl::Point3{box.center().x(), box.center().y(), box.center().z()};
}

MeshFile load_mesh(const std::string& path) {
    return read_mesh(bytes_of(path), path);
}

MeshFile read_mesh(std::string_view bytes, const std::string& path) {
    Soup soup = soup_of(bytes, path);
    if (soup.polygons.empty())
        bad(path, soup.points_and_lines > 0 || !soup.vertices.empty()
                      ? "holds points or lines but no triangle; give a surface"
                      : "is without content; give a file with triangles");
    MeshFile file;
    file.path = path;
    file.format = std::move(soup.format);
    file.vertices = std::move(soup.vertices);
    file.material_names = std::move(soup.material_names);
    file.notes = std::move(soup.notes);
    Cutter cutter;
    std::span<const std::uint32_t> rest = soup.corners;
    std::uint64_t concave = 0, nothing = 0, bent = 0;
    double most_bent = 0;
    for (const Soup::Polygon& polygon : soup.polygons) {
        switch (cutter.cut(file.vertices, rest.first(polygon.corners), file.triangles)) {
            case Cutter::Shape::convex:
                break;
            case Cutter::Shape::concave:
                ++concave;
                break;
            case Cutter::Shape::nothing:
                ++nothing;
                break;
            case Cutter::Shape::crossed:
                bad_at(soup, polygon.place,
                       fmt::format("the outline of a polygon of {} corners crosses itself, so its inside is "
                                   "not defined; let the program that made it write triangles",
                                   polygon.corners));
            case Cutter::Shape::too_large:
                bad_at(soup, polygon.place,
                       fmt::format("the polygon of {} corners takes too long to be cut into triangles; let "
                                   "the program that made it write triangles",
                                   polygon.corners));
        }
        file.materials.resize(file.triangles.size(), polygon.material);
        rest = rest.subspan(polygon.corners);
        bent += cutter.bent() > bent_much;
        most_bent = std::max(most_bent, cutter.bent());
    }
    const auto note = [&](std::uint64_t n, const std::string& text) {
        if (n > 0) file.notes.push_back(text);
    };
    note(concave, counted(concave, "polygon is", "polygons are") +
                      " not convex, or with corners on edges: cut into triangles along the outline");
    note(bent, counted(bent, "polygon is", "polygons are") +
                   fmt::format(" not flat (by up to {:.2g} of the size): felt as triangles", most_bent));
    note(nothing, counted(nothing, "polygon", "polygons") + " without an area are left out");
    note(soup.points_and_lines,
         counted(soup.points_and_lines, "point or line is", "points and lines are") + " left out");
    if (file.triangles.empty()) bad(path, "none of its polygons has an area; give a surface");
    return file;
}

std::vector<std::string> notes_of(const knurl::MeshNotes& n) {
    std::vector<std::string> lines;
    const auto note = [&](std::uint64_t count, const char* what) {
        if (count > 0) lines.push_back(fmt::format("{} {}", count, what));
    };
    note(n.vertices_not_finite, "vertices are no numbers, or beyond 1e7 m: their triangles are left out");
    note(n.vertices_far, "vertices lie far from all others: their triangles are left out");
    note(n.vertices_welded, "vertices became one with a neighbour");
    note(n.faces_degenerate, "triangles without an area are left out");
    note(n.faces_duplicate, "triangles that were there twice are left out");
    note(n.faces_turned, "triangles were wound against their neighbours and are turned");
    note(n.edges_open, "edges are open: past them the hand slips off");
    note(n.edges_non_manifold, "edges have more than two triangles");
    note(n.faces_cut, "triangles cross or touch others and are cut there");
    note(n.faces_crossed, "triangles cross others");
    if (n.not_united > 0)
        lines.push_back(
            "parts that meet could not be cut soundly: a hand may find a way in where they touch");
    return lines;
}

}  // namespace knurl::meshfile
