#pragma once
// The tray from the side, with the ways of its bodies and of the hand, and the force over time, as a PNG.

#include <string>

#include "play.hpp"

namespace bodies {

/// Throws std::runtime_error.
void draw(const std::string& path, const World& world, const Played& played, const std::string& title,
          const std::string& machine);

/// Every cycle: `t,x,y,z,fx,fy,fz` and the middles of the bodies as of the newest frame.
void write_csv(const std::string& path, const World& world, const Played& played);

}  // namespace bodies
