#include "claim_port.hpp"

#include <cstddef>
#include <cstring>

#include <knurl/reps/shape.hpp>

namespace knurl::gateway {

namespace {

std::vector<std::byte> with_asset(std::vector<std::byte> shape, std::uint32_t asset) {
    if (shape.size() == sizeof(Shape))
        std::memcpy(shape.data() + offsetof(Shape, asset), &asset, sizeof asset);
    return shape;
}

}  // namespace

void ClaimPort::open() {
    // Hints are for who writes a program; the peer's forgetting is what this part is for.
    if (!client_)
        client_.emplace(Client::connect(
            options_.servo, {.name = options_.peer, .wait = std::chrono::milliseconds(0), .hints = false}));
    claim_.emplace(client_->claim(options_.device, {.shared = true}));
}

void ClaimPort::close() noexcept {
    force_.reset();
    spring_.reset();
    items_.clear();
    meshes_.clear();
    assets_.clear();
    claim_.reset();
    client_.reset();
}

Seen ClaimPort::look() {
    Seen seen;
    seen.connected = claim_->connected();
    seen.servos = claim_->reattachments();
    if (!seen.connected) return seen;
    if (const auto report = claim_->latest()) {
        seen.state = report->state;
        seen.faults = report->faults;
        seen.position = report->position;
    }
    return seen;
}

void ClaimPort::arm() {
    claim_->arm();
}

void ClaimPort::push(const Push& push, double fade) {
    const ConstantForce params{
        .force = push.force, .torque = push.torque, .recovery = fade < 0 ? automatic : fade};
    if (force_)
        force_->set(params);
    else
        force_.emplace(claim_->add(params, {.feedback = 0}));
}

void ClaimPort::pull(const Vec3& from, const Vec3& to, double duration) {
    // Half of what the device stands: another application may have a surface in the same place.
    Spring params{.anchor = from, .stiffness = 0.5 * claim_->limits().max_stiffness, .duration = duration};
    if (!spring_) spring_.emplace(claim_->add(params, {.feedback = 0}));
    params.anchor = to;
    spring_->set(params);
}

void ClaimPort::let_go() {
    if (spring_) spring_->remove();
    spring_.reset();
}

void ClaimPort::change(const ItemChange& change) {
    const auto found = items_.find(change.name);
    switch (change.what) {
        case ItemChange::What::add:
            meshes_.erase(change.name);
            if (!change.mesh) return place(change);
            meshes_.insert_or_assign(
                change.name, Arriving{claim_->begin_sending(Triangles{.vertices = change.mesh->vertices,
                                                                      .triangles = change.mesh->triangles}),
                                      change});
            break;
        case ItemChange::What::set:
            if (const auto mesh = meshes_.find(change.name); mesh != meshes_.end())
                mesh->second.change.params = change.params;
            if (found == items_.end()) break;
            if (const auto asset = assets_.find(change.name); asset != assets_.end())
                found->second.set_bytes(with_asset(change.params, asset->second));
            else
                found->second.set_bytes(change.params);
            break;
        case ItemChange::What::remove:
            meshes_.erase(change.name);
            take_away(change.name);
            break;
    }
}

void ClaimPort::place(const ItemChange& change) {
    take_away(change.name);
    items_.emplace(change.name, claim_->add_bytes(change.kind, change.params, change.options));
}

void ClaimPort::take_away(const std::string& name) {
    const auto found = items_.find(name);
    if (found == items_.end()) return;
    AnyHandle old = found->second;
    items_.erase(found);
    old.remove();
    const auto asset = assets_.find(name);
    if (asset == assets_.end()) return;
    const std::uint32_t number = asset->second;
    assets_.erase(asset);
    claim_->forget(number);
}

bool ClaimPort::progress() {
    bool placed = false;
    for (auto it = meshes_.begin(); it != meshes_.end();) {
        std::optional<SentShape> sent;
        try {
            sent = it->second.sending.done();
        } catch (const Error&) {
            meshes_.erase(it);
            throw;
        }
        if (!sent) {
            ++it;
            continue;
        }
        ItemChange change = std::move(it->second.change);
        it = meshes_.erase(it);
        change.params = with_asset(change.params, sent->asset);
        place(change);
        assets_[change.name] = sent->asset;
        placed = true;
    }
    return placed;
}

void ClaimPort::commit() {
    claim_->commit();
}

std::map<std::string, PeerFeedback> ClaimPort::feedback() {
    std::map<std::string, PeerFeedback> all;
    for (const auto& [name, handle] : items_) {
        PeerFeedback& one = all[name];
        if (const auto found = handle.feedback()) {
            one.flags = found->flags;
            one.force = found->force;
        }
        one.stiffness = handle.applied_stiffness().value_or(0);
    }
    return all;
}

}  // namespace knurl::gateway
