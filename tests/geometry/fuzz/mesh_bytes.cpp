// Any bytes as a mesh, and hands on what is made of it. Whatever was given, the builder makes a mesh within
// its budget or refuses in one line; on a mesh every cycle keeps to its limits, and what is felt is finite
// and of that mesh. First the form (8 bytes), then vertices, then triangles; the rest moves the hand.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <knurl/geometry/mesh.hpp>
#include <knurl/geometry/proxy.hpp>

using namespace knurl;

namespace {

void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "broken: %s\n", what);
    std::abort();
}

/// After the end it goes on by chance: a few bytes already make a mesh of many vertices.
class Input {
  public:
    explicit Input(std::span<const std::uint8_t> bytes) : rest_(bytes) {
        for (const std::uint8_t byte : bytes) chance_ = (chance_ ^ byte) * 0x100000001b3;
    }
    template <class T>
    T next() {
        std::uint8_t bytes[sizeof(T)];
        for (std::uint8_t& byte : bytes) {
            if (rest_.empty()) {
                chance_ = chance_ * 6364136223846793005 + 1442695040888963407;
                byte = static_cast<std::uint8_t>(chance_ >> 56);
            } else {
                byte = rest_.front();
                rest_ = rest_.subspan(1);
            }
        }
        T value;
        std::memcpy(&value, bytes, sizeof value);
        return value;
    }

  private:
    std::span<const std::uint8_t> rest_;
    std::uint64_t chance_ = 0xcbf29ce484222325;
};

enum Form : unsigned { any_double, any_float, steps, far_steps };  // of a coordinate
struct Form8 {
    std::uint8_t vertices, triangles, coordinates, flags, weld, budget, hands, unused;
};

double coordinate(Input& input, unsigned form) {
    switch (form) {
        case any_double:
            return input.next<double>();
        case any_float:
            return input.next<float>();
        // Few places: many vertices meet, many triangles have no area or lie on each other.
        case steps:
            return input.next<std::int8_t>() / 8 * 0.01;
        default:
            return 1e6 + input.next<std::int8_t>() * 1e-5;
    }
}

void check(const Foot& foot, const Mesh& mesh, std::size_t triangles) {
    require(foot.point.allFinite() && foot.normal.allFinite() && std::isfinite(foot.depth),
            "a foot is finite");
    require(foot.depth >= 0, "a depth is not negative");
    require(std::fabs(foot.normal.norm() - 1) < 1e-6, "a normal has length 1");
    require(foot.face < mesh.faces() && foot.triangle < triangles, "a foot is of the mesh");
    require(shaded_normal(mesh, foot).allFinite(), "a shaded normal is finite");
    const double slack = 1e-6 * (mesh.high - mesh.low).norm() + 1e-9 * mesh.high.cwiseAbs().maxCoeff();
    require(((foot.point - mesh.low).array() >= -slack).all() &&
                ((mesh.high - foot.point).array() >= -slack).all(),
            "a foot lies in the mesh's box");
}

void move_about(const Mesh& mesh, Input& input, double radius, std::size_t triangles) {
    const Eigen::Vector3d middle = (mesh.low + mesh.high) / 2, half = (mesh.high - mesh.low) / 2;
    const double size = half.norm();
    Proxy proxy;
    Eigen::Vector3d hand = mesh.high + 0.1 * half;
    for (int cycle = 0; cycle < 200; ++cycle) {
        const auto how = input.next<std::uint8_t>();
        Eigen::Vector3d by;
        for (double& x : by) x = input.next<std::int8_t>() / 128.0;
        if (how < 8) {
            hand = middle + 1.5 * half.cwiseProduct(by);  // elsewhere at once
        } else if (how == 8) {
            hand[cycle % 3] = std::numeric_limits<double>::quiet_NaN();
        } else if (how == 9) {
            hand[cycle % 3] = std::numeric_limits<double>::infinity();
        } else if (how == 10) {
            hand *= 1e200;
        } else {
            hand += 0.05 * size * by;
        }
        Foot foot;
        Work work;
        if (how == 11) adopt(mesh, proxy, hand, work);
        const bool touches = follow(mesh, proxy, hand, radius, foot, work);
        require(work.faces <= max_walk_faces && work.sweeps <= max_sweeps &&
                    work.pieces <= max_pieces * max_sweeps && work.nodes <= max_nodes &&
                    work.fans <= max_fans && work.tangles <= max_tangles,
                "a cycle's work is bounded");
        if (touches) check(foot, mesh, triangles);
        if (!hand.allFinite() || hand.cwiseAbs().maxCoeff() > 1e100) hand = middle + 0.6 * half;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Input input({data, size});
    const auto form = input.next<Form8>();
    std::vector<Point3> vertices(form.vertices);
    for (Point3& v : vertices) {
        for (double& x : v) x = coordinate(input, form.coordinates & 3);
    }
    std::vector<Triangle> triangles(form.triangles);
    for (Triangle& t : triangles) {
        for (std::uint32_t& i : t) {
            i = input.next<std::uint8_t>();
            if (form.flags & 4) i %= form.vertices + 1U;  // rarely out of range
        }
    }
    std::vector<std::uint8_t> materials;
    if (form.flags & 8) materials.resize(triangles.size() + (form.flags & 16 ? 1 : 0), 3);
    MeshBuild how{.exact = (form.flags & 1) != 0,
                  .weld = form.weld == 0     ? 0
                          : form.weld == 255 ? std::numeric_limits<double>::quiet_NaN()
                                             : std::pow(0.5, form.weld % 30),
                  .budget = std::size_t{form.budget} << 14,
                  .find_crossings = (form.flags & 2) == 0};
    int asked = 0;
    if (form.flags & 32) how.go_on = [&] { return ++asked < form.hands; };
    try {
        const Mesh mesh({.vertices = vertices, .triangles = triangles, .materials = materials}, how);
        require(mesh.faces() > 0, "a mesh has faces");
        require(mesh.bytes() <= how.budget, "a mesh keeps to its budget");
        require(
            mesh.low.allFinite() && mesh.high.allFinite() && (mesh.low.array() <= mesh.high.array()).all(),
            "a mesh has a box");
        move_about(mesh, input, form.hands & 1 ? 0.01 * (mesh.high - mesh.low).norm() : 0, triangles.size());
    } catch (const MeshError& refused) {
        const std::string why = refused.what();
        require(!why.empty() && why.find('\n') == std::string::npos, "a refusal is one line");
    }
    return 0;
}
