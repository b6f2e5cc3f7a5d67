// A spring that holds the hand at a point, and the point jumps: the servo moves the spring's end there
// linearly.

#include <chrono>
#include <cstdio>

#include <knurl/client/client.hpp>
#include <knurl/reps/spring.hpp>

#include "seconds.hpp"

using namespace std::chrono_literals;

int main(int argc, char** argv) try {
    const auto end = examples::end_of(argc, argv);

    auto client = knurl::Client::connect("knurl:default");
    auto hand = client.claim();
    const knurl::Vec3 home = hand.device().workspace_centre;
    auto spring =
        hand.add(knurl::Spring{.anchor = home, .stiffness = 150 /* N/m */, .damping = 2 /* N s/m */});
    hand.arm();

    auto jump = std::chrono::steady_clock::now() + 1s;
    for (bool aside = true; std::chrono::steady_clock::now() < end;) {
        const auto frame = hand.newest(50ms);
        if (!frame) throw std::runtime_error("no report for 50 ms: has the servo gone?");
        if (std::chrono::steady_clock::now() > jump) {
            auto params = spring.params();
            params.anchor.x = home.x + (aside ? 0.02 : 0.0);  // m
            spring.set(params);
            const auto feedback = spring.feedback();
            std::printf("hand at x = %+5.1f mm, spring pulls %+5.2f N, end moves to %+5.1f mm\n",
                        frame->position.x * 1e3, feedback ? feedback->force.x : 0.0, params.anchor.x * 1e3);
            aside = !aside;
            jump += 1s;
        }
        hand.commit();
    }
} catch (const std::exception& error) {
    return std::fprintf(stderr, "02_spring: %s\n", error.what()), 1;
}
