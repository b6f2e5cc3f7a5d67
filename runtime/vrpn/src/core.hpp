#pragma once
// What the server and its connections share: the loop, the devices, who commands what. Private to this module.

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <netinet/in.h>

#include <knurl/client/client.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/vrpn/server.hpp>

namespace knurl::vrpn {

using Time = Session::Time;

/// What is called when a descriptor is ready. It must outlive the round of the loop in which its descriptor was closed.
struct Ready {
    std::function<void(std::uint32_t events)> call;
};

/// One epoll descriptor.
class Loop {
  public:
    Loop();
    /// Watches `fd`, which is closed before `ready` ends.
    void add(int fd, std::uint32_t events, Ready& ready);
    void change(int fd, std::uint32_t events, Ready& ready);
    /// Waits, then calls what is ready with the mutex held, after `woken`.
    void wait(int milliseconds, std::mutex& mutex, const std::function<void()>& woken);

  private:
    shm::UniqueFd epoll_;
};

/// Lines that no peer can make many: of each kind one a second, with the number of those that were left out.
class Log {
  public:
    explicit Log(std::function<void(const std::string&)> write) : write_(std::move(write)) {}
    /// `kind`: one of a few, fixed texts.
    void say(std::string_view kind, const std::string& line, Time now);

  private:
    struct Kind {
        std::optional<Time> when{};
        std::size_t unsaid = 0;
    };
    std::function<void(const std::string&)> write_;
    std::map<std::string, Kind, std::less<>> kinds_;
};

/// The devices behind the senders. While nobody is connected there is no connection to the servo either.
///
/// A thread per sender sleeps until a report is there and sends it at once: one wake-up and one datagram after the servo's
/// write. It holds the mutex meanwhile, as the loop does while it calls what is ready.
class Devices {
  public:
    Devices(std::mutex& mutex, Log& log, const ServerOptions& options);
    ~Devices() { end(); }
    Devices(const Devices&) = delete;
    Devices& operator=(const Devices&) = delete;

    /// `wanted`: somebody is connected. Without the mutex: it may wait for a servo.
    void tick(Time now, bool wanted);
    /// No reports come any more. Without the mutex.
    void end();
    /// With the mutex.
    std::span<const SenderInfo> senders() const { return senders_; }
    /// Called with new reports and with the mutex.
    std::function<void(std::size_t sender, std::span<const HandReport> reports)> on_reports;

  private:
    struct Watched {
        std::optional<Observer> observer;
        std::thread thread;
        std::atomic<bool> over{false};  // its servo has gone for good
    };
    void connect(Time now);
    void watch(std::size_t sender);

    std::mutex& mutex_;
    Log& log_;
    const ServerOptions& options_;
    std::vector<SenderInfo> senders_;
    std::vector<std::unique_ptr<Watched>> watched_;
    std::optional<Client> client_;
    std::optional<Time> tried_;
};

class Connection;

struct Core {
    explicit Core(ServerOptions given);

    const ServerOptions options;
    std::mutex mutex;  // of all that follows
    Loop loop;
    Log log;
    Devices devices;
    std::vector<Connection*> holders;  // of the force, by sender
    Time now{};                        // when this round of the loop began
};

/// "127.0.0.1:40312".
std::string text_of(const sockaddr_in& address);
/// The address as a number, as HostRange has it.
inline std::uint32_t number_of(const sockaddr_in& address) {
    return ntohl(address.sin_addr.s_addr);
}
std::int64_t wall_clock_ns();

}  // namespace knurl::vrpn
