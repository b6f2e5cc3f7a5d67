#pragma once
// The program's loop: one thread, one epoll set. Peers come by TCP, datagrams by one UDP socket, reports by
// one event per device. Each source is served until it is empty, and none is waited for: what the servo must
// be asked, workers ask (servo_errand.hpp).

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <knurl/bridge/endpoint.hpp>

#include "caller_rate.hpp"
#include "listening.hpp"
#include "log.hpp"
#include "peer.hpp"
#include "receive_batch.hpp"
#include "waiting_room.hpp"

struct epoll_event;

namespace knurl::bridge {

struct RelayOptions {
    std::string servo = "default";
    std::vector<Endpoint> listen{};  // one, or all addresses of a name: the first available one is used
    std::vector<Key> keys{};         // none: loopback only, whoever comes
};

class Relay {
  public:
    // Callers that have shown a key and said no hello yet; without keys nobody needs such a place for long.
    static constexpr std::size_t most_pending = 16;
    static constexpr std::size_t most_pending_of_host = 8;
    static constexpr double greeting_seconds = 2;  // in the waiting room, and the same again for the hello
    static constexpr std::size_t places = max_sessions + most_pending;
    static_assert(places <= 256);  // the place is the last byte of a session's number

    /// Listens. Throws std::runtime_error, one line.
    explicit Relay(RelayOptions options);
    ~Relay();
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;

    const std::string& listening_at() const { return listening_.at; }
    /// Runs until `signals` (a signalfd) is readable. May be called again.
    void run(int signals);
    /// Between two calls of run(): from now on these keys are valid. A peer whose key is missing or has
    /// changed is disconnected. Needs keys from the beginning, and at least one.
    void admit(std::vector<Key> keys);

  private:
    struct Place {
        std::unique_ptr<Peer> peer;
        std::uint32_t use = 0;    // so that events of an earlier peer are ignored
        std::uint64_t round = 0;  // its last round
        bool watches_hang_up = false;
        bool watches_assets = false;
        bool servo_left = false;    // it has ended the peer's connection to it
        std::uint32_t watches = 0;  // of its connection
    };

    void watch(int fd, std::uint32_t events, std::uint64_t source, int operation);
    void watch_listener(bool wanted);
    void accept_all(std::int64_t now);
    void listen_to(std::size_t seat, std::uint32_t events, std::int64_t now);
    void hear_callers(std::int64_t now);
    void hear(std::size_t seat, std::int64_t now);
    void give_place(std::size_t seat, std::int64_t now);
    void turn_away(std::size_t seat, const std::string& why, std::int64_t now);
    void go_on_after_servo(std::int64_t now);
    void take_datagrams(std::int64_t now);
    void serve_peer(std::size_t place, std::int64_t now);
    void serve_connection(std::size_t place, std::uint32_t events, std::int64_t now);
    struct Happened {
        bool gone = false;  // the servo
        bool told = false;  // by a signal, to end
    };
    void serve(const epoll_event& event, std::int64_t now, Happened& happened);
    void serve_assets(std::size_t place, std::int64_t now);
    void serve_device(std::size_t device, std::int64_t now);
    void follow(std::size_t place);  // updates the events that wake it
    void follow_servo();
    void servo_left(std::size_t place);
    void servo_gone();
    void end(std::size_t place, const std::string& why, std::int64_t now, bool told = true,
             Error::Kind kind = Error::Kind::disconnected);
    void close(std::size_t place, Error::Kind kind, const std::string& text);
    void tick(std::int64_t now);
    std::uint64_t new_session(std::size_t place) const;
    std::size_t pending() const;
    std::size_t identified() const;
    std::size_t pending_of(const sockaddr_storage& host) const;
    bool make_room(const sockaddr_storage& from, std::int64_t now);

    RelayOptions options_;
    std::shared_ptr<const TlsContext> tls_;
    const Listening listening_;
    shm::UniqueFd epoll_;
    bool accepting_ = false;
    ReportNotifier notifier_;
    bool watching_servo_ = false;
    WaitingRoom room_;
    std::size_t next_heard_ = 0;  // seat
    bool anyone_spoke_ = false;
    std::array<Place, places> places_;
    OutQueue out_;
    ReceiveBatch receive_batch_;
    Log log_;
    CallerRate caller_rate_;
    ServoErrands errands_;
    PeerContext context_;
    std::uint64_t round_ = 0;
    std::int64_t last_tick_ns_ = 0, accept_after_ns_ = 0;
    std::uint64_t strays_ = 0;  // datagrams of no session, not logged yet
    std::int64_t say_strays_after_ns_ = 0;
};

}  // namespace knurl::bridge
