// The cost per cycle of many representations without effect on the hand, by kind: distant ones, and ones with
// default parameters, most of which give no force. callgrind counts `counted_cycles`; far_kinds.py judges.
// Usage: knurl_cycles_of_far_things N: prints a line for each call, in order.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <knurl/reps/all.hpp>
#include <knurl/reps/scene.hpp>

using namespace knurl;

namespace {

constexpr double far_away = 10;  // m
constexpr int cycles = 100;

struct Kept {
    std::vector<Feedback> entries;
    std::vector<std::uint64_t> wholly, flags;
};

Probe hand_at(int cycle) {
    Probe hand;
    hand.position = {1e-6 * (cycle % 100), 2e-6 * (cycle % 50), 1e-6 * (cycle % 70)};
    return hand;
}

void cycle_of(Scene& scene, Kept& kept, int cycle, double& sum) {
    sum += scene.evaluate(hand_at(cycle), 1e-3).force.z();
    sum += static_cast<double>(scene.feedback(kept.entries, {.wholly = kept.wholly, .flags = kept.flags}));
    sum += scene.load_bound().effects;
}

}  // namespace

namespace {
struct Counted {
    Scene& scene;
    Kept& kept;
    double sum = 0;
};
}  // namespace

// A name for callgrind, not inlined.
extern "C" [[gnu::noinline]] void counted_cycles(void* what) {
    auto& [scene, kept, sum] = *static_cast<Counted*>(what);
    for (int i = 0; i < cycles; ++i) cycle_of(scene, kept, i, sum);
}

namespace {

/// Any kind with a place (m), away from the hand.
template <class R>
void put_away(R& params) {
    for (const Field& field : Describe<R>::fields) {
        char* const at = reinterpret_cast<char*>(&params) + field.offset;
        const bool place = field.name == "center" || field.name == "position" || field.name == "origin" ||
                           field.name == "foot" || field.name == "vertices";
        const std::size_t points = field.type == Field::Type::points ? field.count : 1;
        for (std::size_t i = 0; place && i < points; ++i) {
            double z;
            std::memcpy(&z, at + (3 * i + 2) * sizeof z, sizeof z);
            z -= far_away;
            std::memcpy(at + (3 * i + 2) * sizeof z, &z, sizeof z);
        }
    }
    if constexpr (requires { params.stiffness; }) params.stiffness = 500;
    if constexpr (requires { params.offset; }) params.offset = -far_away;
    if constexpr (requires { params.force; }) params.force = {0, 0, 1};
    if constexpr (requires { params.max_distance; }) params.max_distance = 0.02;
}

template <class R>
void count(const R& params, const char* what, std::uint32_t n) {
    Scene scene({.representations = std::max(1u, n), .probes = 1}, {.max_force = 8.5});
    Kept kept{std::vector<Feedback>(n), std::vector<std::uint64_t>(n / 64 + 1),
              std::vector<std::uint64_t>(n / 64 + 1)};
    for (std::uint32_t i = 0; i < n; ++i) {
        if (!scene.add({i, 1}, params)) std::exit(2);
    }
    scene.settle();
    double sum = 0;
    for (int i = 0; i < cycles; ++i) cycle_of(scene, kept, i, sum);  // takes the new ones
    Counted run{scene, kept};
    counted_cycles(&run);
    sum += run.sum;
    std::printf("%s %s\n", n == 0 ? "none" : std::string(Describe<R>::name).c_str(), what);
    if (!(sum == sum)) std::exit(2);
}

template <class... R>
void count_all(TypeList<R...>, std::uint32_t n) {
    const auto each = [&]<class T>(T params) {
        count(params, "default", n);
        put_away(params);
        count(params, "far", n);
    };
    (each(R{}), ...);
}

}  // namespace

int main(int count_of, char** words) {
    const int n = count_of > 1 ? std::atoi(words[1]) : 1000;
    count(Plane{}, "", 0);
    count_all(Representations{}, static_cast<std::uint32_t>(n));
    return 0;
}
