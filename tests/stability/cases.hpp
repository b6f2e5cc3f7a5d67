#pragma once
// The parts of the sweep's tables: methods, cases, and the search for one case.

#include <string>
#include <vector>

#include "search.hpp"
#include "table.hpp"

namespace stability {

struct NamedMethod {
    const char* name;
    Method method;
};
/// Every path from the application's model to the hand, by its name in tables and plots.
const std::vector<NamedMethod>& methods();
const Method& method(const std::string& name);

namespace way {
inline constexpr const char* force = "force from the application";
inline constexpr const char* planes = "planes as they come";
inline constexpr const char* paper = "paper's recovery, 50 ms";
inline constexpr const char* faded = "cross-faded";
inline constexpr const char* usual = "predicted, faded (default)";
inline constexpr const char* cap = "cap, predicted, faded";
}  // namespace way

/// What "strictly" means in the goals.
inline constexpr unsigned goals = jump | kick;

/// A hand that drops on a flat wall and rests.
Conditions at_rest(Conditions c = {});
Conditions with(Conditions c, const Method& method);

/// The largest stiffness on the bench, and through the real servo on a simulated device.
Value largest(const Conditions& c, Seeds seeds, unsigned criteria = strict);
Value largest_on(const std::string& profile, const Conditions& c, Seeds seeds);
/// The same for several sets of criteria, from the same runs.
std::vector<Value> largest_of_each(const Conditions& c, Seeds seeds, const std::vector<unsigned>& criteria);

/// A case with its place on an axis.
struct Variant {
    std::string name;
    double x;
    Conditions c;
};

}  // namespace stability
