#pragma once
// Numbers of a TOML table with their units, and errors that name their place. Private to this folder.

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include <knurl/drivers/arm_file.hpp>

namespace knurl::drivers {

/// "215", "0.215": as a person writes numbers.
std::string in_text(double number);

/// One table of the file. Each number that is read is noted in `figures` with its source: KEY_source, else
/// the table's `source`, else the file's.
class ArmTable {
  public:
    /// `called`: "row 2", "[tip]". Throws if a key is not in `known` (KEY_source and source are always
    /// allowed).
    ArmTable(ArmFile& arm, const toml::table& table, std::string called,
             std::initializer_list<std::string_view> known);

    struct Range {
        std::string_view unit;
        double least, greatest;
        bool zero_too = true;  // false: the value must exceed `least`
    };

    bool has(std::string_view key) const { return table_.contains(key); }
    /// Nothing if the key is missing. Throws unless it is a finite number within the range.
    std::optional<double> number(std::string_view key, const Range& range);
    /// m; an error above 3 m says that lengths are in metres.
    std::optional<double> length(std::string_view key);
    /// rad: KEY in radians or KEY_deg in degrees; an error says so if the value looks like the other unit.
    std::optional<double> angle(std::string_view key);
    /// `count` angles in rad, likewise; for sliding axes m (only as KEY).
    std::optional<std::vector<double>> angles(std::string_view key, std::size_t count,
                                              const std::vector<bool>& sliding = {});
    /// Two ordered angles (m if sliding), or "unknown"; nothing if the key is missing.
    std::optional<Between> between(std::string_view key, bool sliding);
    std::optional<std::vector<double>> numbers(std::string_view key, std::size_t count, const Range& range);
    std::optional<std::string> text(std::string_view key) const;
    bool flag(std::string_view key) const;  // false if the key is missing

    /// Throws "FILE:LINE:COLUMN: what", at the key if it is there, else at the table.
    [[noreturn]] void fail(std::string_view key, const std::string& what) const;
    [[noreturn]] void fail_at(const toml::node& node, const std::string& what) const;

    const std::string& called() const { return called_; }
    /// "a of row 2".
    std::string name_of(std::string_view key) const { return std::string(key) + " of " + called_; }
    const toml::table& table() const { return table_; }
    /// Notes a number that was read here.
    void note(std::string_view key, std::string value);
    /// A finite number, in a list or alone; `what` is its name in errors.
    double value(const toml::node& node, const std::string& what) const;
    double length_of(const toml::node& node, const std::string& what) const;
    double angle_of(const toml::node& node, const std::string& what, std::string_view key,
                    bool degrees) const;

  private:
    /// The node of KEY or KEY_deg, and which one it is; null if neither is there. Throws if both are.
    const toml::node* angle_node(std::string_view key, bool& degrees) const;
    const toml::array& list(const toml::node& node, const std::string& what, std::size_t count,
                            std::string_view unit) const;

    ArmFile& arm_;
    const toml::table& table_;
    std::string called_;
};

}  // namespace knurl::drivers
