#pragma once
// The two records of each slot: the current one, and the old one that fades out. They change roles whenever a
// surface changes.

#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include <knurl/reps/friction.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/reps/texture.hpp>

namespace knurl::detail {

// The size is the same for any list of kinds, so an unused kind does not move the others in memory.
static_assert(max_parameter_bytes % 16 == 0, "parameters as they were sent lie one behind the other");
inline constexpr std::size_t max_params = (max_parameter_bytes + 63) / 64 * 64;

/// The most tangent planes of one surface.
inline constexpr std::uint32_t max_contacts = 3;

/// All that a set is built from, and all that changes when a standing plane is moved. One cache line, since
/// the cost of a batch is the memory that it touches.
struct RecordLine {
    HalfSpace plane;       // of a surface that stands still
    double weight = 1;     // in silence: 1 full strength, 0 faded out
    double stiffness = 0;  // N/m
    Kind kind = 0;
    std::uint8_t probe = 0;           // that of `options`
    bool stands : 1 = false;          // one plane until it changes
    bool recovers : 1 = false;        // applies its own changes gradually; not cross-faded
    bool summed : 1 = false;          // its force is summed, not solved with the others
    bool has_tangential : 1 = false;  // it has a tangential part: see TangentialRecord
    bool textured : 1 = false;
    bool clamped : 1 = false;   // less stiff than requested
    bool reported : 1 = false;  // feedback is requested
};
static_assert(sizeof(RecordLine) == 64);

/// A surface that the proxy of a softer layer has entered while that of a harder one lay deeper. For that one
/// the surface lies lower, until it rises: see scene_gaps.cpp.
struct Gap {
    double depth = 0;   // m, below its face
    double softer = 0;  // share of its own stiffness: the layers up to it are held by the face itself
};

struct RecordHead : RecordLine {
    AddOptions options;
    // The last cycle in which it was evaluated, or caught up. In the same cycle it is evaluated with dt = 0.
    std::uint64_t evaluated_cycle = 0;
    double moved = 0;  // s, of its scene's time: its motion is computed up to here, if it turns
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, of the surface
};

/// The tangential part of a surface, beside its record, so that only surfaces with such a part touch this
/// memory.
struct TangentialRecord {
    FrictionLaw law;
    Texture texture;
    double braking = 0;
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m, by which its velocity has carried the texture
    double share = 1;                                 // of the friction, at the place of contact
    std::array<double, max_contacts> height{};        // m, of each contact, without the relief
};

struct alignas(64) Record : RecordHead {
    alignas(64) std::byte params[max_params] = {};
    alignas(64) std::byte state[max_state_bytes] = {};
};

/// Names a record: each slot has two, which change roles whenever its surface changes. A frozen plane
/// represents an interrupted fade.
using Owner = std::uint32_t;
inline constexpr Owner frozen_plane_owner = 0xffffffff;

class Records {
  public:
    explicit Records(std::size_t slots)
        : records_(2 * slots), tangential_(2 * slots), current_(slots), gaps_(slots) {}

    Owner owner(std::uint32_t slot, bool old) const noexcept {
        return slot * 2 + (current_[slot] ^ (old ? 1u : 0u));
    }
    bool fades_out(Owner owner) const noexcept { return (owner & 1) != current_[owner >> 1]; }
    Record& operator[](Owner owner) noexcept { return records_[owner]; }
    const Record& operator[](Owner owner) const noexcept { return records_[owner]; }
    Record& current(std::uint32_t slot) noexcept { return records_[owner(slot, false)]; }
    const Record& current(std::uint32_t slot) const noexcept { return records_[owner(slot, false)]; }
    Record& old(std::uint32_t slot) noexcept { return records_[owner(slot, true)]; }
    const Record& old(std::uint32_t slot) const noexcept { return records_[owner(slot, true)]; }
    TangentialRecord& tangential(Owner owner) noexcept { return tangential_[owner]; }
    const TangentialRecord& tangential(Owner owner) const noexcept { return tangential_[owner]; }
    /// Of a slot: what fades out shares it with its successor, which is the same surface elsewhere.
    Gap& gap(Owner owner) noexcept { return gaps_[owner >> 1]; }
    const Gap& gap(Owner owner) const noexcept { return gaps_[owner >> 1]; }

    /// The current record becomes the old one.
    void swap_roles(std::uint32_t slot) noexcept { current_[slot] ^= 1; }
    void reset() noexcept {
        std::fill(current_.begin(), current_.end(), std::uint8_t{0});
        std::fill(gaps_.begin(), gaps_.end(), Gap{});
    }

  private:
    std::vector<Record> records_;               // by Owner
    std::vector<TangentialRecord> tangential_;  // by Owner
    std::vector<std::uint8_t> current_;         // by slot: index of the current record
    std::vector<Gap> gaps_;                     // by slot
};

/// Copies as many bytes as the kind's parameters and state have.
void copy(const Record& from, Record& to) noexcept;

}  // namespace knurl::detail
