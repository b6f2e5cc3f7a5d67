#pragma once
// What the server and its connections share: the loop, the devices, who commands what. Private to this module.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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
    /// Calls what is ready, after `woken`.
    void wait(int milliseconds, const std::function<void()>& woken);

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
class Devices {
  public:
    Devices(Loop& loop, Log& log, const ServerOptions& options);

    /// `wanted`: somebody is connected.
    void tick(Time now, bool wanted);
    std::span<const SenderInfo> senders() const { return senders_; }
    /// Called with new reports.
    std::function<void(std::size_t sender, std::span<const HandReport> reports)> on_reports;

  private:
    struct Watched {
        std::optional<Observer> observer;
        Ready ready;
    };
    void connect(Time now);
    void read(std::size_t sender);

    Loop& loop_;
    Log& log_;
    const ServerOptions& options_;
    std::vector<SenderInfo> senders_;
    std::vector<std::unique_ptr<Watched>> watched_;
    std::optional<Client> client_;
    std::optional<Time> tried_;
    std::vector<HandReport> block_ = std::vector<HandReport>(64);
};

class Connection;

struct Core {
    explicit Core(ServerOptions given);

    const ServerOptions options;
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
