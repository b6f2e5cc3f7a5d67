// A curved floor from an application with 20 updates a second: each update sends the piece where the hand
// will be.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include <knurl/client/client.hpp>

#include "seconds.hpp"

using namespace std::chrono_literals;

// A ball of 0.2 m, its top 5 mm above the middle of the workspace.
knurl::SurfaceModel ball_below(const knurl::Vec3& centre_of_workspace) {
    const double radius = 0.2;  // m
    const Eigen::Vector3d centre =
        knurl::to_eigen(centre_of_workspace) - Eigen::Vector3d(0, 0, radius - 0.005);
    return [=](const knurl::Vec3& near) -> knurl::SurfacePoint {
        const Eigen::Vector3d outwards = (knurl::to_eigen(near) - centre).normalized();
        return {.foot = knurl::to_plain(centre + radius * outwards),
                .normal = knurl::to_plain(outwards),
                .curvature = -1 / radius /* 1/m, in every direction */};
    };
}

int main(int argc, char** argv) try {
    const auto end = examples::end_of(argc, argv);

    auto client = knurl::Client::connect("knurl:default");
    auto hand = client.claim("", {.update_interval = 50ms});
    const auto ball = ball_below(hand.device().workspace_centre);
    auto floor =
        hand.add(knurl::Cap{.foot = {0, 0, -1.0} /* m: out of reach */, .stiffness = 1000 /* N/m */});
    hand.arm();

    double strongest = 0;
    while (std::chrono::steady_clock::now() < end) {
        floor.follow(ball);
        hand.commit();
        std::this_thread::sleep_for(50ms);  // a slow computation
        if (auto feedback = floor.feedback())
            strongest = std::max(strongest, knurl::to_eigen(feedback->force).norm());
    }
    const auto timing = hand.timing();
    std::printf("strongest %.2f N; %llu updates, felt %.1f ms after their report was read\n", strongest,
                static_cast<unsigned long long>(timing.batches),
                static_cast<double>(timing.age_at_use.count()) * 1e-6);
} catch (const std::exception& error) {
    return std::fprintf(stderr, "03_moving_plane: %s\n", error.what()), 1;
}
