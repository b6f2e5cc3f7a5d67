#pragma once

/// @file
/// The scene log: while somebody watches a device's scenes, its servo writes here what is in them. The memory is
/// mapped read-only by whoever watches.
///
/// When a watcher comes, everything is written anew behind a record `begin`, a little in each cycle; from then on,
/// what changes. A slot that changes in every cycle is written as often as there is time, always as it is then: the
/// log has states, not events. While nobody watches, a cycle reads one pointer for it.

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/servo/record_log.hpp>

namespace knurl::servo {

/// Types of records, and what is in each. All but the first begin with the number of the claim (std::uint64_t).
enum class SceneRecord : std::uint16_t {
    /// Nothing: all that was there before is void, and comes again.
    begin = 1,
    /// SceneClaim: a claim is there, or its assets have changed.
    claim,
    /// A claim has gone.
    claim_gone,
    /// SceneProbe: a probe was placed.
    probe,
    /// SceneItem, then its parameters: a representation is there, or has changed.
    item,
    /// RepresentationId: it was removed.
    item_gone,
    /// SceneFelt, then so many SceneContact: what is touched; written up to 30 times a second while something is.
    felt,
};

/// A claim.
struct SceneClaim {
    /// Row in the device's table of clients.
    std::uint32_t row = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// A bit for each asset that it has, by its number less 1.
    std::uint64_t assets = 0;
    /// Its world.
    protocol::Frame frame;
};

/// Where a probe of a claim was placed.
struct SceneProbe {
    /// Its number.
    std::uint32_t probe = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Where it is.
    ProbePlacement placement;
};

/// A representation of a claim; its parameters follow.
struct SceneItem {
    /// Slot and generation.
    RepresentationId id;
    /// Its kind.
    Kind kind = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// How it is used.
    AddOptions options;
};

/// What the hand feels of a claim.
struct SceneFelt {
    /// 1: its scene is out of the hand's reach, and is not evaluated.
    std::uint32_t asleep = 0;
    /// Number of contacts that follow.
    std::uint32_t contacts = 0;
};

/// A representation that acts on the hand, in the claim's world.
struct SceneContact {
    /// Which one.
    RepresentationId id;
    /// Bit mask of Feedback::touching and the others.
    std::uint32_t flags = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Force on the hand (N).
    Vec3 force;
    /// Contact point (m).
    Vec3 contact;
};

static_assert(std::is_trivially_copyable_v<SceneClaim> && std::is_trivially_copyable_v<SceneItem> &&
              std::is_trivially_copyable_v<SceneProbe> && std::is_trivially_copyable_v<SceneContact>);

/// Number of slots of the log: 1 MiB.
inline constexpr std::uint32_t scene_log_slots = 8192;
/// Bytes of its memory.
inline constexpr std::size_t scene_log_bytes = record_log_bytes(scene_log_slots);
/// Cycles from one turn to the next: by turns changes are written, and what is touched.
inline constexpr std::uint64_t scene_log_turn = 4;
/// Most changes that a turn writes, each a record.
inline constexpr std::uint32_t most_scene_changes = 8;
/// Most claims of which a turn writes what is touched.
inline constexpr int most_scene_felt = 4;
/// Most contacts of a claim in one record.
inline constexpr std::uint32_t most_scene_contacts = 32;
/// Most bytes of a record.
inline constexpr std::size_t max_scene_record = 4096;
static_assert(sizeof(SceneFelt) + most_scene_contacts * sizeof(SceneContact) + 8 <= max_scene_record);
static_assert(sizeof(SceneItem) + protocol::max_parameter_bytes + 8 <= max_scene_record);

}  // namespace knurl::servo
