// A wall. Run `knurld` first, then this: push below z = 0.

#include <chrono>
#include <cstdio>

#include <knurl/client/client.hpp>

#include "seconds.hpp"

using namespace std::chrono_literals;

int main(int argc, char** argv) try {
    const auto end = examples::end_of(argc, argv);

    auto client = knurl::Client::connect("knurl:default");
    auto hand = client.claim();  // the only device; refused: who holds it
    auto floor =
        hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = 0.0 /* m */, .stiffness = 800 /* N/m */});
    hand.arm();

    double deepest = 0, strongest = 0;
    while (auto report = hand.next_report(50ms)) {
        hand.commit();  // "I am alive": a silent application's force fades
        deepest = std::min(deepest, report->position.z);
        if (auto felt = floor.felt()) strongest = std::max(strongest, felt->force.z);
        if (std::chrono::steady_clock::now() > end) break;
    }
    std::printf("deepest %.1f mm, strongest %.2f N\n", deepest * 1e3, strongest);
} catch (const std::exception& error) {
    return std::fprintf(stderr, "01_wall: %s\n", error.what()), 1;
}
