#pragma once

/// @file
/// A table of fields describes each representation's parameters once; from it come validation, the keys of
/// TOML scenes, the text of every refusal and the layout hash. Nothing here allocates: the servo validates
/// with it.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include <knurl/reps/vec.hpp>

namespace knurl {

/// Value of `recovery`: automatic_fade of the measured update interval (limits.hpp).
inline constexpr double automatic = -1;

/// One parameter of a representation: name, place in memory, unit, meaning, range.
struct Field {
    /// Type of a parameter.
    enum class Type : std::uint32_t {
        /// A double.
        real,
        /// A Vec3.
        vector,
        /// A std::uint32_t, one of `choices`.
        choice,
        /// A std::uint32_t.
        integer,
        /// A Quat.
        quaternion,
        /// `count` x `count` doubles, row by row.
        matrix,
        /// `count` times Vec3, then a std::uint32_t: how many are used.
        points,
    };

    /// Name of the parameter, as in scene files.
    std::string_view name;
    /// Its type.
    Type type = Type::real;
    /// Its offset in the parameters (bytes).
    std::size_t offset = 0;
    /// Its unit; "1": none.
    std::string_view unit = {};
    /// What it means, in a few words.
    std::string_view meaning = {};
    /// Smallest legal value, of each component.
    double minimum = -std::numeric_limits<double>::infinity();
    /// Largest legal value, of each component: so large that no product overflows, so that forces stay
    /// finite.
    double maximum = std::numeric_limits<double>::infinity();
    /// True: infinity is legal, "as stiff as this device allows".
    bool infinity_allowed = false;
    /// True: the value `automatic` is legal besides the range.
    bool automatic_allowed = false;
    /// True: the vector's length must be 1e-6 or more. Quaternions must always be so.
    bool nonzero = false;
    /// Of a choice: the names of the values 0, 1, ...
    std::span<const std::string_view> choices = {};
    /// Of a matrix: rows; of points: how many there is room for.
    std::uint32_t count = 0;
    /// Of points: how many are needed.
    std::uint32_t least = 0;
    /// True: it describes a change, not the thing; the next change does not inherit it.
    bool of_change = false;
    /// 0: as long as the kind; else a row that came later: the higher, the later. In the structs of the C
    /// library, which may only grow at their ends, it stands behind all rows with less.
    std::uint32_t since = 0;

