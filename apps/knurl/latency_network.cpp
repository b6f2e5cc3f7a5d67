#include "latency_network.hpp"

#include <chrono>

#include <fmt/format.h>

namespace knurl::cli {

namespace {

double us(std::chrono::nanoseconds t) {
    return std::chrono::duration<double, std::micro>(t).count();
}

}  // namespace

std::string network_text(const Network& network, const bridge::WireSizes& sizes) {
    return fmt::format(
        "network: {}, round trip at least {:.1f} us, clock offset {:.1f} us +- {:.1f} us, drift {:.1f} ppm "
        "+- {:.1f} ppm, {} reports lost, {} late, {} datagrams doubled, {} batches sent again.\nDatagrams of "
        "{} bytes; "
        "floor.udp_one_way is half an echo of that size between blocking readers. Commands and answers of {} "
        "bytes by {};\nfloor.tcp_round_trip is a plain TCP echo of that size. The servo's stamps are by the "
        "clock estimate.\n",
        network.encrypted ? "encrypted" : "not encrypted", us(network.round_trip), us(network.clock_offset),
        us(network.clock_uncertainty), network.drift * 1e6, network.drift_uncertainty * 1e6, network.lost,
        network.late, network.duplicated, network.resent, sizes.datagram, sizes.command,
        network.encrypted ? "TLS 1.3 over TCP" : "TCP");
}

knurl::Json network_json(const Network& network, const bridge::WireSizes& sizes) {
    return {{"encrypted", network.encrypted},
            {"round_trip_s", us(network.round_trip) / 1e6},
            {"clock_offset_s", us(network.clock_offset) / 1e6},
            {"clock_uncertainty_s", us(network.clock_uncertainty) / 1e6},
            {"drift_ppm", network.drift * 1e6},
            {"drift_uncertainty_ppm", network.drift_uncertainty * 1e6},
            {"reports_lost", network.lost},
            {"reports_late", network.late},
            {"datagrams_doubled", network.duplicated},
            {"batches_resent", network.resent},
            {"datagram_bytes", sizes.datagram},
            {"command_bytes", sizes.command}};
}

}  // namespace knurl::cli
