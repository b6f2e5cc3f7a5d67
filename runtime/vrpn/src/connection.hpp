#pragma once
// A client: its sockets, and its session once both cookies are there. Private to this module.

#include <string>
#include <vector>

#include <netinet/in.h>

#include "core.hpp"

namespace knurl::vrpn {

class Connection final : public Surroundings {
  public:
    /// To a client that listens there: the connection back.
    static std::unique_ptr<Connection> back(Core& core, const sockaddr_in& peer);
    /// A client that has connected: it gets all by TCP.
    static std::unique_ptr<Connection> accepted(Core& core, shm::UniqueFd tcp, const sockaddr_in& peer);
    ~Connection() override;

    /// It is over; why is in the log.
    bool over() const { return over_; }
    const sockaddr_in& peer() const { return peer_; }
    /// It is to be connected back to, or has been.
    bool is_back() const { return back_; }
    bool live() const { return session_ != nullptr; }
    void reports(std::size_t sender, std::span<const HandReport> reports);
    void tick();

    // Surroundings, for the session.
    void send(Service service, std::span<const std::byte> messages) override;
    void takes_datagrams(std::uint16_t port) override;
    std::span<const SenderInfo> senders() const override { return core_.devices.senders(); }
    std::string hold(std::size_t sender) override;
    std::unique_ptr<gateway::PeerCommands> make_hand(std::size_t sender) override;
    std::int64_t wall_clock() const override { return wall_clock_ns(); }
    void log(const std::string& line) override { note("session", line); }

  private:
    Connection(Core& core, const sockaddr_in& peer, bool back);

    /// `kind`: see Log.
    void note(std::string_view kind, const std::string& line);
    void on_tcp(std::uint32_t events);
    void on_udp();
    bool read();
    void parse();
    bool greet();
    void begin();
    void take_datagram(std::span<const std::byte> datagram, const sockaddr_in& from);
    void flush();
    void end(const std::string& why);

    Core& core_;
    const sockaddr_in peer_;
    const bool back_;
    const std::string name_;
    const Time begun_;
    shm::UniqueFd tcp_, udp_;
    Ready tcp_ready_, udp_ready_;
    bool connected_ = false;
    bool over_ = false;
    bool writes_ = false;              // the loop waits until it can be written to
    std::vector<std::byte> in_, out_;  // not complete, not sent
    Time moved_{};                     // when some of `out_` was sent last
    in_port_t datagrams_to_ = 0;       // of the client; 0: not known
    in_port_t datagrams_from_ = 0;     // the first port that was seen
    std::unique_ptr<Session> session_;
};

}  // namespace knurl::vrpn
