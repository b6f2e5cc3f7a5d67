// The network's figures are the same in text and in JSON.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <latency_network.hpp>

namespace knurl::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(LatencyNetwork, IsTheSameInTextAndForPrograms) {
    const bridge::WireSizes sizes{.datagram = 711, .command = 94};
    for (const bool encrypted : {false, true}) {
        const Network network{.lost = 3,
                              .late = 5,
                              .duplicated = 7,
                              .resent = 11,
                              .round_trip = 123'400ns,
                              .clock_offset = -45'600ns,
                              .clock_uncertainty = 7'800ns,
                              .drift = -2.5e-6,
                              .drift_uncertainty = 1.5e-6,
                              .encrypted = encrypted};
        const knurl::Json json = cli::network_json(network, sizes);
        EXPECT_EQ(json["encrypted"], encrypted);
        EXPECT_DOUBLE_EQ(json["clock_offset_s"].get<double>(), -45.6e-6);
        const auto number = [&](const char* key) { return json.at(key).get<double>(); };
        const auto us = [&](const char* key) { return number(key) * 1e6; };
        const std::string text = cli::network_text(network, sizes);
        EXPECT_THAT(text,
                    HasSubstr(fmt::format(
                        "network: {}, round trip at least {:.1f} us, clock offset {:.1f} us +- {:.1f} us, "
                        "drift {:.1f} ppm +- {:.1f} ppm, {} reports lost, {} late, {} datagrams doubled, {} "
                        "batches sent again",
                        encrypted ? "encrypted" : "not encrypted", us("round_trip_s"), us("clock_offset_s"),
                        us("clock_uncertainty_s"), number("drift_ppm"), number("drift_uncertainty_ppm"),
                        number("reports_lost"), number("reports_late"), number("datagrams_doubled"),
                        number("batches_resent"))));
        EXPECT_THAT(text, HasSubstr(fmt::format("Datagrams of {} bytes", number("datagram_bytes"))));
        EXPECT_THAT(text, HasSubstr(fmt::format("of {} bytes by {}", number("command_bytes"),
                                                encrypted ? "TLS 1.3" : "TCP")));
    }
}

}  // namespace
}  // namespace knurl::test
