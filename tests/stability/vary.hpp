#pragma once
// One factor at a time.

#include <initializer_list>

#include <fmt/format.h>

#include "cases.hpp"

namespace stability {

/// The centre with one change: a variant for each value, which `set(conditions, value)` applies; `scale` and
/// `unit` name it.
template <class Set>
void vary(std::vector<Variant>& out, const char* what, double scale, const char* unit,
          std::initializer_list<double> values, Set&& set, const Conditions& centre = {}) {
    for (const double value : values) {
        Conditions c = centre;
        set(c, value);
        out.push_back({fmt::format("{} {:g}{}", what, value * scale, unit), value, c});
    }
}

}  // namespace stability
