#include "stroke.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <knurl/geometry/proxy.hpp>
#include <knurl/measure/output_file.hpp>

namespace feel {

namespace {

using Eigen::Vector3d;

constexpr int around = 720;    // directions of an outline
constexpr double smooth = 12;  // in directions, standard deviation

/// How far from the middle a ray from outside meets the surface; without a meeting: a tenth of the size.
double radius_along(const knurl::Mesh& mesh, const Vector3d& middle, const Vector3d& out, double size) {
    knurl::Proxy proxy;
    const double step = size / 512;
    for (double r = 0.75 * size; r > 0; r -= step) {
        knurl::Foot foot;
        knurl::Work work;
        if (knurl::follow(mesh, proxy, middle + r * out, 0, foot, work)) return r + foot.depth;
    }
    return 0.1 * size;
}

std::vector<double> smoothed(const std::vector<double>& ring) {
    std::vector<double> result(ring.size());
    const int reach = static_cast<int>(3 * smooth), n = static_cast<int>(ring.size());
    for (int i = 0; i < n; ++i) {
        double sum = 0, weights = 0;
        for (int j = -reach; j <= reach; ++j) {
            const double weight = std::exp(-0.5 * (j / smooth) * (j / smooth));
            sum += weight * ring[static_cast<std::size_t>((i + j + n) % n)];
            weights += weight;
        }
        result[static_cast<std::size_t>(i)] = sum / weights;
    }
    return result;
}

}  // namespace

std::vector<Row> make_stroke(const knurl::Mesh& mesh, const StrokeOptions& options) {
    const Vector3d middle = (mesh.low + mesh.high) / 2;
    const double size = (mesh.high - mesh.low).norm();
    std::vector<Row> rows;
    double t = 0;
    const auto go_to = [&](const Vector3d& where) {
        if (!rows.empty()) t += std::max(1e-3, (where - rows.back().position).norm() / options.speed);
        rows.push_back({.t = t, .position = where});
    };
    const Vector3d axes[] = {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    for (int ring = 0; ring < 3; ++ring) {
        const Vector3d &u = axes[ring], &v = axes[(ring + 1) % 3];
        const auto direction = [&](int i) -> Vector3d {
            const double angle = 2 * M_PI * i / around;
            return std::cos(angle) * u + std::sin(angle) * v;
        };
        std::vector<double> outline(around);
        for (int i = 0; i < around; ++i)
            outline[static_cast<std::size_t>(i)] = radius_along(mesh, middle, direction(i), size);
        const std::vector<double> path = smoothed(outline);
        const double above = *std::max_element(outline.begin(), outline.end()) + options.clearance;
        go_to(middle + above * direction(0));
        for (int i = 0; i <= around; ++i)
            go_to(middle + (path[static_cast<std::size_t>(i % around)] - options.press) * direction(i));
        go_to(middle + above * direction(0));
        // Around the outside to where the next ring begins.
        for (int i = 1; i <= around / 4; ++i) go_to(middle + above * direction(i));
    }
    return rows;
}

void write_stroke(const std::string& path, const std::vector<Row>& rows, const Vector3d& offset) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "t,x,y,z\n");
    for (const Row& row : rows) {
        const Vector3d at = row.position + offset;
        fmt::format_to(out, "{:.6f},{:.9g},{:.9g},{:.9g}\n", row.t, at.x(), at.y(), at.z());
    }
    knurl::measure::write_file(path, fmt::to_string(text));
}

}  // namespace feel
