#pragma once
// What the sweep must show: each claim with the measured value, and whether it holds.

#include <string>
#include <vector>

#include "table.hpp"

namespace stability {

struct Claim {
    std::string text, measured;
    bool holds = false;
    bool goal = false;  // a figure to reach; else the direction of a main claim, whose failure is an error
};

/// Of the tables of a whole sweep.
std::vector<Claim> claims_of(const std::vector<Table>& tables);
/// Of the tables of a remote application.
std::vector<Claim> network_claims(const std::vector<Table>& tables);
/// The directions alone, by a few searches of their own: a few seconds.
std::vector<Claim> quick_claims();
/// Strokes in worlds a hundredth and a thousand times as large as the device feel the same as in one of its
/// size.
std::vector<Claim> world_claims();

std::string markdown(const std::vector<Claim>& claims);
/// True if every claim of a direction holds.
bool sound(const std::vector<Claim>& claims);

}  // namespace stability
