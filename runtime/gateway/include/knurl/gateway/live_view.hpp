#pragma once

/// @file
/// One servo, looked at once a tick for all sockets: what the page, Foxglove and others show is read once, however many
/// look. All of it is in the device's frame but the scenes, each of which is in its claim's world (Frame).

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/reps/probe.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/view/rates.hpp>

namespace knurl::gateway {

/// What a representation does, as the servo said last.
struct SeenFeedback {
    /// Bit mask of Feedback::touching and the others.
    std::uint32_t flags = 0;
    /// Force on the hand (N), world frame of the claim.
    Vec3 force;
    /// Contact point (m), world frame of the claim.
    Vec3 contact;
};

/// A representation of a claim, as it is in force.
struct SeenItem {
    /// Slot and generation.
    RepresentationId id;
    /// Its kind.
    Kind kind = 0;
    /// How it is used.
    AddOptions options;
    /// Its parameters, kinds()[kind].size bytes.
    std::vector<std::byte> params;
    /// Counts its changes, over all items of the device.
    std::uint64_t version = 0;
    /// What it does; of what is not touched, flags alone.
    SeenFeedback feedback;
};

/// A mesh or height field as triangles, in the world frame of its claim, before the pose of a shape.
struct SeenAsset {
    /// Vertices (m): x, y, z of each.
    std::vector<float> vertices;
    /// Three numbers of vertices for each triangle.
    std::vector<std::uint32_t> triangles;
};

/// The scene of a claim.
struct SeenClaim {
    /// Number of the claim, never used twice by a servo.
    std::uint64_t number = 0;
    /// Row in the device's table of clients.
    std::uint32_t row = 0;
    /// Its world.
    protocol::Frame frame;
    /// Probes that were placed, by number.
    std::map<std::uint32_t, ProbePlacement> probes;
    /// Representations by slot.
    std::map<std::uint32_t, SeenItem> items;
    /// Assets by number; null: known by number, not read yet.
    std::map<std::uint32_t, std::shared_ptr<const SeenAsset>> assets;
    /// Its scene is out of the hand's reach, and is not evaluated.
    bool asleep = false;
};

/// A device of the servo.
struct SeenDevice {
    /// What it is.
    protocol::DeviceInfo info;
    /// Counters, clients and what happened since the rates were computed last (four times a second).
    view::DeviceRates rates;
    /// Reports since the tick before, in order.
    std::vector<Report> fresh;
    /// The newest report.
    std::optional<Report> newest;
    /// Reports that were overwritten before a tick came.
    std::uint64_t missed = 0;
    /// Points of the arm from base to tip, as of the newest report (m); empty: its links are not known.
    std::vector<Vec3> arm;
    /// Scenes by number of the claim.
    std::map<std::uint64_t, SeenClaim> claims;
    /// Changes with every change of `claims`, but for feedback.
    std::uint64_t scene_version = 0;
    /// What was removed lately: (scene_version at that time, claim, slot; no slot: the whole claim).
    struct Gone {
        std::uint64_t version = 0;
        std::uint64_t claim = 0;
        std::optional<std::uint32_t> slot;
    };
    /// Of the last ten seconds.
    std::vector<Gone> gone;
};

/// Looks at one servo, and finds it again after a restart. Belongs to one thread.
class LiveView {
  public:
    /// `servo`: as Client::connect takes it, on this host. Throws nothing: trouble() says why it is not connected.
    explicit LiveView(std::string servo);
    ~LiveView();

    /// Looks. Connects at most once a second where it is not connected; waits for nothing else.
    void tick(std::chrono::steady_clock::time_point now);

    /// The servo answers.
    bool connected() const;
    /// Why not: one line; empty while connected.
    const std::string& trouble() const;
    /// Name of the servo.
    const std::string& name() const;
    /// Its process; 0: not connected.
    pid_t pid() const;
    /// Changes when another servo has taken the place of the one before: all that was read is void.
    std::uint64_t epoch() const;
    /// Its devices; empty while it was never connected.
    std::span<const SeenDevice> devices() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::gateway
