#pragma once
// The largest stable stiffness: up a ladder from below to the first rung that is not stable, then bisection.

#include <functional>
#include <map>

#include "judge.hpp"

namespace stability {

/// Figures of one run: stiffness (N/m), seed, criteria that end it early (0: none does).
using Run = std::function<Figures(double stiffness, unsigned seed, unsigned criteria)>;

/// The runs of each case; the worst one counts.
struct Seeds {
    unsigned first = 1, count = 10;
    unsigned end() const { return first + count; }
};

/// Stability above an unstable stiffness does not count: the first unstable rung ends the search.
class Search {
  public:
    static constexpr double lowest = 50, ratio = 1.02;  // N/m; rungs are 2 % apart
    static constexpr int stride = 12, top = 300;        // rungs: 27 % at a time first; 19 000 N/m

    /// `criteria`: all that will be used; a run ends once all of them are broken.
    Search(Run run, Seeds seeds, unsigned criteria);

    struct Found {
        double stiffness = 0;  // N/m; 0: not even the lowest rung is stable
        bool at_top = false;   // the ladder's top is stable
    };
    /// The highest rung before the first one at which some seed breaks one of `criteria`.
    Found largest(unsigned criteria);

  private:
    bool stable(int rung, unsigned criteria);

    Run run_;
    Seeds seeds_;
    unsigned criteria_;
    std::map<int, unsigned> broken_;  // by rung
};

}  // namespace stability
