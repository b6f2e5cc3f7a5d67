// wall --socket PATH --way plane|force --stiffness K --rate R --seconds S: the wall of wall.py from a C++ program, for comparison.
// Prints when its first and its last report were read (ns).

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <thread>

#include <knurl/client/client.hpp>
#include <knurl/reps/constant_force.hpp>

using namespace knurl;
using Clock = std::chrono::steady_clock;

namespace {

/// What is done in each turn.
std::function<void(const HandFrame&)> wall(Claim& hand, const std::string& way, double stiffness) {
    if (way == "plane") {
        auto plane = hand.add(Plane{.stiffness = stiffness});
        return [plane, stiffness](const HandFrame&) mutable {
            plane.set({.offset = 0, .stiffness = stiffness});
        };
    }
    auto push = hand.add(ConstantForce{.force = {}, .recovery = 0});
    return [push, stiffness](const HandFrame& frame) mutable {
        push.set({.force = {0, 0, std::max(0.0, -stiffness * frame.position.z)}, .recovery = 0});
    };
}

int run(std::map<std::string, std::string>& said) {
    const double rate = std::stod(said["--rate"]), seconds = std::stod(said["--seconds"]);
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
    Client client = Client::connect(said["--socket"], {.name = "wall", .hints = false});
    Claim hand = client.claim("", {.update_interval = period});
    const auto turn = wall(hand, said["--way"], std::stod(said["--stiffness"]));
    hand.arm();
    std::int64_t first = 0, last = 0;
    for (auto next = Clock::now(); last - first <= static_cast<std::int64_t>(1e9 * seconds); next += period) {
        std::this_thread::sleep_until(next);
        const auto frame = hand.newest(std::chrono::seconds(1));
        if (!frame) return 1;
        if (first == 0) first = frame->read_ns;
        last = frame->read_ns;
        turn(*frame);
        hand.commit();
    }
    std::cout << first << ' ' << last << '\n';
    return 0;
}

}  // namespace

int main(int count, char** words) {
    std::map<std::string, std::string> said;
    for (int i = 1; i + 1 < count; i += 2) said[words[i]] = words[i + 1];
    try {
        return run(said);
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
