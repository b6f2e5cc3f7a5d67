#include "offline_hand.hpp"

namespace bodies {

namespace {

knurl::servo::ServoOptions servo_options(bool clamp) {
    knurl::servo::ServoOptions options;
    options.silence = false;
    options.start_active = true;
    options.clamp_stiffness = clamp;
    return options;
}

}  // namespace

OfflineHand::OfflineHand(const std::string& address, const knurl::drivers::Motion& motion, bool clamp)
    : device_(knurl::drivers::sim_profile(address), motion), servo_(device_, servo_options(clamp)) {
    knurl::servo::ClaimTerms terms;
    terms.limits = knurl::servo::limits_for(device_.link(), 1000, terms.frame);
    terms.update_interval = 1.0 / 60;
    claim_ = &servo_.claim(terms);
    claim_->arm();
}

std::uint32_t OfflineHand::send(const Skin& skin) {
    meshes_.push_back(std::make_unique<knurl::Mesh>(
        knurl::Triangles{.vertices = skin.vertices, .triangles = skin.triangles}, knurl::MeshBuild{}));
    const auto number = static_cast<std::uint32_t>(meshes_.size());
    servo_.servo().give(&claim_->servo_side(), number, meshes_.back().get());
    return number;
}

const knurl::Report& OfflineHand::step() {
    const knurl::Report& report = servo_.step();
    feedback_ = &claim_->feedback();
    ++cycles_;
    return report;
}

std::optional<knurl::HandFeedback> OfflineHand::feedback(knurl::RepresentationId id) const {
    if (!feedback_) return {};
    for (const auto& entry : feedback_->entries)
        if (entry.id == id)
            return knurl::HandFeedback{.force = entry.force,
                                       .torque = entry.torque,
                                       .contact_point = entry.contact_point,
                                       .stiffness = entry.stiffness,
                                       .tangential_stiffness = entry.tangential_stiffness,
                                       .flags = entry.flags,
                                       .cycle = feedback_->header.cycle};
    return {};
}

}  // namespace bodies
