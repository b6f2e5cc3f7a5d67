#pragma once

/// @file
/// The two channels to a servo on another host: a Link like the local one, through a knurl-bridge there.

#include <chrono>
#include <memory>
#include <span>
#include <string>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/link/transport.hpp>

namespace knurl::bridge {

/// How to connect to a bridge.
struct RemoteOptions {
    /// Name that `knurl ls` shows.
    std::string client_name{};
    /// Longest wait for each answer of the bridge.
    std::chrono::milliseconds answer_time{2000};
    /// Largest rate of reports (Hz); 0: every report.
    double report_rate = 0;
    /// File with one key's line; empty: no key.
    std::string key_file{};
};

/// One attempt at each address in turn, until a bridge admits this client. Throws Error: no_servo if nobody
/// listens there, or its datagrams do not come through; permission for a wrong key (no more are tried then);
/// incompatible. Of several addresses it says what is wrong with each, and how many were tried.
std::unique_ptr<detail::Link> connect_remote(std::span<const Endpoint> bridge, const RemoteOptions& options);

}  // namespace knurl::bridge
