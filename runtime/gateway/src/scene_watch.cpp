#include "scene_watch.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <knurl/geometry/asset.hpp>
#include <knurl/shm/socket.hpp>
#include <knurl/view/servo_view.hpp>

namespace knurl::gateway {

namespace {

using servo::SceneRecord;

constexpr int most_tries = 3;  // for one asset

/// A struct from the front of these bytes; none: there are too few.
template <class T>
std::optional<T> take_front(std::span<const std::byte>& bytes) {
    if (bytes.size() < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes = bytes.subspan(sizeof value);
    return value;
}

template <class Message>
bool send(const shm::UniqueFd& to, const Message& message) {
    return shm::send_message(to, std::as_bytes(std::span(&message, 1)));
}

}  // namespace

SceneWatch::SceneWatch(const protocol::ServoAddress& servo, std::uint32_t device,
                       std::chrono::milliseconds answer_time)
    : number_(device), connection_(view::connect_to_servo(servo)) {
    std::vector<shm::UniqueFd> segments;
    view::greet(connection_, answer_time, segments);
    ask(answer_time);
}

void SceneWatch::ask(std::chrono::milliseconds answer_time) {
    protocol::WatchRequest request;
    request.device = number_;
    if (!send(connection_, request)) throw std::runtime_error("the servo hung up");
    std::vector<shm::UniqueFd> fds;
    const auto watching =
        view::answer<protocol::Watching>(connection_, protocol::MessageType::watching, answer_time, fds);
    if (fds.size() != 1) throw std::runtime_error("the servo sent no memory to watch");
    memory_ = shm::Segment::open(fds.front().get(), servo::scene_log_bytes, shm::Segment::Access::read_only);
    log_.emplace(memory_.data(), servo::scene_log_slots, watching.from, servo::max_scene_record);
}

bool SceneWatch::look(SeenDevice& device) {
    if (!listen(device)) return false;
    while (true) {
        const auto next = log_->next(record_);
        if (next == servo::RecordLogReader::Next::nothing) break;
        if (next == servo::RecordLogReader::Next::record) take(record_, device);
        if (next == servo::RecordLogReader::Next::gap && !asked_anew_) {
            protocol::WatchRequest anew;
            anew.device = number_;
            if (!send(connection_, anew)) return false;
            asked_anew_ = true;
        }
    }
    ask_for_assets(device);
    return true;
}

bool SceneWatch::listen(SeenDevice& device) {
    alignas(8) std::byte buffer[sizeof(protocol::Refused)];
    while (true) {
        shm::Received received = shm::receive_message(connection_, buffer, shm::Block::no);
        if (received.nothing) return true;
        protocol::MessageHeader header;
        if (received.closed || received.bytes < sizeof header) return false;
        std::memcpy(&header, buffer, sizeof header);
        if (header.type == protocol::MessageType::watching) asked_anew_ = false;  // the same memory once more
        if (header.type != protocol::MessageType::shown_asset &&
            header.type != protocol::MessageType::refused)
            continue;
        if (!wanted_) continue;
        const Wanted wanted = *wanted_;
        wanted_.reset();
        const auto claim = device.claims.find(wanted.claim);
        if (claim == device.claims.end()) continue;
        const auto asset = claim->second.assets.find(wanted.number);
        if (asset == claim->second.assets.end()) continue;
        if (header.type == protocol::MessageType::refused || received.fds.size() != 1 ||
            received.bytes != sizeof(protocol::ShownAsset)) {
            ++tried_[{wanted.claim, wanted.number}];
            continue;
        }
        try {
            protocol::ShownAsset shown;
            std::memcpy(&shown, buffer, sizeof shown);
            const auto memory = std::make_shared<shm::Segment>(
                shm::Segment::open_sealed(received.fds.front().get(), shown.bytes));
            DrawnTriangles drawn =
                asset_of(std::span<const std::byte>(memory->data(), memory->size()), memory)->drawn();
            asset->second = std::make_shared<const SeenAsset>(
                SeenAsset{.vertices = std::move(drawn.vertices), .triangles = std::move(drawn.triangles)});
            ++device.scene_version;
        } catch (const std::exception&) {  // no memory for it, or no descriptor: it is not drawn
            ++tried_[{wanted.claim, wanted.number}];
        }
    }
}

void SceneWatch::ask_for_assets(SeenDevice& device) {
    if (wanted_) return;
    for (const auto& [number, claim] : device.claims) {
        for (const auto& [asset, read] : claim.assets) {
            if (read != nullptr || tried_[{number, asset}] >= most_tries) continue;
            protocol::ShowAsset request;
            request.device = number_;
            request.row = claim.row;
            request.number = asset;
            if (send(connection_, request)) wanted_ = Wanted{.claim = number, .number = asset};
            return;
        }
    }
}

void SceneWatch::forget(SeenDevice& device, std::uint64_t claim, std::optional<std::uint32_t> slot) {
    ++device.scene_version;
    device.gone.push_back({.version = device.scene_version, .claim = claim, .slot = slot});
    // So many that a peer who reads them but once a second finds them all.
    constexpr std::size_t most = 20'000;
    if (device.gone.size() > most)
        device.gone.erase(device.gone.begin(), device.gone.begin() + static_cast<std::ptrdiff_t>(most / 2));
}

void SceneWatch::take(const servo::LogRecord& record, SeenDevice& device) {
    if (record.type == static_cast<std::uint16_t>(SceneRecord::begin)) {
        for (const auto& [number, claim] : device.claims) forget(device, number, std::nullopt);
        device.claims.clear();
        return;
    }
    Bytes bytes(record.bytes);
    const auto number = take_front<std::uint64_t>(bytes);
    if (!number) return;
    const auto type = static_cast<SceneRecord>(record.type);
    if (type == SceneRecord::claim) return take_claim(device, *number, bytes);
    const auto found = device.claims.find(*number);
    if (found == device.claims.end()) return;
    SeenClaim& claim = found->second;
    switch (type) {
        case SceneRecord::claim_gone:
            device.claims.erase(found);
            forget(device, *number, std::nullopt);
            return;
        case SceneRecord::probe:
            if (const auto probe = take_front<servo::SceneProbe>(bytes)) {
                claim.probes[probe->probe] = probe->placement;
                ++device.scene_version;
            }
            return;
        case SceneRecord::item: {
            const auto item = take_front<servo::SceneItem>(bytes);
            if (!item || item->kind >= kinds().size() || bytes.size() < kinds()[item->kind].size) return;
            SeenItem& seen = claim.items[item->id.slot];
            if (!(seen.id == item->id)) seen.feedback = {};
            seen.id = item->id;
            seen.kind = item->kind;
            seen.options = item->options;
            seen.params.assign(bytes.begin(),
                               bytes.begin() + static_cast<std::ptrdiff_t>(kinds()[item->kind].size));
            seen.version = ++device.scene_version;
            return;
        }
        case SceneRecord::item_gone:
            if (const auto id = take_front<RepresentationId>(bytes)) {
                claim.items.erase(id->slot);
                forget(device, *number, id->slot);
            }
            return;
        case SceneRecord::felt:
            return take_felt(claim, bytes);
        default:
            return;
    }
}

void SceneWatch::take_claim(SeenDevice& device, std::uint64_t number, Bytes bytes) {
    const auto told = take_front<servo::SceneClaim>(bytes);
    if (!told) return;
    SeenClaim& claim = device.claims[number];
    claim.number = number;
    claim.row = told->row;
    claim.frame = told->frame;
    std::erase_if(claim.assets, [&](const auto& asset) {
        const bool there = (told->assets >> (asset.first - 1) & 1) != 0;
        if (!there) tried_.erase({number, asset.first});
        return !there;
    });
    for (std::uint32_t i = 0; i < 64; ++i)
        if ((told->assets >> i & 1) != 0) claim.assets.try_emplace(i + 1, nullptr);
    ++device.scene_version;
}

void SceneWatch::take_felt(SeenClaim& claim, Bytes bytes) {
    const auto felt = take_front<servo::SceneFelt>(bytes);
    if (!felt) return;
    claim.asleep = felt->asleep != 0;
    for (auto& [slot, item] : claim.items) item.feedback = {};
    for (std::uint32_t i = 0; i < felt->contacts; ++i) {
        const auto contact = take_front<servo::SceneContact>(bytes);
        if (!contact) return;
        const auto item = claim.items.find(contact->id.slot);
        if (item == claim.items.end() || !(item->second.id == contact->id)) continue;
        item->second.feedback = {
            .flags = contact->flags, .force = contact->force, .contact = contact->contact};
    }
}

}  // namespace knurl::gateway
