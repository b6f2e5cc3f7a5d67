#include "claim_port.hpp"

#include <algorithm>

namespace knurl::gateway {

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
            if (found != items_.end()) {
                AnyHandle old = found->second;
                items_.erase(found);
                old.remove();
            }
            items_.emplace(change.name, claim_->add_bytes(change.kind, change.params, change.options));
            break;
        case ItemChange::What::set:
            if (found != items_.end()) found->second.set_bytes(change.params);
            break;
        case ItemChange::What::remove:
            if (found == items_.end()) break;
            AnyHandle old = found->second;
            items_.erase(found);
            old.remove();
            break;
    }
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
