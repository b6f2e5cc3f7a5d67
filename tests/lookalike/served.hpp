#pragma once
// A servo for each test, and a look at its device from outside.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "../client/servo_process.hpp"

namespace lookalike_test {

using namespace client_test;
using namespace knurl;

/// A hand that is taken, once a claim is active, from a place away from the centre through others, for a minute.
inline std::string wandering_hand(const knurl::test::TempFolder& folder) {
    std::string rows = "t,x,y,z\n";
    for (int i = 0; i <= 6000; ++i) {
        const double t = i * 0.01;
        rows += std::to_string(t) + "," + std::to_string(0.010 + 0.02 * std::sin(1.1 * t)) + "," +
                std::to_string(-0.020 + 0.015 * std::sin(0.7 * t)) + "," +
                std::to_string(0.005 + 0.01 * std::sin(1.7 * t)) + "\n";
    }
    return folder.file("hand.csv", rows);
}

/// Devices "right" and "left" on a servo "default"; a program is told of them by the environment, as by `knurl as`.
class Served : public ::testing::Test {
  protected:
    explicit Served(const std::string& right = "sim:cartesian3", const std::string& left = "sim:premium15")
        : servo_(
              {"--device", "right=" + right, "--device", "left=" + left, "--hand", wandering_hand(folder_)}) {
        ::setenv("KNURL_AS_SERVO", "knurl:default", 1);
        ::setenv("KNURL_AS_DEVICES", "", 1);
        client_.emplace(connect_beside());
        right_.emplace(client_->observe("right"));
        left_.emplace(client_->observe("left"));
        EXPECT_TRUE(right_->newest(20s) && left_->newest(20s));
    }

    /// Repeats `meanwhile` until the device's newest report is as wanted.
    template <class Wanted, class Meanwhile>
    static bool until(Observer& device, Wanted wanted, Meanwhile meanwhile) {
        return eventually([&] {
            meanwhile();
            const auto report = device.latest();
            return report && wanted(*report);
        });
    }

    knurl::test::TempFolder folder_;
    ServoProcess servo_;
    std::optional<Client> client_;
    std::optional<Observer> right_, left_;
};

inline bool no_force(const HandReport& report) {
    return report.sent_force == Vec3{};
}

}  // namespace lookalike_test
