#pragma once
// Force on the hand, length of the spring, the atom's way, and who has put how much energy where, over time:
// a PNG.

#include <string>

#include "dock.hpp"

namespace dock {

/// `title`: one line above, `machine`: one below. Throws std::runtime_error.
void draw(const std::string& path, const Docked& docked, const DockOptions& options, const std::string& title,
          const std::string& machine);

}  // namespace dock
