// No servo runs, so the program must be told that there is none.
#include <chrono>
#include <cstdio>

#include <knurl/client/client.hpp>

int main() {
    using namespace std::chrono_literals;
    try {
        auto client = knurl::Client::connect("knurl:nobody-listens-here", {.name = "outside", .wait = 0ms});
        auto hand = client.claim();
        auto floor = hand.add(knurl::Plane{.stiffness = 800 /* N/m */});
        hand.arm();
        hand.commit();
    } catch (const knurl::Error& error) {
        std::printf("%s\n", error.what());
        return error.kind == knurl::Error::Kind::no_servo ? 0 : 1;
    }
    return 1;
}
