#pragma once
// The application's end of assets. Sends their sources in pieces between the other frames of the connection,
// as many at a time as do not delay these. All functions need the connection's lock.

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <knurl/protocol/asset.hpp>
#include <knurl/shm/fd.hpp>

#include "congestion_window.hpp"
#include "frame_stream.hpp"
#include "wire.hpp"

namespace knurl::bridge {

class AssetSender {
  public:
    struct Parcel {
        std::uint64_t ticket = 0, bytes = 0, sent = 0;
        std::uint32_t stream = 0, number = 0;
        bool offered = false;
        shm::UniqueFd source;
        shm::UniqueFd event;  // readable when an answer has arrived, or the connection has ended
        std::optional<protocol::AssetReady> ready;
        std::optional<Refused> refused;
        bool heard = false;  // the application has read the answer
    };

    explicit AssetSender(FrameStream& frames) : frames_(frames) {}

    /// `source` is duplicated. Throws Error.
    std::shared_ptr<Parcel> offer(std::uint32_t stream, std::uint32_t number, const shm::UniqueFd& source,
                                  std::uint64_t bytes);
    /// Nobody waits for the asset any more. False: the message could not be sent.
    bool withdraw(const Parcel& parcel) noexcept;
    /// Gives up the assets of a stream that has ended.
    void give_up(std::uint32_t stream) noexcept;
    /// Sends further pieces if there is room; called repeatedly.
    void go_on() noexcept;
    /// The connection has ended.
    void wake() noexcept;

    // Handles the bridge's messages; false: malformed.
    bool taken(std::span<const std::byte> payload) noexcept;
    bool ready(std::span<const std::byte> payload) noexcept;
    bool refused(std::span<const std::byte> payload) noexcept;

  private:
    struct Flight {
        std::size_t bytes = 0;
        std::int64_t sent_ns = 0;
    };
    bool send_piece(Parcel& parcel) noexcept;
    std::shared_ptr<Parcel> take(std::uint64_t ticket) noexcept;  // removes it from the list
    template <class T>
    bool send(FrameType type, std::uint32_t stream, const T& body) noexcept;

    FrameStream& frames_;
    std::vector<std::shared_ptr<Parcel>> parcels_;  // unanswered ones, in order of ticket
    std::uint64_t last_ticket_ = 0;
    std::deque<Flight> flights_;  // pieces that the bridge has not acknowledged yet
    std::size_t on_their_way_ = 0;
    CongestionWindow window_;
};

}  // namespace knurl::bridge
