#pragma once
// What the scene knows of a kind: functions over raw bytes, made from the typed ones.

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

/// Of one part, at most: in N/m and N s/m, or as shares of what the device stands.
struct Demand {
    double stiffness = 0, damping = 0;
};

/// Of parameters that were checked, against those that stand in the slot.
enum class Differ : std::uint8_t { nowhere, in_geometry, anywhere };

/// What an update of its geometry has made of a surface that stood.
enum class Reshaped : std::uint8_t { nothing, elsewhere, moves };

struct KindOps {
    bool surface = false;
    bool turns = false;          // a surface's velocity is that of its contact
    bool curved = false;         // a surface that may not be flat
    bool follows = false;        // a surface that the proxy enters and leaves: see ProxyPath
    std::uint32_t contacts = 1;  // tangent planes of a surface, at most
    std::size_t params_size = 0, state_size = 0;
    // Parameters as they would be felt.
    void (*prepare)(const std::byte* raw, const Limits&, std::byte* prepared) noexcept = nullptr;
    // They are the bytes that are felt; another recovery alone is noted for the change that it will belong
    // to.
    bool (*unchanged)(std::byte* prepared, Record& now) noexcept = nullptr;
    std::size_t geometry_bytes = 0;
    // How a geometry that was sent differs from the one that is there: anywhere, that is not legal.
    Differ (*compare_geometry)(const std::byte* raw, const std::byte* sent) noexcept = nullptr;
    // Puts a surface that stands elsewhere: `out` has all but the geometry. If it moves from now on, `out` is to be made anew.
    Reshaped (*reshape)(const std::byte* raw, const Record& now, Record& out) noexcept = nullptr;
    // Parameters and what follows from them; not state and options. `tangential` only where the record says
    // so.
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
    // Of an effect: it gives nothing wherever the probe is; it has nothing more to arrive at by itself.
    bool (*powerless)(const Record&) noexcept = nullptr;
    bool (*arrived)(const Record&) noexcept = nullptr;
    // Of a surface without an end that stands still: m, it is no nearer.
    std::optional<double> (*clearance)(const Record&, const Probe&) noexcept = nullptr;
    void (*out_of_reach)(Record&) noexcept = nullptr;         // its path so far is forgotten
    Motion* (*motion)(Record&) noexcept = nullptr;            // of a surface
    const Asset* (*asset)(const Record&) noexcept = nullptr;  // that it is made of; null: of none
    std::uint32_t (*contact)(Record&, const Probe&, double dt, std::span<Contact> out) noexcept = nullptr;
    std::uint32_t (*curved_at)(const Record&, const Probe&, const Probe& there,
                               std::span<CurvedContact> out) noexcept = nullptr;
    void (*lean)(Record&, const Probe& there, double below) noexcept = nullptr;
    // Null: it holds by one plane in all layers.
    bool (*plane_alone)(const Record&, const Probe&, double stiffness, CurvedContact& out) noexcept = nullptr;
    Wrench (*evaluate)(Record&, const Probe&, double dt) noexcept = nullptr;
    void (*evaluate_all)(EffectStage&, std::span<const std::uint32_t> slots, double dt,
                         Wrench& sum) noexcept = nullptr;
};
extern const std::array<KindOps, Representations::size> all_ops;
inline const std::array<KindOps, Representations::size>& kind_ops() noexcept {
    return all_ops;
}

/// s, over which a change of what it stands for reaches the hand.
inline double fade_time(const Record& record, const FadePolicy& policy) noexcept {
    const double time = kind_ops()[record.kind].fade_time(record.params);
    return time == automatic ? policy.automatic : time;
}

}  // namespace knurl::detail
