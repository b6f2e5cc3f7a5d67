#pragma once
// Verdicts from the blocks of one run: which transports are faster than Knurl, and whether Knurl meets its
// goals.

#include <string>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/measure/compare.hpp>

namespace knurl::shm::peers {

/// Samples of one transport, in us; the blocks of all alternated.
struct Seen {
    std::string name = {}, settings = {};
    measure::Blocks has_it = {}, pays = {};  // sent -> the receiver has it; how long the call took
    measure::Blocks cpu = {};             // of the sender's process, its library's threads and all, a message
    std::size_t sent = 0, overtaken = 0;  // by a newer one, or lost
};

struct Verdicts {
    std::string text;
    knurl::Json json;
};
/// The first is the floor; one is called "Knurl".
Verdicts judge(const std::vector<Seen>& all);
/// A line for each: percentiles of both, in us.
std::string table(const std::vector<Seen>& all);

}  // namespace knurl::shm::peers
