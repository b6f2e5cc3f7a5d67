#include "search.hpp"

#include <algorithm>
#include <cmath>

namespace stability {

Search::Search(Run run, Seeds seeds, unsigned criteria)
    : run_(std::move(run)), seeds_(seeds), criteria_(criteria) {}

bool Search::stable(int rung, unsigned criteria) {
    const auto known = broken_.find(rung);
    if (known != broken_.end()) return (known->second & criteria) == 0;
    const bool alone = (criteria_ & ~criteria) == 0;  // no other criterion will follow: the first break
                                                      // decides
    unsigned broken = 0;
    for (unsigned seed = seeds_.first; seed < seeds_.end(); ++seed) {
        broken |= run_(lowest * std::pow(ratio, rung), seed, alone ? criteria : 0).broken();
        if ((broken & criteria_) == criteria_ || (alone && (broken & criteria))) break;
    }
    broken_[rung] = broken;
    return (broken & criteria) == 0;
}

Search::Found Search::largest(unsigned criteria) {
    int low = 0;
    if (!stable(low, criteria)) return {};
    int high = low;
    do {
        low = high;
        if (low == top) return {lowest * std::pow(ratio, top), true};
        high = std::min(low + stride, top);
    } while (stable(high, criteria));
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (stable(middle, criteria) ? low : high) = middle;
    }
    return {lowest * std::pow(ratio, low), false};
}

}  // namespace stability
