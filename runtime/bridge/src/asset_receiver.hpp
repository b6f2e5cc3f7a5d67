#pragma once
// The servo's end of a peer's assets. Pieces are put together in memory of the bridge, sealed, and offered to
// the servo as by any local client. A peer's memory grows with what has arrived: at most one claim's limit of
// incomplete assets, plus the source of each asset that waits for the servo's builder. It is all freed with
// the peer.

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

    // Each of these returns false if the peer must be closed, for `why`. `door`: of the frame's claim; null:
    // no such claim.
    bool offer(std::uint32_t stream, const std::shared_ptr<detail::AssetDoor>& door,
               std::span<const std::byte> payload, std::string& why);
    bool piece(std::span<const std::byte> payload, std::string& why);
    bool cancel(std::span<const std::byte> payload, std::string& why);
    bool forget(std::uint32_t stream, std::span<const std::byte> payload, std::string& why);
    /// Passes on the servo's answers about assets under construction.
    bool answers(std::string& why);
    /// Readable when answers() has something; -1: none was offered yet.
    int event() const noexcept { return event_.get(); }
    /// Was the servo asked since the last call? That takes at least one round trip.
    bool asked_servo() noexcept { return std::exchange(asked_servo_, false); }
    /// That claim has ended.
    void drop(std::uint32_t stream) noexcept;

  private:
    struct Parcel {
        std::uint32_t stream = 0, number = 0;
        std::uint64_t bytes = 0, come = 0;
        std::shared_ptr<detail::AssetDoor> door;
        shm::UniqueFd memory;                             // until the asset is complete
        std::unique_ptr<detail::AssetTransfer> building;  // then the servo has it
    };
    struct Held {
        std::uint64_t bytes = 0, ticket = 0;
        std::shared_ptr<detail::AssetDoor> door;
        bool forgotten = false;  // the peer has forgotten it; the servo was too slow to learn this
    };
    using HeldOnes = std::map<std::pair<std::uint32_t, std::uint32_t>, Held>;  // by stream and number

    void require_place(std::uint32_t stream, const AssetOffer& offer) const;  // throws Error
    void pass_on(std::uint64_t ticket, Parcel& parcel);                       // throws Error
    bool refuse(std::uint64_t ticket, const Error& error, std::string& why);
    void let_go(HeldOnes::iterator which);
    template <class T>
    bool say(FrameType type, const T& body, std::string& why);

    FrameStream& frames_;
    std::map<std::uint64_t, Parcel> parcels_;  // under way, by ticket
    std::uint64_t last_ticket_ = 0;
    HeldOnes held_;        // complete ones, at the servo
    shm::UniqueFd event_;  // an epoll set of the assets under construction
    bool asked_servo_ = false;
};

}  // namespace knurl::bridge
