#pragma once
// A table of fields describes each representation's parameters once; from it come validation, the keys of
// TOML scenes, the text of every refusal and the layout hash. Nothing here allocates: the servo validates
// with it.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include <knurl/reps/vec.hpp>

namespace knurl {

/// `recovery = automatic`: automatic_fade of the measured update interval (limits.hpp).
inline constexpr double automatic = -1;

struct Field {
    enum class Type : std::uint32_t {
        real,        // double
        vector,      // Vec3
        choice,      // std::uint32_t, one of `choices`
        integer,     // std::uint32_t
        quaternion,  // Quat
        matrix,      // `count` x `count` doubles, row by row
        points,      // `count` times Vec3, behind them a std::uint32_t: how many are used
    };

    std::string_view name;
    Type type = Type::real;
    std::size_t offset = 0;
    std::string_view unit = {};
    std::string_view meaning = {};
    double minimum = -std::numeric_limits<double>::infinity();  // the smallest legal value; of each component
    // so large that no product overflows: force stays finite
    double maximum = std::numeric_limits<double>::infinity();
    bool infinity_allowed = false;                   // "as stiff as this device allows"
    bool automatic_allowed = false;                  // the value `automatic` is legal besides the range
    bool nonzero = false;                            // vectors: length >= 1e-6; quaternions always
    std::span<const std::string_view> choices = {};  // choices: the names of the values 0, 1, ...
    std::uint32_t count = 0;                         // matrices: rows; points: how many there is room for
    std::uint32_t least = 0;                         // points: how many are needed
    bool of_change = false;  // describes a change, not the thing: the next change does not inherit it

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

/// A real number.
constexpr Field number_row(std::string_view name, std::size_t offset, std::string_view unit,
                           std::string_view meaning, double minimum = 0, double maximum = 1e9) {
    return {.name = name,
            .offset = offset,
            .unit = unit,
            .meaning = meaning,
            .minimum = minimum,
            .maximum = maximum};
}
/// A vector whose components are not beyond +-`most`.
constexpr Field vector_row(std::string_view name, std::size_t offset, std::string_view unit,
                           std::string_view meaning, double most = 1e9) {
    Field row = number_row(name, offset, unit, meaning, -most, most);
    row.type = Field::Type::vector;
    return row;
}
/// A vector of which the direction matters.
constexpr Field direction_row(std::string_view name, std::size_t offset, std::string_view meaning) {
    Field row = vector_row(name, offset, "1", meaning);
    row.nonzero = true;
    return row;
}
constexpr Field choice_row(std::string_view name, std::size_t offset, std::string_view meaning,
                           std::span<const std::string_view> choices) {
    return {
        .name = name, .type = Field::Type::choice, .offset = offset, .meaning = meaning, .choices = choices};
}
constexpr Field stiffness_row(std::size_t offset, std::string_view meaning) {
    Field row = number_row("stiffness", offset, "N/m", meaning);
    row.infinity_allowed = true;
    return row;
}
/// `recovery`: the time of a change.
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
    enum class Code : std::uint32_t {
        ok,
        not_finite,
        out_of_range,
        zero_vector,
        no_such_choice,
        contradiction,  // two fields together make no sense; `field` is the one to mend, `reason` says why
        unknown_kind,
        wrong_size,
        no_such_slot,  // no representation in that slot, or of another generation
        slot_in_use,
        no_such_probe,
        too_many,  // a capacity is exhausted
        not_armed,
        refused,  // anything else the device's state forbids; `value` is the protocol's reason
        count,    // points: too few or too many; `value` is how many there are
    };
    Code code = Code::ok;
    std::uint32_t field = no_field;
    double value = 0;
    std::uint32_t reason = 0;  // contradiction: index into Describe<R>::contradictions
    // contradiction: the figure that `value` contradicts, in its unit; no_such_probe: the last that there is
    double against = 0;

    static constexpr std::uint32_t no_field = 0xffffffff, of_options = 0x1000, of_placement = 0x2000;
    explicit operator bool() const noexcept { return code == Code::ok; }
};

/// Checks every field of `params` against its table row, in order; the first that fails is the verdict.
Verdict validate_fields(std::span<const Field> fields, const void* params) noexcept;

/// Each representation R specialises this beside its parameters:
///   static constexpr std::string_view name;       // the TOML table and what people read
///   static constexpr Field fields[];              // one row per parameter (array or std::array)
///   static Verdict check(const R&) noexcept;      // optional: contradictions between fields, and then
///   static constexpr std::string_view contradictions[];  // the reasons; "leaves no hole in the ring"
/// A surface's `check` is of its geometry alone: that of its material is made of every surface, and its reason
/// (static_below_dynamic) comes first.
/// The sentence is "NAME.FIELD = VALUE UNIT REASON"; a {} in the reason becomes `against`, with the unit.
template <class R>
struct Describe;

}  // namespace knurl
