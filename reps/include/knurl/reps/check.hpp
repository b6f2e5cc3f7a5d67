#pragma once

/// @file
/// Whether a change makes sense, decided in one place for all who have to know: the application's library
/// before it sends, the servo before it believes, a scene before it changes, a scene file before it is
/// played. Each refusal has one sentence (describe.hpp). Nothing here allocates.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include <knurl/reps/scene.hpp>

namespace knurl {

// How a representation is used and where a probe is placed have tables of fields, as parameters have. A Verdict
// counts their rows from Verdict::of_options and Verdict::of_placement.

/// Names of OnSilence's values.
inline constexpr std::string_view silence_names[] = {"fade", "hold", "move"};

template <>
struct Describe<AddOptions> {
    static constexpr Field fields[] = {
        {.name = "probe",
         .type = Field::Type::integer,
         .offset = offsetof(AddOptions, probe),
         .meaning = "which probe it acts on",
         .minimum = 0,
         .maximum = max_probes - 1},
        choice_row("on_silence", offsetof(AddOptions, on_silence),
                   "what it does when its application falls silent", silence_names),
        {.name = "silence_time",
         .offset = offsetof(AddOptions, silence_time),
         .unit = "s",
         .meaning = "for how long `move` goes on",
         .minimum = 0},
    };
};

template <>
struct Describe<ProbePlacement> {
    static constexpr double farthest = 1e9;  // m
    static constexpr std::string_view name = "probe";
    static constexpr Field fields[] = {
        vector_row("offset", offsetof(ProbePlacement, offset), "m", "from the tip, in the frame of the tool",
                   farthest),
        number_row("radius", offsetof(ProbePlacement, radius), "m", "of the probe", 0, farthest),
    };
};

/// Checks kind, size, fields and contradictions.
Verdict check_parameters(Kind kind, const void* params, std::size_t bytes) noexcept;
/// Checks how a representation is used. `probes`: how many there are, at most max_probes.
Verdict check_options(const AddOptions& options, std::uint32_t probes = max_probes) noexcept;
/// Checks where a probe is placed. `probes`: how many there are.
Verdict check_placement(std::uint32_t probe, const ProbePlacement& placement,
                        std::uint32_t probes = max_probes) noexcept;
/// Checks a representation that is to be added: its use, then its parameters.
Verdict check_added(Kind kind, const void* params, std::size_t bytes, const AddOptions& options,
                    std::uint32_t probes = max_probes) noexcept;

/// True: the slot holds a representation of that generation. `slots`: an array of structs with `present` and
/// `generation`, kept by the caller.
template <class Slots>
bool names_one(RepresentationId id, const Slots& slots) noexcept {
    return id.slot < slots.size() && slots[id.slot].present && slots[id.slot].generation == id.generation;
}
/// Checks a representation that is to be changed or removed.
template <class Slots>
Verdict check_named(RepresentationId id, const Slots& slots) noexcept {
    if (names_one(id, slots)) return {};
    return {Verdict::Code::no_such_slot, Verdict::no_field, static_cast<double>(id.slot)};
}
/// Checks the slot of a representation that is to be added.
template <class Slots>
Verdict check_vacant(RepresentationId id, const Slots& slots) noexcept {
    using Code = Verdict::Code;
    if (id.slot >= slots.size())
        return {Code::too_many, Verdict::no_field, static_cast<double>(slots.size())};
    if (slots[id.slot].present) return {Code::slot_in_use, Verdict::no_field, static_cast<double>(id.slot)};
    return {};
}

}  // namespace knurl
