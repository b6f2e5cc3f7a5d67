#pragma once
// The door of the servo: a Unix socket on which clients introduce themselves, claim devices and, by hanging
// up, say that they have died. Runs on the main thread, real-time below the waker: it must see a death within
// 10 ms. It never blocks on a client, and everything that a client can ask for has a bound.

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <knurl/servo/claim_table.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::servo {

namespace broker_bounds {
inline constexpr std::size_t half_open = 16;     // connections that have not said Hello
inline constexpr double hello_seconds = 2;       // to say it
inline constexpr std::size_t connections = 256;  // in all
inline constexpr int messages_at_once = 16;  // taken from one connection before the others have their turn
inline constexpr int listen_backlog = 128;
inline constexpr double ramp_down_seconds = 1;  // a device that is not idle by then is zeroed without a ramp
}  // namespace broker_bounds

struct BrokerOptions {
    std::string servo_name;
    shm::UniqueFd listener;
    shm::UniqueFd signals;                   // signalfd: SIGINT, SIGTERM, SIGHUP
    int guardian_pidfd = -1;                 // readable when the guardian has died
    std::string builder = "/proc/self/exe";  // the program that answers --build-asset
};

class Broker {
  public:
    enum class End {
        asked,          // a signal; every device was ramped down
        at_once,        // a second signal
        guardian_died,  // ramped down, since a motor is not run unguarded
    };

    Broker(BrokerOptions options, std::vector<HostedDevice> devices, shm::Waker& waker);
    ~Broker();

    /// Serves until a signal or the guardian's death. Throws std::runtime_error if the kernel fails it.
    End run();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::servo
