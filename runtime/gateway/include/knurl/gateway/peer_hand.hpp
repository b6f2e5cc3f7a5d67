#pragma once

/// @file
/// A claim that a gateway holds for a foreign peer, which knows nothing of claims: it sends a force now and then, and
/// one day it does not.
///
///     PeerHand hand({.servo = "knurl:default", .device = "right", .peer = "inverse 127.0.0.1:40312"});
///     if (auto refused = hand.push({0, 0, 1}, "set_cursor_force.vector"); !refused.empty()) answer(refused);
///     hand.sent();                               // the message has ended: what it brought takes effect together
///     for (auto& said : hand.said()) log(said);  // what happened meanwhile, a line each
///
/// The claim is shared, and is made with the first command that can be felt. What the peer commands is held for a lapse
/// time after it was commanded last; then it fades. Some seconds later the device is released. The end of this object
/// releases it at once.
///
/// No call here waits for a servo: a thread of its own, which begins with the claim, carries the newest commands to it
/// (arm() alone may wait a second). All calls come from one thread.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/reps/kind.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl::gateway {

/// How a PeerHand behaves.
struct PeerOptions {
    /// As Client::connect takes it.
    std::string servo = "knurl:default";
    /// Name of the device.
    std::string device{};
    /// Who it is, as `knurl top` shows it.
    std::string peer = "gateway";
    /// It may switch the force on. Otherwise it is felt while somebody else has.
    bool may_arm = true;
    /// How long a command is held.
    std::chrono::nanoseconds lapse = std::chrono::milliseconds(100);
    /// How long the force of a peer that has stopped takes to fade.
    std::chrono::nanoseconds fade = std::chrono::milliseconds(50);
    /// How long after its last command a device is released that has none of its representations.
    std::chrono::nanoseconds release_after = std::chrono::seconds(5);
    /// Time between two tries to claim or to arm.
    std::chrono::nanoseconds retry = std::chrono::seconds(1);
    /// Time between two looks at a mesh that is on its way to the servo.
    std::chrono::nanoseconds look_at_mesh = std::chrono::milliseconds(2);
    /// Speed with which a target of pull() moves to a new place (m/s).
    double target_speed = 0.25;
    /// Largest force that is believed (N): more is a mistake, and is refused. What is less the servo limits to what the
    /// device can do.
    double most_force = 1000;
    /// Largest torque that is believed (N m).
    double most_torque = 100;
    /// Largest coordinate of a target that is believed (m).
    double farthest = 10;
    /// What time it is.
    std::function<std::chrono::steady_clock::time_point()> clock = std::chrono::steady_clock::now;
};

/// A line about a peer's claim.
struct Said {
    /// How bad it is.
    enum class Level {
        /// It works.
        info,
        /// It does not, or not any more; the peer's next commands may change that.
        warning,
        /// It does not until somebody does something.
        error
    };
    /// How bad it is.
    Level level = Level::info;
    /// What it is about: "claim" (somebody else holds it), "arm", "fault", "servo", "command".
    std::string subject;
    /// The line.
    std::string text;
};

/// What a representation of the peer does, by the newest look at it.
struct PeerFeedback {
    /// Bit mask of Feedback::touching and the others.
    std::uint32_t flags = 0;
    /// Force on the hand (N), device frame.
    Vec3 force;
    /// Stiffness as applied (N/m); 0: not known yet.
    double stiffness = 0;
};

/// How the claim stands.
struct PeerStatus {
    /// The device is claimed for this peer.
    bool claimed = false;
    /// This peer's force is switched on.
    bool armed = false;
    /// A force or a target of it is held.
    bool commands = false;
    /// Its representations, by the names that it gave.
    std::map<std::string, PeerFeedback> representations{};
};

/// A mesh of a peer's: it is sent once, and is then a Shape.
struct PeerMesh {
    /// The vertices (m), in the mesh's own frame, whose axes are those of the device.
    std::vector<std::array<double, 3>> vertices;
    /// Three vertices each, counter-clockwise as seen from free space.
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What a peer may command, as a protocol sees it: a PeerHand, or what a test puts in its place. All vectors are in the
/// device's frame. What returns text returns why it is refused, in one line; empty: it is not.
class PeerCommands {
  public:
    virtual ~PeerCommands() = default;

    /// A force on the hand (N) and a torque about the tip (N m). `field` is its name in a refusal. Nothing at all claims
    /// nothing.
    virtual std::string push(const Vec3& force, const Vec3& torque, std::string_view field) = 0;
    /// A force alone.
    std::string push(const Vec3& force, std::string_view field) { return push(force, {}, field); }
    /// A spring draws the hand to that position (m), half as stiff as the device stands. It begins where the hand is.
    virtual std::string pull(const Vec3& target, std::string_view field) = 0;

    /// A representation under a name of the peer's. One of that name is replaced. The parameters are complete and
    /// checked.
    virtual std::string add(const std::string& name, Kind kind, const std::vector<std::byte>& params,
                            const AddOptions& options = {}) = 0;
    /// A mesh under a name of the peer's, as a Shape whose `asset` is left 0. What had that name stays until the servo has
    /// made its form of the mesh; a mesh that it refuses is said. set() moves it.
    virtual std::string mesh(const std::string& name, std::shared_ptr<const PeerMesh>,
                             const std::vector<std::byte>&) {
        return "'" + name + "' is a mesh, and meshes are not taken here";
    }
    /// New parameters for one that was added.
    virtual std::string set(const std::string& name, const std::vector<std::byte>& params) = 0;
    /// It fades over its recovery.
    virtual std::string remove(const std::string& name) = 0;
    /// Removes all.
    virtual void clear() = 0;

    /// The peer is alive, and all that it said in this message is said: it takes effect together, newest wins.
    virtual void sent() = 0;
    /// How the claim stands.
    virtual PeerStatus status() const = 0;
    /// What there is to say since the call before, in order.
    virtual std::vector<Said> said() = 0;
};

/// A claim held for a peer.
class PeerHand final : public PeerCommands {
  public:
    /// Most representations at once.
    static constexpr std::size_t most_representations = 120;

    /// Claims nothing yet.
    explicit PeerHand(PeerOptions options);
    /// Releases the device. Does not wait for it.
    ~PeerHand() override;
    PeerHand(const PeerHand&) = delete;
    PeerHand& operator=(const PeerHand&) = delete;

    using PeerCommands::push;
    std::string push(const Vec3& force, const Vec3& torque, std::string_view field) override;
    std::string pull(const Vec3& target, std::string_view field) override;
    std::string add(const std::string& name, Kind kind, const std::vector<std::byte>& params,
                    const AddOptions& options = {}) override;
    std::string mesh(const std::string& name, std::shared_ptr<const PeerMesh> mesh,
                     const std::vector<std::byte>& shape) override;
    std::string set(const std::string& name, const std::vector<std::byte>& params) override;
    std::string remove(const std::string& name) override;
    void clear() override;
    void sent() override;
    PeerStatus status() const override;
    std::vector<Said> said() override;

  private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace knurl::gateway
