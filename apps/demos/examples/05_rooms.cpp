// One program, the hands of several rooms: a floor on a device of each servo that is named, wherever in the domain it is.
// Run a `knurl-dds` on each servo's host and on this one first, then `05_rooms knurl://left/right knurl://attic/hand`.
// Prints how far each room's clock is from this one's, and how sure that is: what brings their reports onto one time base.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <knurl/client/client.hpp>

using namespace std::chrono_literals;

namespace {

struct Room {
    knurl::Client client;
    knurl::Claim hand;
    knurl::Handle<knurl::Plane> floor;
    double highest = 0;  // N
};

Room enter(const std::string& address) {
    auto client = knurl::Client::connect(address, {.name = "05_rooms"});
    auto hand = client.claim();                                      // the device that the address names
    const double height = hand.device().workspace_centre.z + 0.005;  // m
    auto floor = hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = height, .stiffness = 500 /* N/m */});
    hand.arm();
    return {std::move(client), std::move(hand), floor};
}

double milliseconds(std::chrono::nanoseconds time) {
    return static_cast<double>(time.count()) * 1e-6;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 2) return std::fprintf(stderr, "05_rooms: name servos, as knurl://left/right\n"), 2;
    std::vector<Room> rooms;
    for (int i = 1; i < argc; ++i) rooms.push_back(enter(argv[i]));
    for (const auto end = std::chrono::steady_clock::now() + 3s; std::chrono::steady_clock::now() < end;) {
        for (Room& room : rooms) {
            if (const auto frame = room.hand.newest(20ms))
                room.highest = std::max(room.highest, frame->sent_force.z);
            room.hand.commit();  // "I am alive": a silent application's force fades
        }
    }
    for (std::size_t i = 0; i < rooms.size(); ++i) {
        const knurl::Network network = rooms[i].hand.network();
        std::printf("%s: at most %.2f N; its clock is %+.3f ms from this host's, within %.3f ms\n",
                    argv[i + 1], rooms[i].highest, milliseconds(network.clock_offset),
                    milliseconds(network.clock_uncertainty));
    }
} catch (const std::exception& error) {
    return std::fprintf(stderr, "05_rooms: %s\n", error.what()), 1;
}
