// A wall, 5 mm above the middle of the workspace: it lifts the hand that rests there.
// Run `knurld --device sim:cartesian3` first.

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <knurl/client/client.hpp>

#include "seconds.hpp"

using namespace std::chrono_literals;

int main(int argc, char** argv) try {
    const auto end = examples::end_of(argc, argv);

    auto client = knurl::Client::connect("knurl:default");
    auto hand = client.claim();                                      // the only device; refused: who holds it
    const double height = hand.device().workspace_centre.z + 0.005;  // m
    auto floor = hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = height, .stiffness = 800 /* N/m */});
    hand.arm();

    double strongest = 0, depth = 0;  // N, m
    while (auto frame = hand.newest(50ms)) {
        hand.commit();  // "I am alive": a silent application's force fades
        if (auto feedback = floor.feedback()) strongest = std::max(strongest, feedback->force.z);
        depth = height - frame->position.z;
        if (std::chrono::steady_clock::now() > end) break;
    }
    std::printf("strongest %.2f N; at the end %.2f mm deep\n", strongest, depth * 1e3);
} catch (const std::exception& error) {
    return std::fprintf(stderr, "01_wall: %s\n", error.what()), 1;
}
