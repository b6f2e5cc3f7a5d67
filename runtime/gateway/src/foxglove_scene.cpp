#include "foxglove_scene.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include <knurl/reps/all.hpp>

namespace knurl::gateway {

namespace {

// What is larger is sent anew twice a second at most, however often it changes: a marker is changed only by sending
// all of it. 24 bytes a point.
constexpr std::size_t large_points = 3000;
constexpr auto large_every = std::chrono::milliseconds(500);
constexpr std::uint32_t most_slots = 1U << 20;  // so that a marker's number is an int32

std::string namespace_of(std::uint64_t claim) {
    return fmt::format("claim {}", claim);
}

messages::Marker erased(std::uint64_t claim, std::int32_t id) {
    messages::Marker marker;
    marker.ns = namespace_of(claim);
    marker.id = id;
    marker.action = messages::Marker::erase;
    return marker;
}

/// About what it takes in a message.
std::size_t bytes_of(const messages::Marker& marker) {
    return 400 + marker.points.size() * sizeof(Vec3);
}

double distance(const Vec3& a, const Vec3& b) {
    return (to_eigen(a) - to_eigen(b)).norm();
}

/// The number of the asset that an item's parameters name; 0: none.
std::uint32_t asset_of(const SeenItem& item) {
    Shape shape;
    if (item.kind != kind_of<Shape> || item.params.size() != sizeof shape) return 0;
    std::memcpy(&shape, item.params.data(), sizeof shape);
    return shape.asset;
}
std::shared_ptr<const SeenAsset> find_asset(const SeenClaim& claim, const SeenItem& item) {
    const auto found = claim.assets.find(asset_of(item));
    return found == claim.assets.end() ? nullptr : found->second;
}

Vec3 hand_of(const SeenDevice& device) {
    return device.newest ? device.newest->position : device.info.workspace_centre;
}

}  // namespace

FoxgloveScene::Look FoxgloveScene::look_of(const SeenClaim& claim, const SeenItem& item) {
    Look look;
    look.generation = item.id.generation;
    look.version = item.version;
    // A mesh is large, and it is hard to see whether a triangle of it has changed its colour.
    look.touching = item.kind != kind_of<Shape> && (item.feedback.flags & Feedback::touching) != 0;
    look.fading = item.kind != kind_of<Shape> && (item.feedback.flags & Feedback::fading) != 0;
    look.silent = (item.feedback.flags & Feedback::silent) != 0;
    look.asleep = claim.asleep;
    look.asset = find_asset(claim, item);
    look.frame = claim.frame;
    return look;
}

std::vector<messages::Marker> FoxgloveScene::markers_of(const SeenDevice& device, const SeenClaim& claim,
                                                        const SeenItem& item, const Look& look,
                                                        const Vec3& hand) {
    messages::Triangles triangles;
    const SeenAsset* asset = look.asset.get();
    if (asset != nullptr) triangles = {asset->vertices, asset->triangles};
    const messages::Item drawn{.kind = item.kind,
                               .params = item.params,
                               .frame = claim.frame,
                               .triangles = asset != nullptr ? &triangles : nullptr,
                               .touching = look.touching,
                               .fading = look.fading,
                               .silent = look.silent,
                               .asleep = look.asleep};
    return messages::draw(drawn, {.hand = hand, .reach = device.info.workspace_radius},
                          namespace_of(claim.number),
                          static_cast<std::int32_t>(item.id.slot * messages::most_parts));
}

void FoxgloveScene::wait(messages::Marker marker) {
    waiting_bytes_ += bytes_of(marker);
    waiting_.push_back(std::move(marker));
}

void FoxgloveScene::draw(const SeenDevice& device, const SeenClaim& claim, const SeenItem& item, Time now) {
    const Vec3 hand = hand_of(device);
    const Look look = look_of(claim, item);
    const auto before = drawn_.find({claim.number, item.id.slot});
    if (before != drawn_.end()) {
        const Drawn& was = before->second;
        const bool moved =
            distance(was.hand, hand) >
            messages::redraw_distance(item.kind, {.hand = hand, .reach = device.info.workspace_radius});
        if (was.look == look && !moved) return;
        if (was.points > large_points && now - was.at < large_every) return;
    }
    Drawn next{.look = look, .hand = hand, .ids = {}, .points = 0, .at = now};
    std::vector<messages::Marker> markers = markers_of(device, claim, item, look, hand);
    for (messages::Marker& marker : markers) {
        next.ids.insert(marker.id);
        next.points += marker.points.size();
        wait(std::move(marker));
    }
    // A part that it has no more, as an arrow of a force that has become 0.
    if (before != drawn_.end())
        for (const std::int32_t id : before->second.ids)
            if (!next.ids.contains(id)) wait(erased(claim.number, id));
    drawn_[{claim.number, item.id.slot}] = std::move(next);
}

void FoxgloveScene::draw_changes(const SeenDevice& device, Time now) {
    std::map<Key, std::pair<const SeenClaim*, const SeenItem*>> there;
    for (const auto& [number, claim] : device.claims)
        for (const auto& [slot, item] : claim.items)
            if (slot < most_slots && slot == item.id.slot) there[{number, slot}] = {&claim, &item};
    for (auto one = drawn_.begin(); one != drawn_.end();) {
        if (there.contains(one->first)) {
            ++one;
            continue;
        }
        for (const std::int32_t id : one->second.ids) wait(erased(one->first.first, id));
        one = drawn_.erase(one);
    }
    // On from where the last call ended: what changes all the time does not keep the rest from being drawn.
    auto next = there.upper_bound(last_);
    for (std::size_t n = there.size(); n > 0 && waiting_bytes_ < most_bytes; --n, ++next) {
        if (next == there.end()) next = there.begin();
        last_ = next->first;
        draw(device, *next->second.first, *next->second.second, now);
    }
}

std::vector<messages::Marker> FoxgloveScene::changes(const SeenDevice& device, Time now) {
    if (!begun_) {
        begun_ = true;
        messages::Marker all;
        all.action = messages::Marker::erase_all;
        wait(std::move(all));
    }
    // Nothing is drawn before what was drawn has been sent, so no more than this waits.
    if (waiting_bytes_ < most_bytes) draw_changes(device, now);
    std::vector<messages::Marker> out;
    for (std::size_t bytes = 0; !waiting_.empty(); waiting_.pop_front()) {
        const std::size_t more = bytes_of(waiting_.front());
        if (!out.empty() && bytes + more > most_bytes) break;
        bytes += more;
        waiting_bytes_ -= more;
        out.push_back(std::move(waiting_.front()));
    }
    return out;
}

}  // namespace knurl::gateway
