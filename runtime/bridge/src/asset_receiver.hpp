#pragma once
// The servo's end of a peer's assets. Pieces are put together in memory of the bridge, sealed, and offered to
// the servo as by any local client. A peer's memory grows with what has arrived: at most one claim's limit of
// incomplete assets, plus the source of each asset that waits for the servo's builder. It is all freed with
// the peer.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <knurl/link/transport.hpp>
#include <knurl/shm/fd.hpp>

#include "frame_stream.hpp"
#include "servo_errand.hpp"
#include "wire.hpp"

namespace knurl::bridge {

class OfferErrand;

class AssetReceiver {
  public:
    AssetReceiver(FrameStream& frames, Awaited& awaited) : frames_(frames), awaited_(awaited) {}

    // Each of these returns false if the peer must be closed, for `why`, which must live as long as this.
    // `door`: of the frame's claim; null: no such claim. Where the servo must be asked, the rest follows its
    // answer.
    bool offer(std::uint32_t stream, const std::shared_ptr<detail::AssetDoor>& door,
               std::span<const std::byte> payload, std::string& why);
    bool piece(std::span<const std::byte> payload, std::string& why);
    bool cancel(std::span<const std::byte> payload, std::string& why);
    bool forget(std::uint32_t stream, std::span<const std::byte> payload, std::string& why);
    /// Passes on the servo's answers about assets under construction.
    bool answers(std::string& why);
    /// Readable when answers() has something; -1: none was offered yet.
    int event() const noexcept { return event_.get(); }
    /// That claim has ended.
    void drop(std::uint32_t stream) noexcept;

  private:
    struct Parcel {
        std::uint32_t stream = 0, number = 0;
        std::uint64_t bytes = 0, come = 0;
        std::shared_ptr<detail::AssetDoor> door;
        shm::UniqueFd memory;                             // until the asset is offered
        std::unique_ptr<detail::AssetTransfer> building;  // then the servo has it
    };
    struct Held {
        std::uint64_t bytes = 0, ticket = 0;
        std::shared_ptr<detail::AssetDoor> door;
        bool forgotten = false;  // the peer has forgotten it; the servo was too slow to learn this
    };
    using HeldOnes = std::map<std::pair<std::uint32_t, std::uint32_t>, Held>;  // by stream and number

    void require_place(std::uint32_t stream, const AssetOffer& offer) const;  // throws Error
    bool make_place(std::uint32_t stream, const std::shared_ptr<detail::AssetDoor>& door,
                    const AssetOffer& offer, std::string& why);
    void pass_on(std::uint64_t ticket, Parcel& parcel, std::string& why);  // throws Error
    bool passed_on(std::uint64_t ticket, OfferErrand& errand, std::string& why);
    bool refuse(std::uint64_t ticket, const Error& error, std::string& why);
    void let_go(HeldOnes::iterator which, std::function<bool()> then);
    template <class T>
    bool say(FrameType type, const T& body, std::string& why);

    FrameStream& frames_;
    Awaited& awaited_;
    std::map<std::uint64_t, Parcel> parcels_;  // under way, by ticket
    std::uint64_t last_ticket_ = 0;
    HeldOnes held_;        // complete ones, at the servo
    shm::UniqueFd event_;  // an epoll set of the assets under construction
};

}  // namespace knurl::bridge
