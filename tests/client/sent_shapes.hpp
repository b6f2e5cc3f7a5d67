#pragma once
// A claim that sends shapes to its own servo, and a hand against which they are pressed.

#include <optional>
#include <string>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/reps/shape.hpp>

#include "../refusal.hpp"
#include "servo_process.hpp"

namespace client_test {

inline knurl::Triangles triangles_of(const knurl::test::MadeMesh& shape) {
    return {.vertices = shape.vertices, .triangles = shape.triangles, .materials = {}};
}

inline std::string answer_to(const auto& act) {
    return knurl::test::refusal_of<knurl::Error>(act);
}

struct Sent : testing::Test {
    void SetUp() override {
        servo.emplace();
        client.emplace(connect());
        // Silent only after minutes: else the force under test would fade on a machine that stands still.
        hand.emplace(client->claim("", {.update_interval = std::chrono::minutes(1)}));
        at = hand->device().workspace_centre;  // where the simulated hand rests
    }
    /// A shape that rises from below until its top is `deep` m above the hand.
    void press(auto& shape, knurl::Shape params, double half, double deep) {
        params.position = {at.x, at.y, at.z - half - 0.005};
        shape.set(params);
        hand->wait_applied(hand->commit(), 10s);
        read_until(*hand, [](const knurl::HandReport&) { return true; });
        params.position.z = at.z - half + deep;
        shape.set(params);
        hand->commit();
    }
    knurl::HandFeedback until_touched(const auto& shape) {
        std::optional<knurl::HandFeedback> felt;
        read_until(*hand, [&](const knurl::HandReport& report) {
            felt = shape.feedback();
            return is_on(report) && felt && (felt->flags & knurl::Feedback::touching) != 0 &&
                   felt->force.z > 0.05;
        });
        return *felt;
    }

    std::optional<ServoProcess> servo;
    std::optional<knurl::Client> client;
    std::optional<knurl::Claim> hand;
    knurl::Vec3 at;
};

}  // namespace client_test
