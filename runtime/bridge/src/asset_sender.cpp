#include "asset_sender.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>

#include <fcntl.h>
#include <unistd.h>

#include <knurl/link/clock.hpp>
#include <knurl/link/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::bridge {

namespace {

void raise(const AssetSender::Parcel& parcel) noexcept {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(parcel.event.get(), &one, sizeof one);
}

void refuse(AssetSender::Parcel& parcel, std::string_view why) noexcept {
    Refused& refused = parcel.refused.emplace();
    refused.kind = static_cast<std::uint32_t>(Error::Kind::refused);
    why.copy(refused.text, sizeof refused.text - 1);
    raise(parcel);
}

}  // namespace

template <class T>
bool AssetSender::send(FrameType type, std::uint32_t stream, const T& body) noexcept {
    return frames_.send(static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(stream), bytes_of(body));
}

std::shared_ptr<AssetSender::Parcel> AssetSender::offer(std::uint32_t stream, std::uint32_t number,
                                                        const shm::UniqueFd& source, std::uint64_t bytes) {
    auto parcel = std::make_shared<Parcel>();
    parcel->bytes = bytes;
    parcel->stream = stream;
    parcel->number = number;
    parcel->source = shm::UniqueFd(::fcntl(source.get(), F_DUPFD_CLOEXEC, 0));
    parcel->event = shm::make_event();
    if (!parcel->source)
        throw Error(Error::Kind::refused, detail::format("send: no descriptor ({}); see the limit of open "
                                                         "files (ulimit -n)",
                                                         std::strerror(errno)));
    parcels_.push_back(parcel);
    parcel->ticket = ++last_ticket_;
    go_on();
    return parcel;
}

std::shared_ptr<AssetSender::Parcel> AssetSender::take(std::uint64_t ticket) noexcept {
    const auto found = std::find_if(parcels_.begin(), parcels_.end(),
                                    [&](const auto& each) { return each->ticket == ticket; });
    if (found == parcels_.end()) return nullptr;
    auto parcel = std::move(*found);
    parcels_.erase(found);
    return parcel;
}

bool AssetSender::withdraw(const Parcel& parcel) noexcept {
    if (!take(parcel.ticket) && (parcel.heard || !parcel.ready)) return true;  // it was answered
    const bool told =
        !parcel.offered || send(FrameType::asset_cancel, parcel.stream, AssetTicket{.ticket = parcel.ticket});
    go_on();
    return told;
}

void AssetSender::give_up(std::uint32_t stream) noexcept {
    std::erase_if(parcels_, [&](const auto& parcel) {
        if (parcel->stream != stream) return false;
        refuse(*parcel, "asset: its claim has gone");
        return true;
    });
    go_on();
}

void AssetSender::wake() noexcept {
    for (const auto& parcel : parcels_) raise(*parcel);
}

/// One after the other: the asset that is complete first is built first.
void AssetSender::go_on() noexcept {
    for (std::size_t i = 0; i < std::min(parcels_.size(), max_assets_on_their_way); ++i) {
        Parcel& parcel = *parcels_[i];
        if (parcel.sent == parcel.bytes) continue;
        if (!parcel.offered)
            parcel.offered =
                send(FrameType::asset_offer, parcel.stream,
                     AssetOffer{.ticket = parcel.ticket, .bytes = parcel.bytes, .number = parcel.number});
        while (parcel.offered && parcel.sent < parcel.bytes && window_.has_room(on_their_way_)) {
            if (!send_piece(parcel)) return;
        }
        if (parcel.sent < parcel.bytes) return;
    }
}

bool AssetSender::send_piece(Parcel& parcel) noexcept {
    std::array<std::byte, asset_piece_bytes> piece;
    const std::size_t bytes = std::min<std::uint64_t>(piece.size(), parcel.bytes - parcel.sent);
    if (::pread(parcel.source.get(), piece.data(), bytes, static_cast<off_t>(parcel.sent)) !=
        static_cast<ssize_t>(bytes)) {
        refuse(parcel, "send: its memory cannot be read");
        const std::uint64_t ticket = parcel.ticket;
        if (const auto kept = take(ticket)) send(FrameType::asset_cancel, kept->stream, AssetTicket{ticket});
        return false;
    }
    const AssetPiece header{.ticket = parcel.ticket, .offset = parcel.sent};
    const std::array parts{bytes_of(header), std::span<const std::byte>(piece).first(bytes)};
    try {
        flights_.push_back({.bytes = bytes, .sent_ns = detail::monotonic_ns()});
    } catch (const std::bad_alloc&) {
        return false;
    }
    if (!frames_.send(static_cast<std::uint16_t>(FrameType::asset_piece),
                      static_cast<std::uint16_t>(parcel.stream), parts)) {
        flights_.pop_back();  // tried again when there is room
        return false;
    }
    parcel.sent += bytes;
    on_their_way_ += bytes;
    return true;
}

bool AssetSender::taken(std::span<const std::byte> payload) noexcept {
    AssetTicket piece;
    if (!bridge::take(payload, piece) || flights_.empty()) return false;
    const Flight flight = flights_.front();
    flights_.pop_front();
    on_their_way_ -= flight.bytes;
    window_.taken(flight.bytes, detail::monotonic_ns() - flight.sent_ns);
    go_on();
    return true;
}

bool AssetSender::ready(std::span<const std::byte> payload) noexcept {
    AssetReady message;
    if (!bridge::take(payload, message) || message.ticket > last_ticket_) return false;
    const auto parcel = take(message.ticket);
    if (!parcel) return true;  // it was withdrawn in the meantime
    if (parcel->sent < parcel->bytes || message.ready.number != parcel->number) {
        refuse(*parcel,
               "the bridge reports an asset as ready that was not sent; build application and bridge from "
               "the same version");
        return false;
    }
    parcel->ready = message.ready;
    raise(*parcel);
    go_on();
    return true;
}

bool AssetSender::refused(std::span<const std::byte> payload) noexcept {
    AssetRefused message;
    if (!bridge::take(payload, message) || message.ticket > last_ticket_) return false;
    const auto parcel = take(message.ticket);
    if (!parcel) return true;
    parcel->refused = message.refused;
    raise(*parcel);
    go_on();
    return true;
}

}  // namespace knurl::bridge
