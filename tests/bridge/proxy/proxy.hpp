#pragma once
// A network in user space between a client and a server: a TCP and a UDP port with the same number, relayed
// to the server's with a network profile and a seed. Runs in its own thread.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "network_profile.hpp"

namespace knurl::bridge::proxy {

struct Counts {
    std::uint64_t datagrams[2] = {};  // that came in, by way
    std::uint64_t lost[2] = {};       // by the profile or by a cut
    std::uint64_t doubled[2] = {};
    std::uint64_t delivered[2] = {};
    std::uint64_t connections = 0;  // TCP, so far
    std::uint64_t fates = 0;        // digest of all fates so far: the same for the same seed and datagrams
};

class Proxy {
  public:
    enum class At : std::uint8_t { entry, exit };
    struct Options {
        std::string listen = "127.0.0.1";  // IPv4
        std::uint16_t port = 0;            // 0: any
        std::string to = "127.0.0.1";      // IPv4
        std::uint16_t to_port = 0;
        std::uint64_t seed = 1;
        NetworkProfile profile;
        /// Called for each datagram, in the proxy's thread: on arrival, before its fate, and for each copy
        /// that is sent.
        std::function<void(Way, At, std::span<const char>)> overhear{};
    };
    /// Throws std::runtime_error, one line: a bad address, or it is in use.
    explicit Proxy(const Options& options);
    ~Proxy();
    Proxy(const Proxy&) = delete;
    Proxy& operator=(const Proxy&) = delete;

    std::uint16_t port() const noexcept;
    void set(const NetworkProfile& profile);  // from now on
    /// Unplugs the cable: datagrams are lost, streams stand still, nobody is told. Until heal().
    void cut();
    void heal();
    /// Ends all connections with a reset.
    void hang_up();
    Counts counts() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::bridge::proxy
