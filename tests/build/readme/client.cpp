// Runs the blocks of the READMEs about the client, beside a servo that ends once the hand has been under
// force.
#include <thread>

#include <gtest/gtest.h>

#include "../../client/servo_process.hpp"

namespace {

using namespace std::chrono_literals;

knurl::SurfacePoint terrain(const knurl::Vec3& near) {
    return {.foot = {near.x, near.y, 0}, .normal = {0, 0, 1}};
}

/// A servo with the device "right". It ends once the device is active, so that loops over its reports end.
class EndsWhenActive {
  public:
    EndsWhenActive() : watch_([this] { watch(); }) {}
    ~EndsWhenActive() { watch_.join(); }
    bool was_active() const { return active_; }

  private:
    void watch() {
        auto observer = client_test::connect_beside().observe("right");
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (!active_ && std::chrono::steady_clock::now() < deadline) {
            const auto report = observer.next_report(100ms);
            active_ = report && report->state == knurl::DeviceState::active;
        }
        servo_.end(SIGTERM);
    }

    client_test::ServoProcess servo_{{"--device", "right=sim:cartesian3"}};
    std::atomic<bool> active_ = false;
    std::thread watch_;
};

TEST(Readme, TheLoopOfAClient) {
    EndsWhenActive servo;
#include "client_loop.inc"
    EXPECT_TRUE(servo.was_active());
}

TEST(Readme, TheHeadOfTheClientsHeader) {
    EndsWhenActive servo;
#include "client_head.inc"
    EXPECT_TRUE(servo.was_active());
}

}  // namespace
