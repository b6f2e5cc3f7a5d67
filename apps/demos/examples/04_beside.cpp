// A floor, 10 mm below the middle of the workspace, on a device that another program holds as well: both say
// that they share, as `knurl-dock --share` does. The hand feels the sum; either may end, or be killed.

#include <chrono>
#include <cstdio>

#include <knurl/client/client.hpp>

#include "seconds.hpp"

using namespace std::chrono_literals;

int main(int argc, char** argv) try {
    const auto end = examples::end_of(argc, argv);

    auto client = knurl::Client::connect("knurl:default");
    auto hand = client.claim("", {.shared = true});
    const double height = hand.device().workspace_centre.z - 0.01;  // m
    auto floor = hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = height, .stiffness = 800 /* N/m */});
    hand.arm();
    std::printf("the floor is there\n");
    std::fflush(stdout);

    auto next = std::chrono::steady_clock::now();
    while (auto frame = hand.newest(50ms)) {
        hand.commit();  // "I am alive": a silent application's force fades
        const auto now = std::chrono::steady_clock::now();
        if (now > end) break;
        const auto feedback = floor.feedback();
        if (now < next || !feedback) continue;
        next += 1s;
        std::printf("%.2f N of the floor, %.2f N in all\n", knurl::to_eigen(feedback->force).norm(),
                    knurl::to_eigen(frame->scene_force).norm());
    }
} catch (const std::exception& error) {
    return std::fprintf(stderr, "04_beside: %s\n", error.what()), 1;
}
