#pragma once
// One session at the servo's end: its connection, role, local client and streams.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/link/transport.hpp>

#include "asset_receiver.hpp"
#include "peer_stream.hpp"
#include "report_notifier.hpp"
#include "servo_errand.hpp"

namespace knurl::bridge {

/// The parts of the program that a peer uses.
struct PeerContext {
    const std::string& servo;
    std::span<const Key> keys;  // none: every caller has all rights
    ReportNotifier& notifier;
    OutQueue& out;
    ServoErrands& errands;
    std::size_t sessions = 0;  // at present
    /// Those of them that came with the key of this name.
    std::function<std::size_t(std::string_view)> sessions_of = {};
    /// Observers of a device: by that key, and all.
    struct Observers {
        std::size_t by_key = 0, all = 0;
    };
    std::function<Observers(std::string_view, std::uint32_t)> observers_of = {};
};

class GreetErrand;
class AttachErrand;

class Peer {
  public:
    Peer(shm::UniqueFd socket, const sockaddr_storage& from, std::uint64_t session,
         std::optional<TlsSession> tls, std::int64_t now);
    ~Peer();
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    int fd() const noexcept { return frames_.fd(); }
    int hang_up() const noexcept { return link_ ? link_->hang_up() : -1; }
    bool wants_write() const noexcept { return frames_.wants_write(); }
    bool greeted() const noexcept { return link_ != nullptr; }
    /// It has said who it is, and is greeted unless the servo is still asked.
    bool identified() const noexcept { return greeted() || awaited_.waits(); }
    int assets_event() const noexcept { return assets_.event(); }
    std::uint64_t session() const noexcept { return session_; }
    const sockaddr_storage& from() const noexcept { return from_; }
    const std::string& name() const noexcept { return name_; }  // name@host:port
    Role role() const noexcept { return key_ ? key_->role : Role::control; }
    /// Also true if it came without a key where none was required. False while the peer has not said who it
    /// is.
    bool holds_one_of(std::span<const Key> keys) const noexcept;
    bool admitted() const noexcept { return key_.has_value(); }
    std::size_t observers(std::uint32_t device) const noexcept;
    bool has_key(std::string_view name) const noexcept { return key_ && key_->name == name; }
    std::int64_t heard_ns() const noexcept { return heard_ns_; }
    void heard(std::int64_t now) noexcept { heard_ns_ = now; }

    // Each of these returns false if the peer must be closed, for why(). Called when its connection has data
    // or room. Behind a frame for which the servo is asked the others wait, until the answer is there.
    bool serve(PeerContext& context, std::int64_t now);
    bool waits_for_servo() const noexcept { return awaited_.waits(); }
    bool servo_answered() const noexcept { return awaited_.answered(); }
    /// After the servo's answer.
    bool go_on(PeerContext& context, std::int64_t now);
    bool serve_assets() { return assets_.answers(why_); }
    bool cycle(std::uint32_t device, const Report& report, std::uint64_t unseen, std::int64_t now,
               PeerContext& context) noexcept;
    void datagram(std::span<std::byte> datagram, const PeerAddress& from, std::int64_t now,
                  PeerContext& context) noexcept;

    const std::string& why() const noexcept { return why_; }
    /// For the log: datagrams in its name that were dropped; empty: none.
    std::string dropped() const;
    /// Sends the reason, if the peer can understand it, and closes.
    void close(PeerContext& context, Error::Kind kind, const std::string& text) noexcept;
    void say_gone(const std::string& text) noexcept;

  private:
    bool take_frame(const Frame& frame, PeerContext& context);
    bool greet(std::span<const std::byte> payload, PeerContext& context);
    bool welcome(GreetErrand& errand, PeerContext& context);
    void require_share(const protocol::ClaimRequest& request, const PeerContext& context) const;
    bool attach(std::span<const std::byte> payload, PeerContext& context);
    bool attached(AttachErrand& errand, std::uint32_t id, double report_rate, PeerContext& context);
    void release(std::uint32_t stream, PeerContext& context) noexcept;
    bool refuse(const Error& error) noexcept;
    std::optional<std::string> forbidden(const protocol::ClaimRequest& request) const;
    bool fail(std::string why);
    PeerStream* stream_of(std::uint32_t id) noexcept;
    Way way(PeerContext& context) noexcept {
        return {.frames = frames_, .outgoing = outgoing_, .out = context.out, .mtu = mtu_};
    }

    FrameStream frames_;
    const sockaddr_storage from_;
    const std::uint64_t session_;
    std::string name_;
    std::optional<Key> key_;
    std::shared_ptr<detail::Link> link_;  // null: not greeted yet
    OutgoingDatagrams outgoing_;
    IncomingDatagrams incoming_;
    std::array<CounterWindow, max_streams + 1> windows_{};
    PathMtu mtu_;
    LongestLately longest_;  // of its datagrams
    std::array<std::unique_ptr<PeerStream>, max_streams> streams_;
    Awaited awaited_;
    AssetReceiver assets_{frames_, awaited_};
    std::size_t next_stream_ = 0;
    std::int64_t heard_ns_;
    std::uint64_t replayed_ = 0, forged_ = 0;  // datagrams
    std::string why_;
};

}  // namespace knurl::bridge
