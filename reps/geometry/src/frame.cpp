// Which vertices are plausible, and the bounding box of those that triangles use.

#include <algorithm>
#include <cmath>
#include <limits>

#include "build.hpp"

namespace knurl::build {
namespace {

constexpr double far_away = 1e7;     // m
constexpr double implausible = 1e3;  // times the spread

bool finite(const Point3& p) {
    return std::abs(p[0]) < far_away && std::abs(p[1]) < far_away && std::abs(p[2]) < far_away;
}

double length(const Point3& a, const Point3& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

std::vector<bool> named(const Triangles& given, Slices& slices) {
    std::vector<bool> used(given.vertices.size());
    Named wrong;
    std::uint32_t index = 0;
    for (std::size_t t = 0; t < given.triangles.size(); ++t, slices()) {
        for (const std::uint32_t v : given.triangles[t]) {
            if (v < used.size()) {
                used[v] = true;
            } else {
                if (wrong.count() == 0) index = v;
                wrong.add(t);
                break;
            }
        }
    }
    if (wrong.count() > 0)
        throw MeshError(wrong.text() + " of the mesh: a vertex number is out of range (" +
                        std::to_string(index) + ", but there are " + std::to_string(used.size()) +
                        " vertices, counted from 0); send all vertices, and numbers below that");
    return used;
}

/// The middle half of a sample along each axis, or a larger part if the half is a point. {median, diagonal}
std::pair<Point3, double> middle(std::vector<Point3>& sample) {
    Point3 median{};
    for (std::size_t share = 4;; share *= 4) {
        Point3 low{}, high{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto by = [k](const Point3& a, const Point3& b) { return a[k] < b[k]; };
            const auto at = [&](std::size_t n) {
                std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(n),
                                 sample.end(), by);
                return sample[n][k];
            };
            const std::size_t last = sample.size() - 1, left_out = last / share;
            low[k] = at(left_out);
            high[k] = at(last - left_out);
            median[k] = at(last / 2);
        }
        const double spread = length(low, high);
        if (spread > 0 || share > sample.size()) return {median, spread};
    }
}

}  // namespace

Frame find_frame(const Triangles& given, bool exact, MeshNotes& notes, Slices& slices) {
    slices.ask();
    const std::vector<bool> used = named(given, slices);
    const std::size_t step = used.size() / 4096 + 1;
    std::vector<Point3> sample;
    sample.reserve(std::min<std::size_t>(used.size(), 4097));
    std::size_t next = 0;
    for (std::size_t v = 0; v < used.size(); ++v, slices()) {
        if (!used[v]) continue;
        if (!finite(given.vertices[v])) {
            ++notes.vertices_not_finite;
        } else if (v >= next) {
            sample.push_back(given.vertices[v]);
            next = v + step;
        }
    }
    Frame frame;
    if (sample.empty()) return frame;
    const auto [median, spread] = middle(sample);
    frame.spread = spread;
    const double reach = spread > 0 ? implausible * spread : std::numeric_limits<double>::infinity();
    frame.low.fill(std::numeric_limits<double>::infinity());
    frame.high.fill(-std::numeric_limits<double>::infinity());
    double farthest = 0;
    for (std::size_t v = 0; v < used.size(); ++v, slices()) {
        const Point3& p = given.vertices[v];
        if (!used[v] || !finite(p)) continue;
        if (std::max({std::abs(p[0] - median[0]), std::abs(p[1] - median[1]), std::abs(p[2] - median[2])}) >
            reach) {
            ++notes.vertices_far;
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            frame.low[k] = std::min(frame.low[k], p[k]);
            frame.high[k] = std::max(frame.high[k], p[k]);
            farthest = std::max(farthest, std::abs(p[k]));
        }
    }
    frame.size = length(frame.low, frame.high);
    if (!(frame.size > 0)) return frame;
    // Rounds to a grid that is coarse relative to the mesh, so that corners with few digits keep them.
    const double grid = std::ldexp(1.0, std::ilogb(frame.size) - 8);
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        frame.origin[k] = std::round((frame.low[i] + frame.high[i]) / 2 / grid) * grid;
    }
    frame.noise = std::max(exact ? 0 : std::ldexp(frame.size, -24), std::ldexp(farthest, -51));
    return frame;
}

}  // namespace knurl::build
