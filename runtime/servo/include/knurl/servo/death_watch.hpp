#pragma once

/// @file
/// Sees clients die. A client's end is the hang-up of its connection, and the broker, which serves the
/// connection, may be making or freeing the memory of another client just then. So a thread that does nothing
/// else looks at the same sockets, and tells the servo at once: the claim fades. The broker takes the claim
/// back when it comes to it.
///
/// ~~~{.unparsed}
///   client dies ──> death watch: Servo::abandon(claim) ──> the force fades, 50 ms ──> outbox
///              └──> broker, later: ClaimTable::let_go(row) ──────────────────────> the row is free
/// ~~~

#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include <knurl/servo/claim.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::servo {

/// What the broker tells that thread: which connection holds which claims. No claim that is registered is
/// freed.
class DeathWatch {
  public:
    /// Throws std::runtime_error.
    DeathWatch();

    /// The thread's body, until stop(). Allocates nothing.
    void run() noexcept;
    /// From any thread: run() returns.
    void stop() noexcept;

    /// Looks at this socket from now on. Throws std::runtime_error.
    void watch(std::uint64_t connection, int socket);
    /// Looks at it no longer; before it is closed.
    void forget(std::uint64_t connection, int socket) noexcept;
    /// The connection holds this claim. If it has died already, the servo is told now.
    void hold(std::uint64_t connection, Servo& servo, Claim& claim);
    /// It holds it no longer; before the claim is dropped.
    void release(std::uint64_t connection, const Claim& claim) noexcept;

  private:
    struct Held {
        Servo* servo;
        Claim* claim;
    };
    struct Watched {
        bool dead = false;
        std::vector<Held> held;
    };
    void died(std::uint64_t connection) noexcept;

    shm::UniqueFd epoll_, stop_;
    std::mutex mutex_;
    std::unordered_map<std::uint64_t, Watched> connections_;
};

}  // namespace knurl::servo
