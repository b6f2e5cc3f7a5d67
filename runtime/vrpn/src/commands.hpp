#pragma once
// What one client commands on one device, as representations of a PeerHand. It knows no socket. Private to this module.

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <knurl/gateway/peer_hand.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/constraint.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/vrpn/mapping.hpp>
#include <knurl/vrpn/messages.hpp>

#include "trimeshes.hpp"

namespace knurl::vrpn {

/// What became of a message.
struct Outcome {
    /// Why it is refused, in one line; empty: it is not.
    std::string refused{};
    /// What of it is not felt, in one line; empty: all is.
    std::string remark{};
};

class Commands {
  public:
    Commands(std::unique_ptr<gateway::PeerCommands> hand, const Mapping& mapping)
        : hand_(std::move(hand)), mapping_(mapping), trimeshes_(*hand_, mapping_) {}

    /// A message of this type. `max_stiffness` (N/m): of the device.
    Outcome take(Type type, std::span<const std::byte> payload, double max_stiffness);
    /// The newest report: a plane's buzz is felt while a surface is touched, an effect for its time.
    void look(const Report& report);
    gateway::PeerCommands& hand() { return *hand_; }

  private:
    struct PlaneState {
        Plane plane;
        bool there = false;
    };
    template <class R>
    std::string put(const std::string& name, const R& params);
    void drop(const std::string& name);

    Outcome plane(std::span<const std::byte> payload, double max_stiffness);
    Outcome plane_effects(std::span<const std::byte> payload);
    Outcome effect(std::span<const std::byte> payload);
    Outcome field(std::span<const std::byte> payload);
    Outcome constraint(Type type, std::span<const std::byte> payload);
    std::string hold();
    std::string buzz();
    Outcome trimesh(Type type, std::span<const std::byte> payload, double max_stiffness);

    std::unique_ptr<gateway::PeerCommands> hand_;
    const Mapping& mapping_;
    Trimeshes trimeshes_;
    std::array<PlaneState, most_planes> planes_;
    std::size_t last_plane_ = 0;
    PlaneEffectsMessage effects_;
    bool touched_ = false;
    std::array<float, 6> effect_{0, 100, 0, 0, 0, 1};  // as EffectMessage has them
    std::int64_t effect_ends_ns_ = 0;  // by the reports' clock; 0: it begins with the next report
    Constraint constraint_;            // in the client's axes
    bool constrained_ = false;
    std::int32_t mode_ = 0;
    std::array<Vec3, 5> constraint_at_{};  // by type, from constraint_point on
    std::set<std::string> there_;
};

/// A message that commands a force, or would.
bool commands_force(Type type) noexcept;

}  // namespace knurl::vrpn
