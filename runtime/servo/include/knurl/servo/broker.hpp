#pragma once

/// @file
/// The door of the servo: a Unix socket on which clients introduce themselves, claim devices and, by hanging
/// up, say that they have died. Runs on the main thread, real-time below the waker: it must see a death
/// within 10 ms. It never blocks on a client, and everything that a client can request has a bound.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <knurl/servo/claim_table.hpp>
#include <knurl/servo/closer.hpp>
#include <knurl/servo/death_watch.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::servo {

namespace broker_bounds {
/// Most connections that have not said Hello.
inline constexpr std::size_t half_open = 16;
/// Time to say it (s).
inline constexpr double hello_seconds = 2;
/// Most connections. One process gets half of them, which is enough for all sessions of a bridge.
inline constexpr std::size_t connections = 320;
/// Messages that are taken from one connection before the others have their turn.
inline constexpr int messages_at_once = 16;
/// Connections that may wait to be accepted.
inline constexpr int listen_backlog = 128;
/// Most assets that are shown to watchers, of all devices together.
inline constexpr std::size_t shown_assets = 512;
/// A device that is not idle after this time is put to zero without a ramp (s).
inline constexpr double ramp_down_seconds = 1;
}  // namespace broker_bounds

/// What a broker needs from its process.
struct BrokerOptions {
    /// Name of the servo.
    std::string servo_name;
    /// Listening socket.
    shm::UniqueFd listener;
    /// A signalfd of SIGINT, SIGTERM, SIGHUP.
    shm::UniqueFd signals;
    /// Readable when the guardian has died; -1: there is none.
    int guardian_pidfd = -1;
    /// Closes connections.
    Closer& closer;
    /// Sees them die.
    DeathWatch& deaths;
    /// What all clients together may take (bytes).
    std::uint64_t memory = default_memory_budget();
    /// The program that answers --build-asset.
    std::string builder = "/proc/self/exe";
};

/// The thread that answers sockets: it admits clients and gives out claims.
class Broker {
  public:
    /// Why run() returned.
    enum class End {
        /// A signal; every device was ramped down.
        asked,
        /// A second signal.
        at_once,
        /// The guardian died; every device was ramped down, since a motor is not run unguarded.
        guardian_died,
    };

    /// A broker of these devices.
    Broker(BrokerOptions options, std::vector<HostedDevice> devices, shm::Waker& waker);
    ~Broker();

    /// Serves until a signal or the guardian's death. Throws std::runtime_error if the kernel fails it.
    End run();
    /// One round of that: waits for an event, for no longer than `most_ms` if that is not negative, and handles
    /// what there is. None: it goes on.
    std::optional<End> turn(int most_ms = -1);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::servo
