#pragma once
// The two records of each slot: what is felt, and what fades out. They change roles whenever a surface changes.

#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include <knurl/reps/friction.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/reps/texture.hpp>

namespace knurl::detail {

// Of any list of kinds: so a kind that nobody uses does not even move the others in memory.
static_assert(max_parameter_bytes % 16 == 0, "parameters as they were sent lie one behind the other");
inline constexpr std::size_t max_params = (max_parameter_bytes + 63) / 64 * 64;

/// Tangent planes that one surface may have at once.
inline constexpr std::uint32_t max_contacts = 3;

/// All that a set is built from, and all that changes when a plane that stands is put elsewhere: one line of
/// memory, since a batch of updates costs what it touches.
struct RecordLine {
    HalfSpace plane;       // of a surface that stands still
    double weight = 1;     // by silence: 1 in full, 0 faded away
    double stiffness = 0;  // N/m
    Kind kind = 0;
    std::uint8_t probe = 0;           // that of `options`
    bool stands : 1 = false;          // one plane until it changes
    bool recovers : 1 = false;        // brings its own changes in; not cross-faded
    bool summed : 1 = false;          // its force is added, not solved with the others
    bool has_tangential : 1 = false;  // there is something to feel along it: see TangentialRecord
    bool textured : 1 = false;
    bool clamped : 1 = false;   // less stiff than asked for
    bool reported : 1 = false;  // feedback is asked for
};
static_assert(sizeof(RecordLine) == 64);

struct RecordHead : RecordLine {
    AddOptions options;
    // The cycle in which it was evaluated, or as if it had been: again in the same one, it is with dt = 0.
    std::uint64_t evaluated_cycle = 0;
    double moved = 0;  // s, of its scene's time: as far has it moved on, if it turns
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, of the surface
};

/// What a surface feels like along it, beside its record: touched only where there is something.
struct TangentialRecord {
    FrictionLaw law;
    Texture texture;
    double braking = 0;
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m, by which its velocity has carried the texture
    double share = 1;                                 // of the friction, where it is touched
    std::array<double, max_contacts> height{};        // m, of each contact, without the relief
};

struct alignas(64) Record : RecordHead {
    alignas(64) std::byte params[max_params] = {};
    alignas(64) std::byte state[max_state_bytes] = {};
};

/// Names a record: each slot has two, which change roles whenever its surface changes. A frozen plane stands
/// for an interrupted fade.
using Owner = std::uint32_t;
inline constexpr Owner frozen_plane_owner = 0xffffffff;

class Records {
  public:
    explicit Records(std::size_t slots) : records_(2 * slots), tangential_(2 * slots), current_(slots) {}

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

    /// What is felt becomes what fades out.
    void swap_roles(std::uint32_t slot) noexcept { current_[slot] ^= 1; }
    void reset() noexcept { std::fill(current_.begin(), current_.end(), std::uint8_t{0}); }

  private:
    std::vector<Record> records_;               // by Owner
    std::vector<TangentialRecord> tangential_;  // by Owner
    std::vector<std::uint8_t> current_;         // by slot: which of its two records is felt
};

/// As long as the kind's parameters and state are.
void copy(const Record& from, Record& to) noexcept;

}  // namespace knurl::detail
