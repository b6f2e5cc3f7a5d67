#pragma once
// How the scene sees a kind: functions over raw bytes, made from the typed ones.

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include <knurl/reps/all.hpp>
#include <knurl/reps/curved_contact.hpp>
#include <knurl/reps/hand_load.hpp>
#include <knurl/reps/motion.hpp>
#include <knurl/reps/scene.hpp>

#include "scene/scene_records.hpp"
#include "scene/scene_state.hpp"

namespace knurl::detail {

class EffectStage;

/// Upper bounds of one part: in N/m and N s/m, or as shares of the device's limits.
struct Demand {
    double stiffness = 0, damping = 0;
};

/// How checked parameters differ from those in the slot.
enum class Differ : std::uint8_t { nowhere, in_geometry, anywhere };

/// What an update of its geometry has done to a surface that stood still.
enum class Reshaped : std::uint8_t { nothing, elsewhere, moves };

struct KindOps {
    bool surface = false;
    bool turns = false;          // a surface whose velocity is that of its contact point
    bool curved = false;         // a surface that may not be flat
    bool follows = false;        // a surface that the proxy enters and leaves: see ProxyPath
    std::uint32_t contacts = 1;  // tangent planes of a surface, at most
    std::size_t params_size = 0, state_size = 0;
    // The parameters as they act, after clamping.
    void (*prepare)(const std::byte* raw, const Limits&, std::byte* prepared) noexcept = nullptr;
    // True: the bytes equal those in use. A change of recovery alone is noted for the next change.
    bool (*unchanged)(std::byte* prepared, Record& now) noexcept = nullptr;
    std::size_t geometry_bytes = 0;
    // How new geometry differs from the present one; illegal geometry counts as `anywhere`.
    Differ (*compare_geometry)(const std::byte* raw, const std::byte* sent) noexcept = nullptr;
    // Moves a surface that stands still: `out` has all but the geometry. If the surface moves from now on,
    // `out` must be made anew.
    Reshaped (*reshape)(const std::byte* raw, const Record& now, Record& out) noexcept = nullptr;
    // Installs parameters and what follows from them, not state and options. Writes `tangential` only where
    // the record says so.
    void (*install)(const std::byte* prepared, const Limits&, Record& out,
                    TangentialRecord& tangential) noexcept = nullptr;
    void (*adopt)(Record& now, const Record* previous, const Probe&, const Assets&) noexcept = nullptr;
    void (*settle)(Record&) noexcept = nullptr;
    double (*fade_time)(const std::byte* params) noexcept = nullptr;         // s, or automatic
    double (*requested_stiffness)(const std::byte* raw) noexcept = nullptr;  // N/m
    Demand (*load_bound)(const Record&, const Limits&) noexcept = nullptr;   // of an effect
    HandLoad (*load)(const Record&, const Probe&) noexcept = nullptr;        // of an effect, at the probe
    bool (*carry)(Record& old, const Record& next) noexcept = nullptr;       // true: the rest is equal too
    std::optional<Bound> (*bound)(const Record&) noexcept = nullptr;
    // Of an effect: its force is zero wherever the probe is; it has no more gradual change under way.
    bool (*powerless)(const Record&) noexcept = nullptr;
    bool (*arrived)(const Record&) noexcept = nullptr;
    // Of an endless surface that stands still: m, a lower bound of its distance.
    std::optional<double> (*clearance)(const Record&, const Probe&) noexcept = nullptr;
    void (*out_of_reach)(Record&) noexcept = nullptr;         // forgets its path so far
    Motion* (*motion)(Record&) noexcept = nullptr;            // of a surface
    const Asset* (*asset)(const Record&) noexcept = nullptr;  // the one that it consists of; null: none
    std::uint32_t (*contact)(Record&, const Probe&, double dt, std::span<Contact> out) noexcept = nullptr;
    std::uint32_t (*curved_at)(const Record&, const Probe&, const Probe& there,
                               std::span<CurvedContact> out) noexcept = nullptr;
    void (*lean)(Record&, const Probe& there, double below) noexcept = nullptr;
    // Null: one plane holds in all layers.
    bool (*plane_alone)(const Record&, const Probe&, double stiffness, CurvedContact& out) noexcept = nullptr;
    Wrench (*evaluate)(Record&, const Probe&, double dt) noexcept = nullptr;
    void (*evaluate_all)(EffectStage&, std::span<const std::uint32_t> slots, double dt,
                         Wrench& sum) noexcept = nullptr;
};
extern const std::array<KindOps, Representations::size> all_ops;
inline const std::array<KindOps, Representations::size>& kind_ops() noexcept {
    return all_ops;
}

/// s, over which a change of the record reaches the hand.
inline double fade_time(const Record& record, const FadePolicy& policy) noexcept {
    const double time = kind_ops()[record.kind].fade_time(record.params);
    return time == automatic ? policy.automatic : time;
}

}  // namespace knurl::detail
