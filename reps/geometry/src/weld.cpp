// Merges equal vertices and drops triangles without area.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "build.hpp"

namespace knurl::build {
namespace {

constexpr std::uint32_t none = 0xffffffff;

std::uint64_t mixed(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    std::uint64_t h = a * 0x9e3779b97f4a7c15 ^ std::rotl(b * 0xc2b2ae3d27d4eb4f, 23) ^
                      std::rotl(c * 0x165667b19e3779f9, 41);
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93;
    return h ^ h >> 32;
}

/// Hash table: chains of entries by key.
class Table {
  public:
    explicit Table(std::size_t entries)
        : heads_(std::bit_ceil(std::max<std::size_t>(entries, 16)), none), mask_(heads_.size() - 1) {
        next_.reserve(entries);
    }
    void prefetch(std::uint64_t key) const { __builtin_prefetch(&heads_[key & mask_]); }
    std::uint32_t first(std::uint64_t key) const { return heads_[key & mask_]; }
    std::uint32_t next(std::uint32_t entry) const { return next_[entry]; }
    std::uint32_t size() const { return static_cast<std::uint32_t>(next_.size()); }
    void add(std::uint64_t key) {  // appends entry size()
        const auto entry = size();
        next_.push_back(heads_[key & mask_]);
        heads_[key & mask_] = entry;
    }
    void add_nothing() { next_.push_back(none); }

  private:
    std::vector<std::uint32_t> heads_, next_;
    std::size_t mask_;
};

double square(const Point3& a, const Point3& b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/// Calls `with(v, key)` for v = 0 .. n - 1, with the key's entry prefetched.
template <class Key, class With>
void ahead(std::size_t n, const Table& table, Slices& slices, Key key_of, With with) {
    std::array<std::uint64_t, 32> keys;
    for (std::size_t v = 0; v < n; v += keys.size()) {
        const std::size_t some = std::min(keys.size(), n - v);
        for (std::size_t i = 0; i < some; ++i) table.prefetch(keys[i] = key_of(v + i));
        for (std::size_t i = 0; i < some; ++i, slices(2)) with(static_cast<std::uint32_t>(v + i), keys[i]);
    }
}

/// Numbers the places of the vertices; equal vertices share a place. Vertices outside the frame have none.
std::vector<std::uint32_t> number_places(const Triangles& given, const Frame& frame, std::vector<Point3>& at,
                                         Slices& slices) {
    const auto place = [&](std::size_t v) {
        const Point3& p = given.vertices[v];
        return Point3{p[0] - frame.origin[0] + 0.0, p[1] - frame.origin[1] + 0.0,
                      p[2] - frame.origin[2] + 0.0};
    };
    Table table(given.vertices.size());
    std::vector<std::uint32_t> number;
    number.reserve(given.vertices.size());
    ahead(
        given.vertices.size(), table, slices,
        [&](std::size_t v) {
            const Point3 p = place(v);
            return mixed(std::bit_cast<std::uint64_t>(p[0]), std::bit_cast<std::uint64_t>(p[1]),
                         std::bit_cast<std::uint64_t>(p[2]));
        },
        [&](std::uint32_t v, std::uint64_t key) {
            if (!frame.holds(given.vertices[v])) return number.push_back(none);
            const Point3 p = place(v);
            std::uint32_t same = table.first(key);
            for (; same != none && at[same] != p; same = table.next(same)) slices();
            if (same == none) {
                same = table.size();
                table.add(key);
                at.push_back(p);
            }
            number.push_back(same);
        });
    return number;
}

/// For each place, the place that it becomes. Not transitive: nothing moves farther than the tolerance. The
/// remaining places are farther apart than that, so a cell holds no more than some thousands, whatever the
/// input.
std::vector<std::uint32_t> near_ones(const std::vector<Point3>& at, double tolerance, Slices& slices) {
    const double cell = 16 * tolerance, square_tolerance = tolerance * tolerance;
    const auto in = [cell](double x) { return static_cast<std::int64_t>(std::floor(x / cell)); };
    const auto key_of = [](std::int64_t x, std::int64_t y, std::int64_t z) {
        return mixed(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                     static_cast<std::uint64_t>(z));
    };
    Table table(at.size());
    std::vector<std::uint32_t> becomes;
    becomes.reserve(at.size());
    ahead(
        at.size(), table, slices,
        [&](std::size_t v) { return key_of(in(at[v][0]), in(at[v][1]), in(at[v][2])); },
        [&](std::uint32_t v, std::uint64_t key) {
            const Point3& p = at[v];
            std::array<std::int64_t, 3> low, high;
            for (std::size_t k = 0; k < 3; ++k) {
                low[k] = in(p[k] - tolerance);
                high[k] = in(p[k] + tolerance);
            }
            std::uint32_t nearest = none;
            double least = square_tolerance;
            for (std::int64_t x = low[0]; x <= high[0]; ++x) {
                for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
                        std::uint32_t seen = 0;
                        for (std::uint32_t o = table.first(key_of(x, y, z)); o != none;
                             o = table.next(o), ++seen) {
                            const double d = square(at[o], p);
                            if (d <= least) least = d, nearest = o;
                        }
                        slices(seen / 4);
                    }
                }
            }
            if (nearest == none) {
                table.add(key);
                becomes.push_back(v);
            } else {
                table.add_nothing();
                becomes.push_back(nearest);
            }
        });
    return becomes;
}

/// Keeps only the remaining places; `becomes` then holds their new numbers.
void keep_survivors(std::vector<Point3>& at, std::vector<std::uint32_t>& becomes, bool as_float,
                    Slices& slices) {
    std::uint32_t kept = 0;
    for (std::uint32_t v = 0; v < at.size(); ++v, slices()) {
        // A place becomes an earlier one, which has its new number already.
        if (!becomes.empty()) {
            if (becomes[v] != v) {
                becomes[v] = becomes[becomes[v]];
                continue;
            }
            becomes[v] = kept;
        }
        at[kept] = at[v];
        if (as_float) {
            for (double& x : at[kept]) x = static_cast<float>(x);
        }
        ++kept;
    }
    at.resize(kept);
}

/// A triangle's height over its longest edge (m), and that edge. For a point the height is NaN.
std::pair<double, double> height(const Point3& a, const Point3& b, const Point3& c) {
    const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const double longest = std::sqrt(std::max({square(a, b), square(b, c), square(c, a)}));
    return {std::sqrt(nx * nx + ny * ny + nz * nz) / longest, longest};
}

/// Two places that were not close stay separate where a triangle names both.
void keep_apart(const Triangles& given, const std::vector<std::uint32_t>& number,
                const std::vector<Point3>& at, double near, std::vector<std::uint32_t>& becomes,
                Slices& slices) {
    for (std::size_t t = 0; t < given.triangles.size(); ++t, slices()) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = number[given.triangles[t][k]],
                                b = number[given.triangles[t][(k + 1) % 3]];
            if (a == none || b == none || a == b || becomes[a] != becomes[b]) continue;
            if (square(at[a], at[b]) <= near * near) continue;
            const std::uint32_t apart = becomes[a] == a ? b : a;
            becomes[apart] = apart;
        }
    }
}

