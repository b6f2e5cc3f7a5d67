// A scene of planes and springs, run to count the instructions of `evaluate` with callgrind: once in a build
// with all kinds and once in one with only these. unused_kinds.py compares.

#include <cstdio>
#include <cstdlib>

#include <knurl/reps/all.hpp>
#include <knurl/reps/scene.hpp>

using namespace knurl;

int main(int count, char** words) {
    const int cycles = count > 1 ? std::atoi(words[1]) : 1000;
    Scene scene({.representations = 64, .probes = 2}, {.max_force = 8.5});
    bool added = static_cast<bool>(scene.add({0, 1}, Plane{.normal = {0, 0, 1}, .stiffness = 1000}));
    added = scene.add({1, 1}, Plane{.normal = {1, 0, 0.3}, .stiffness = 500}) && added;
    added = scene.add({2, 1}, Plane{.normal = {0, 1, 0.3}, .stiffness = 1000}) && added;
    added =
        scene.add({3, 1}, Spring{.anchor = {0.01, 0, 0}, .rest_length = 0.002, .stiffness = 100}) && added;
    added =
        scene.add({4, 1}, Spring{.anchor = {0, 0.01, 0}, .attach = {0, 0.01, 0}, .stiffness = 100}) && added;
    added = scene.add({5, 1}, ConstantForce{.force = {0, 0, 1}}) && added;
    scene.settle();
    double sum = 0;
    for (int i = 0; i < cycles; ++i) {
        Probe probe;
        probe.position = {1e-6 * (i % 100), 2e-6 * (i % 50), -0.001 + 4e-5 * (i % 50)};
        sum += scene.evaluate(probe, 1e-3).force.z();
    }
    std::printf("%zu kinds, sum of forces %.9g N\n", Representations::size, sum);
    return added ? 0 : 1;
}