    /// How many doubles stand at `offset`; the types that hold none have a std::uint32_t there.
    constexpr std::size_t reals() const noexcept {
        switch (type) {
            case Type::real:
                return 1;
            case Type::vector:
                return 3;
            case Type::quaternion:
                return 4;
            case Type::matrix:
                return std::size_t{count} * count;
            case Type::points:
                return std::size_t{3} * count;
            case Type::choice:
            case Type::integer:
                break;
        }
        return 0;
    }
    /// All of its bytes, those that say how many points are used included.
    constexpr std::size_t bytes() const noexcept {
        const bool whole_number = reals() == 0 || type == Type::points;
        return reals() * sizeof(double) + (whole_number ? sizeof(std::uint32_t) : 0);
    }
};

// Rows that most tables have.

/// Row of a real number.
constexpr Field number_row(std::string_view name, std::size_t offset, std::string_view unit,
                           std::string_view meaning, double minimum = 0, double maximum = 1e9) {
    return {.name = name,
            .offset = offset,
            .unit = unit,
            .meaning = meaning,
            .minimum = minimum,
            .maximum = maximum};
}
/// Row of a vector whose components are within +-`most`.
constexpr Field vector_row(std::string_view name, std::size_t offset, std::string_view unit,
                           std::string_view meaning, double most = 1e9) {
    Field row = number_row(name, offset, unit, meaning, -most, most);
    row.type = Field::Type::vector;
    return row;
}
/// Row of a vector of which the direction matters.
constexpr Field direction_row(std::string_view name, std::size_t offset, std::string_view meaning) {
    Field row = vector_row(name, offset, "1", meaning);
    row.nonzero = true;
    return row;
}
/// Row of a choice between named values.
constexpr Field choice_row(std::string_view name, std::size_t offset, std::string_view meaning,
                           std::span<const std::string_view> choices) {
    return {
        .name = name, .type = Field::Type::choice, .offset = offset, .meaning = meaning, .choices = choices};
}
/// Row of `stiffness` (N/m), 0 to 1e9 or infinity.
constexpr Field stiffness_row(std::size_t offset, std::string_view meaning) {
    Field row = number_row("stiffness", offset, "N/m", meaning);
    row.infinity_allowed = true;
    return row;
}
/// Row of `recovery`: the time of a change (s).
constexpr Field recovery_row(std::size_t offset) {
    return {.name = "recovery",
            .offset = offset,
            .unit = "s",
            .meaning = "time over which a change reaches the hand",
            .minimum = 0,
            .maximum = 1000,
            .automatic_allowed = true,
            .of_change = true};
}

/// The answer to a check. `field` is a row of the representation's table, or counted from `of_options` of
/// AddOptions', or from `of_placement` of ProbePlacement's (check.hpp); `value` is the offending number.
struct Verdict {
    /// What was wrong.
    enum class Code : std::uint32_t {
        /// Nothing.
        ok,
        /// A number is not finite.
        not_finite,
        /// A number is out of its range.
        out_of_range,
        /// A direction or quaternion has no length.
        zero_vector,
        /// A choice has no such value.
        no_such_choice,
        /// Two fields together make no sense; `field` is the one to change, `reason` says why.
        contradiction,
        /// There is no such kind of representation.
        unknown_kind,
        /// The parameters have another size than the kind's.
        wrong_size,
        /// There is no representation in that slot, or one of another generation.
        no_such_slot,
        /// There is a representation in that slot already.
        slot_in_use,
        /// There is no such probe.
        no_such_probe,
        /// A capacity is exhausted.
        too_many,
        /// The claim is not armed.
        not_armed,
        /// The device's state forbids it for another reason; `value` is the protocol's reason.
        refused,
        /// Points: too few or too many; `value` is how many there are.
        count,
    };
    /// What was wrong; ok: nothing.
    Code code = Code::ok;
    /// Which row of the table; no_field: none.
    std::uint32_t field = no_field;
    /// The number that is wrong.
    double value = 0;
    /// Of a contradiction: index into Describe<R>::contradictions.
    std::uint32_t reason = 0;
    /// Of a contradiction: the figure that `value` contradicts, in its unit. Of no_such_probe: the last probe
    /// that there is.
    double against = 0;

    /// Value of `field`: it is about no field.
    static constexpr std::uint32_t no_field = 0xffffffff;
    /// From here on `field` counts rows of AddOptions.
    static constexpr std::uint32_t of_options = 0x1000;
    /// From here on `field` counts rows of ProbePlacement.
    static constexpr std::uint32_t of_placement = 0x2000;
    /// True: ok.
    explicit operator bool() const noexcept { return code == Code::ok; }
};

/// Checks every field of `params` against its table row, in order; the first that fails is the verdict.
Verdict validate_fields(std::span<const Field> fields, const void* params) noexcept;

/// Each representation R specialises this beside its parameters:
///   static constexpr std::string_view name;       // the TOML table and what people read
///   static constexpr Field fields[];              // one row per parameter (array or std::array)
///   static Verdict check(const R&) noexcept;      // optional: contradictions between fields, and then
///   static constexpr std::string_view contradictions[];  // the reasons; "leaves no hole in the ring"
/// A surface's `check` is of its geometry alone: that of its material is made of every surface, and its
/// reason (static_below_dynamic) comes first. The sentence is "NAME.FIELD = VALUE UNIT REASON"; a {} in the
/// reason becomes `against`, with the unit.
template <class R>
struct Describe;

}  // namespace knurl
