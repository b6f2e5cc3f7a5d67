#include "asset_receiver.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <knurl/link/error.hpp>
#include <knurl/link/text.hpp>

namespace knurl::bridge {

namespace {

[[noreturn]] void no_memory(std::uint64_t bytes) {
    throw Error(Error::Kind::refused, detail::format("asset: the bridge has no memory for its {} bytes ({})",
                                                     bytes, std::strerror(errno)));
}

/// A page takes memory when it is first written.
shm::UniqueFd make_memory(std::uint64_t bytes) {
    shm::UniqueFd fd(::memfd_create("knurl-source", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (!fd || ::ftruncate(fd.get(), static_cast<off_t>(bytes)) != 0) no_memory(bytes);
    return fd;
}

}  // namespace

/// Gives the servo an asset.
class OfferErrand final : public Errand {
  public:
    OfferErrand(std::shared_ptr<detail::AssetDoor> door, std::uint32_t number, shm::UniqueFd memory,
                std::uint64_t bytes)
        : door_(std::move(door)), number_(number), memory_(std::move(memory)), bytes_(bytes) {}
    std::unique_ptr<detail::AssetTransfer> transfer;

  private:
    void ask() override { transfer = door_->offer(number_, memory_, bytes_); }
    const std::shared_ptr<detail::AssetDoor> door_;
    const std::uint32_t number_;
    const shm::UniqueFd memory_;
    const std::uint64_t bytes_;
};

namespace {

class ForgetErrand final : public Errand {
  public:
    ForgetErrand(std::shared_ptr<detail::AssetDoor> door, std::uint32_t number)
        : door_(std::move(door)), number_(number) {}

  private:
    void ask() override { door_->forget(number_); }
    const std::shared_ptr<detail::AssetDoor> door_;
    const std::uint32_t number_;
};

}  // namespace

template <class T>
bool AssetReceiver::say(FrameType type, const T& body, std::string& why) {
    if (frames_.send(static_cast<std::uint16_t>(type), 0, bytes_of(body))) return true;
    why = "it does not read";
    return false;
}

bool AssetReceiver::refuse(std::uint64_t ticket, const Error& error, std::string& why) {
    AssetRefused message{.ticket = ticket, .refused = {.kind = static_cast<std::uint32_t>(error.kind)}};
    put_text(message.refused.text, error.what());
    return say(FrameType::asset_refused, message, why);
}

/// Gives the refusals that the servo would give after the whole transfer.
void AssetReceiver::require_place(std::uint32_t stream, const AssetOffer& offer) const {
    const auto bad = [](const std::string& text) {
        throw Error(Error::Kind::bad_parameters, "asset: " + text);
    };
    if (offer.number < 1 || offer.number > max_assets)
        bad(detail::format("number {}; give 1 to {}", offer.number, max_assets));
    if (held_.contains({stream, offer.number}))
        bad(detail::format("number {} is taken; forget it first, or give another number", offer.number));
    if (parcels_.size() >= max_assets_on_their_way)
        bad(detail::format("{} are on their way already; wait for one of them", parcels_.size()));
    std::uint64_t held = 0, coming = 0;
    for (const auto& [place, asset] : held_)
        if (place.first == stream) held += asset.bytes;
    for (const auto& [ticket, parcel] : parcels_) {
        if (parcel.stream != stream) continue;
        if (parcel.number == offer.number)
            bad(detail::format("number {} is being built; wait for it, or give another number",
                               offer.number));
        if (!parcel.building) coming += parcel.bytes;
    }
    if (offer.bytes == 0 || held >= protocol::max_asset_bytes ||
        offer.bytes > protocol::max_asset_bytes - coming)
        bad(detail::format(
            "{} bytes, besides {} that the claim holds and {} on their way; a claim may hold {}", offer.bytes,
            held, coming, protocol::max_asset_bytes));
}

bool AssetReceiver::offer(std::uint32_t stream, const std::shared_ptr<detail::AssetDoor>& door,
                          std::span<const std::byte> payload, std::string& why) {
    AssetOffer offer;
    if (!take(payload, offer) || !payload.empty() || offer.ticket <= last_ticket_ || !door) {
        why = "a malformed offer of an asset";
        return false;
    }
    last_ticket_ = offer.ticket;
    const auto left = held_.find({stream, offer.number});
    if (left == held_.end() || !left->second.forgotten) return make_place(stream, door, offer, why);
    let_go(left, [this, stream, door, offer, &why] { return make_place(stream, door, offer, why); });
    return true;
}

bool AssetReceiver::make_place(std::uint32_t stream, const std::shared_ptr<detail::AssetDoor>& door,
                               const AssetOffer& offer, std::string& why) {
    try {
        require_place(stream, offer);
        parcels_[offer.ticket] = {.stream = stream,
                                  .number = offer.number,
                                  .bytes = offer.bytes,
                                  .come = 0,
                                  .door = door,
                                  .memory = make_memory(offer.bytes),
                                  .building = {}};
        return true;
    } catch (const Error& error) {
        return refuse(offer.ticket, error, why);
    }
}

bool AssetReceiver::piece(std::span<const std::byte> payload, std::string& why) {
    AssetPiece piece;
    why = "a piece of an asset that does not fit";
    if (!take(payload, piece) || payload.empty() || payload.size() > asset_piece_bytes ||
        piece.ticket > last_ticket_)
        return false;
    if (!say(FrameType::asset_taken, AssetTicket{.ticket = piece.ticket}, why)) return false;
    const auto found = parcels_.find(piece.ticket);
    if (found == parcels_.end()) return true;  // the asset was refused while this piece was on its way
    Parcel& parcel = found->second;
    if (piece.offset != parcel.come || payload.size() > parcel.bytes - parcel.come) return false;
    try {
        if (::pwrite(parcel.memory.get(), payload.data(), payload.size(), static_cast<off_t>(piece.offset)) !=
            static_cast<ssize_t>(payload.size()))
            no_memory(parcel.bytes);
        parcel.come += payload.size();
        if (parcel.come == parcel.bytes) pass_on(piece.ticket, parcel, why);
        return true;
    } catch (const Error& error) {
        parcels_.erase(found);
        return refuse(piece.ticket, error, why);
    }
}

void AssetReceiver::pass_on(std::uint64_t ticket, Parcel& parcel, std::string& why) {
    if (::fcntl(parcel.memory.get(), F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) !=
        0)
        no_memory(parcel.bytes);
    if (!event_) event_ = shm::UniqueFd(::epoll_create1(EPOLL_CLOEXEC));
    auto errand =
        std::make_shared<OfferErrand>(parcel.door, parcel.number, std::move(parcel.memory), parcel.bytes);
    awaited_.ask(errand,
                 [this, ticket, errand = errand.get(), &why] { return passed_on(ticket, *errand, why); });
}

bool AssetReceiver::passed_on(std::uint64_t ticket, OfferErrand& errand, std::string& why) {
    const auto found = parcels_.find(ticket);
    try {
        errand.require_answer();
        Parcel& parcel = found->second;
        parcel.building = std::move(errand.transfer);
        epoll_event event{.events = EPOLLIN, .data = {.u64 = ticket}};
        if (!event_ || ::epoll_ctl(event_.get(), EPOLL_CTL_ADD, parcel.building->event(), &event) != 0)
            no_memory(parcel.bytes);
        return true;
    } catch (const Error& error) {
        parcels_.erase(found);
        return refuse(ticket, error, why);
    }
}

bool AssetReceiver::answers(std::string& why) {
    std::array<epoll_event, max_assets_on_their_way> events;
    const int count = ::epoll_wait(event_.get(), events.data(), static_cast<int>(events.size()), 0);
    for (int i = 0; i < count; ++i) {
        const std::uint64_t ticket = events[static_cast<std::size_t>(i)].data.u64;
        const auto found = parcels_.find(ticket);
        if (found == parcels_.end()) continue;
        try {
            const auto ready = found->second.building->answer(std::chrono::nanoseconds(0));
            if (!ready) continue;
            held_[{found->second.stream, found->second.number}] = {
                .bytes = ready->bytes, .ticket = ticket, .door = found->second.door};
            parcels_.erase(found);
            if (!say(FrameType::asset_ready, AssetReady{.ticket = ticket, .ready = *ready}, why))
                return false;
        } catch (const Error& error) {
            parcels_.erase(found);
            if (!refuse(ticket, error, why)) return false;
        }
    }
    return true;
}

bool AssetReceiver::cancel(std::span<const std::byte> payload, std::string& why) {
    AssetTicket message;
    if (!take(payload, message) || message.ticket > last_ticket_) {
        why = "it cancelled an asset that was never offered";
        return false;
    }
    parcels_.erase(message.ticket);
    // The answer that it is ready may have been on its way.
    const auto found = std::find_if(held_.begin(), held_.end(),
                                    [&](const auto& each) { return each.second.ticket == message.ticket; });
    if (found != held_.end()) let_go(found, [] { return true; });
    return true;
}

bool AssetReceiver::forget(std::uint32_t stream, std::span<const std::byte> payload, std::string& why) {
    AssetForget message;
    why = "it told the servo to forget an asset that it does not have";
    if (!take(payload, message)) return false;
    const auto found = held_.find({stream, message.number});
    if (found == held_.end() || found->second.forgotten) return false;
    let_go(found, [] { return true; });
    return true;
}

/// If the servo does not listen at the moment, it is told when the place is needed again.
void AssetReceiver::let_go(HeldOnes::iterator which, std::function<bool()> then) {
    auto errand = std::make_shared<ForgetErrand>(which->second.door, which->first.second);
    awaited_.ask(errand, [this, which, errand = errand.get(), then = std::move(then)] {
        try {
            errand->require_answer();
            held_.erase(which);
        } catch (const Error&) {
            which->second.forgotten = true;
        }
        return then();
    });
}

void AssetReceiver::drop(std::uint32_t stream) noexcept {
    std::erase_if(parcels_, [&](const auto& each) { return each.second.stream == stream; });
    std::erase_if(held_, [&](const auto& each) { return each.first.first == stream; });
}

}  // namespace knurl::bridge
