#pragma once
// The servo's end of a peer's assets: what comes in pieces is put together in memory of the bridge's own,
// sealed, and offered to the servo as any local client does. A peer's memory grows with what has come: at
// most one claim's limit of what is incomplete, and for each that waits for the servo's builder its source;
// all of it goes with the peer.

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <knurl/link/transport.hpp>
#include <knurl/shm/fd.hpp>

#include "frame_stream.hpp"
#include "wire.hpp"

namespace knurl::bridge {

class AssetReceiver {
  public:
    explicit AssetReceiver(FrameStream& frames) : frames_(frames) {}

    // Each false: the peer is to be closed, for `why`. `door`: of the frame's claim; null: it has none.
    bool offer(std::uint32_t stream, const std::shared_ptr<detail::AssetDoor>& door,
               std::span<const std::byte> payload, std::string& why);
    bool piece(std::span<const std::byte> payload, std::string& why);
    bool cancel(std::span<const std::byte> payload, std::string& why);
    bool forget(std::uint32_t stream, std::span<const std::byte> payload, std::string& why);
    /// Passes on what the servo says of those that it builds.
    bool answers(std::string& why);
    /// Readable when answers() has something; -1: none was offered yet.
    int event() const noexcept { return event_.get(); }
    /// Whether the servo was asked for something since the last call: a way there and back, or more.
    bool asked_servo() noexcept { return std::exchange(asked_servo_, false); }
    /// That claim has gone.
    void drop(std::uint32_t stream) noexcept;

  private:
    struct Parcel {
        std::uint32_t stream = 0, number = 0;
        std::uint64_t bytes = 0, come = 0;
        std::shared_ptr<detail::AssetDoor> door;
        shm::UniqueFd memory;                             // until it is complete,
        std::unique_ptr<detail::AssetTransfer> building;  // then it is the servo's
    };
    struct Held {
        std::uint64_t bytes = 0, ticket = 0;
        std::shared_ptr<detail::AssetDoor> door;
        bool forgotten = false;  // the peer has; the servo was too slow to hear it
    };
    using HeldOnes = std::map<std::pair<std::uint32_t, std::uint32_t>, Held>;  // by stream and number

    void require_place(std::uint32_t stream, const AssetOffer& offer) const;  // throws Error
    void pass_on(std::uint64_t ticket, Parcel& parcel);                       // throws Error
    bool refuse(std::uint64_t ticket, const Error& error, std::string& why);
    void let_go(HeldOnes::iterator which);
    template <class T>
    bool say(FrameType type, const T& body, std::string& why);

    FrameStream& frames_;
    std::map<std::uint64_t, Parcel> parcels_;  // on their way, by ticket
    std::uint64_t last_ticket_ = 0;
    HeldOnes held_;        // by the servo
    shm::UniqueFd event_;  // an epoll set of those that are being built
    bool asked_servo_ = false;
};

}  // namespace knurl::bridge