/// Numbers vertices by the places that stay. Returns how many have one.
std::uint64_t number_survivors(std::vector<std::uint32_t>& number, const std::vector<std::uint32_t>& becomes,
                               Slices& slices) {
    std::uint64_t named = 0;
    for (std::uint32_t& n : number) {
        slices();
        if (n == none) continue;
        ++named;
        if (!becomes.empty()) n = becomes[n];
    }
    return named;
}

/// The triangles whose corners all have a place, and that have an area.
void add_faces(const Triangles& given, const std::vector<std::uint32_t>& number, const Frame& frame,
               Faces& faces, MeshNotes& notes, Slices& slices) {
    faces.corners.reserve(given.triangles.size());
    faces.given.reserve(given.triangles.size());
    for (std::size_t t = 0; t < given.triangles.size(); ++t, slices(2)) {
        Triangle corners;
        for (std::size_t k = 0; k < 3; ++k) corners[k] = number[given.triangles[t][k]];
        const auto [a, b, c] = corners;
        if (a == none || b == none || c == none) {
            ++notes.faces_dropped;
            continue;
        }
        const auto [high, longest] = height(faces.at[a], faces.at[b], faces.at[c]);
        if (!(high > std::max(1e-10 * longest, frame.noise))) {
            ++notes.faces_degenerate;
            continue;
        }
        faces.corners.push_back(corners);
        faces.given.push_back(static_cast<std::uint32_t>(t));
    }
}

}  // namespace

double tolerance(const Frame& frame, const MeshBuild& how) {
    return how.weld * std::min(frame.size, 16 * frame.spread);
}

Faces weld(const Triangles& given, const Frame& frame, const MeshBuild& how, MeshNotes& notes,
           Slices& slices) {
    slices.ask();
    Faces faces;
    faces.at.reserve(given.vertices.size());
    std::vector<std::uint32_t> number = number_places(given, frame, faces.at, slices);

    const double near = tolerance(frame, how);
    std::vector<std::uint32_t> becomes;
    if (near > std::ldexp(frame.size, -40)) {
        becomes = near_ones(faces.at, near, slices);
        keep_apart(given, number, faces.at, near, becomes, slices);
    }
    keep_survivors(faces.at, becomes, !how.exact, slices);
    notes.vertices_welded = number_survivors(number, becomes, slices) - faces.at.size();
    add_faces(given, number, frame, faces, notes, slices);
    return faces;
}

}  // namespace knurl::build
