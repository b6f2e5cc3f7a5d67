#pragma once
// The two channels to a servo on another host: a Link like the local one, through a knurl-bridge there.

#include <chrono>
#include <memory>
#include <string>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/link/transport.hpp>

namespace knurl::bridge {

struct RemoteOptions {
    std::string client_name{};
    std::chrono::milliseconds answer_time{2000};  // for each answer of the bridge
    double report_rate = 0;                       // Hz at most; 0: every report
    std::string key_file{};                       // one key's line; empty: no key
};

/// One attempt. Throws Error: no_servo if nobody listens there, or its datagrams do not come through;
/// permission for a wrong key; incompatible.
std::unique_ptr<detail::Link> connect_remote(const Endpoint& bridge, const RemoteOptions& options);

}  // namespace knurl::bridge
