#pragma once
// A hand of a real servo, claimed through the C interface. KNURL_TEST_TRANSPORT=bridge: through a bridge.

#include <functional>
#include <utility>

#include "../client/servo_process.hpp"
#include "support.hpp"

namespace capi_test {

using client_test::ServoProcess;
using knurl::test::eventually;

inline const char* address() {
    return ServoProcess::through_bridge() ? std::getenv("KNURL_TEST_ADDRESS") : nullptr;
}

#if defined(__SANITIZE_THREAD__)
inline constexpr bool instrumented_servo = true;
#else
inline constexpr bool instrumented_servo = false;
#endif
/// Cycles a second of the servo. A cycle under ThreadSanitizer takes most of a millisecond, and a servo that has
/// no room in its period refuses what is added, which is tested elsewhere.
inline constexpr int rate = instrumented_servo ? 500 : 1000;

/// Patient: a sanitizer build on a busy machine starts slowly.
inline knurl_client* connect() {
    knurl_connect_options options;
    knurl_default_connect_options(&options);
    options.name = "test of the C interface";
    options.wait_ns = 20 * s;
    options.hints = 0;
    knurl_client* client = nullptr;
    if (knurl_connect(address(), &options, &client) != KNURL_OK)
        throw std::runtime_error(knurl_error(nullptr));
    return client;
}

/// Reads until a report satisfies `wanted`, and keeps committing. Throws after a minute.
template <class Wanted>
knurl_report read_until(knurl_hand* hand, Wanted wanted) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    knurl_report report = sized<knurl_report>();
    while (std::chrono::steady_clock::now() < deadline) {
        const int code = knurl_next_report(hand, 100 * ms, &report);
        if (code < 0 || knurl_commit(hand, nullptr) < 0) throw std::runtime_error(knurl_error(hand));
        if (code == KNURL_OK && wanted(report)) return report;
    }
    throw std::runtime_error("what the test waited for did not happen within a minute; state " +
                             std::to_string(report.state) + ", faults " + std::to_string(report.faults));
}
inline bool is_active(const knurl_report& report) {
    return report.state == KNURL_STATE_ACTIVE;
}
inline bool is_on(const knurl_report& report) {
    return report.state == KNURL_STATE_ACTIVE || report.state == KNURL_STATE_RAMP_UP;
}

struct CHand : testing::Test {
    void SetUp() override {
        servo.emplace(std::vector<std::string>{"--device", "sim:cartesian3", "--rate", std::to_string(rate)});
        client = connect();
        claim();
    }
    void TearDown() override {
        if (client == nullptr) return;
        EXPECT_TRUE(did(knurl_close(client)));
    }
    /// Silent only after minutes, so that no force fades on a machine that stands still.
    void claim(std::int64_t update_interval_ns = 60 * s, std::uint32_t shared = 0) {
        knurl_claim_options options;
        knurl_default_claim_options(&options);
        options.update_interval_ns = update_interval_ns;
        options.shared = shared;
        if (hand != nullptr) {
            ASSERT_TRUE(did(knurl_close(hand)));
        }
        ASSERT_TRUE(
            eventually([&] { return knurl_claim(client, nullptr, &options, &hand) != KNURL_DEVICE_HELD; }));
        ASSERT_TRUE(did(knurl_device_of(hand, &device)));
    }
    template <class T>
    knurl_id add(std::uint32_t kind, const T& params) {
        knurl_id id = 0;
        EXPECT_TRUE(did(knurl_add(hand, kind, &params, nullptr, &id)));
        return id;
    }
    void apply() {
        std::uint64_t number = 0;
        ASSERT_TRUE(did(knurl_commit(hand, &number)));
        ASSERT_TRUE(did(knurl_wait_applied(hand, number, 20 * s)));
    }
    /// Waits until the whole force of this along x is sent.
    void feel(double force) {
        read_until(hand, [&](const knurl_report& report) {
            return is_active(report) && std::abs(report.scene_force.x - force) < 1e-12;
        });
    }

    std::optional<ServoProcess> servo;
    knurl_client* client = nullptr;
    knurl_hand* hand = nullptr;
    knurl_device device = sized<knurl_device>();
};

}  // namespace capi_test
