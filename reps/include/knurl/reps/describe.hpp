#pragma once

#include <string>

#include <knurl/reps/kind.hpp>

namespace knurl {

/// A verdict as one line for people: where, which field, its value and unit, what is legal. Allocates: never
/// called in a servo's cycle. `where` says which object or file and line ("floor", "scene.toml:12:13"); may
/// be empty.
std::string describe(const Verdict& verdict, Kind kind, std::string_view where);
/// The same of a kind by its table; null: of an unknown kind.
std::string describe(const Verdict& verdict, const KindInfo* kind, std::string_view where);

}  // namespace knurl
