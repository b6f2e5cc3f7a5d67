// The application of scripts/unit-test: a floor under the hand. It arms again whenever the servo is back or a fault
// is over, and prints a line for each report that it reads: seconds, the device's state, the force.

#include <chrono>
#include <cstdio>

#include <knurl/client/client.hpp>

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

int main(int argc, char** argv) try {
    auto client = knurl::Client::connect(argc > 1 ? argv[1] : "knurl:default", {.wait = 10s, .hints = false});
    auto hand = client.claim();
    auto floor =
        hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = 0.005 /* m */, .stiffness = 800 /* N/m */});
    hand.arm();
    auto armed = Clock::now();
    for (;;) {
        const auto frame = hand.newest(50ms);
        const double now = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
        if (!frame) {
            std::printf("%.4f none 0\n", now);
        } else {
            std::printf("%.4f %u %.3f\n", now, static_cast<unsigned>(frame->state), frame->sent_force.z);
            hand.commit();
            const bool fault = frame->state == knurl::DeviceState::fault;
            if ((fault || frame->state == knurl::DeviceState::idle) && Clock::now() - armed > 200ms) {
                armed = Clock::now();
                try {
                    if (fault) hand.reset_fault();  // in a virtual machine that had no time for the servo
                    hand.arm();
                } catch (const knurl::Error& error) {  // the servo has gone again, or the hand moves
                    std::fprintf(stderr, "hand: %s\n", error.what());
                }
            }
        }
        std::fflush(stdout);
    }
} catch (const std::exception& error) {
    return std::fprintf(stderr, "hand: %s\n", error.what()), 1;
}
