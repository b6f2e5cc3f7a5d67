#pragma once
// Cycles on a timeline, as Chrome's trace JSON, which Perfetto reads too.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/measure/sleeper.hpp>
#include <knurl/protocol/report.hpp>

#include "top_rates.hpp"

namespace knurl::cli {

using measure::Nanoseconds;

/// How long each part of one cycle took, as the servo stamped it.
struct CycleParts {
    std::uint64_t cycle = 0;
    std::array<Nanoseconds, cycle_parts.size()> ns{};
};

/// From the sums that a servo's counters show at two looks, the parts of each cycle that it stamped in
/// between.
class PartsWatch {
  public:
    static constexpr std::uint64_t every = 64;  // cycles, of which the servo stamps one

    /// A look at the counters; `before` and `after`: the newest cycle that was reported before and after it.
    void look(const DeviceView& device, std::uint64_t before, std::uint64_t after);
    /// In their order.
    const std::vector<CycleParts>& seen() const { return seen_; }

  private:
    struct Sums {
        std::uint64_t cycle = 0, stamped = 0;  // the newest that is in them; how many are
        std::array<std::uint64_t, cycle_parts.size()> ns{};
    };
    std::optional<Sums> last_;
    std::vector<CycleParts> seen_;
};

/// What was seen of one device.
struct Timeline {
    std::string servo, device, address;
    double rate = 0;                // Hz
    std::vector<Report> reports{};  // in their order
    std::vector<CycleParts> parts{};
    std::string cause{};  // of a servo that died, else empty
};

/// A stretch of a timeline's reports, and the one that it is about.
struct Stretch {
    std::size_t begin = 0, middle = 0, end = 0;
    // the cycle of it that is drawn in all its parts; none: none was stamped
    std::optional<std::uint64_t> stamped{};
    bool late = false;  // the middle is a late cycle
};

enum class Around { last, late };

/// last: around the newest cycle whose parts are known (none: the newest). late: around the newest cycle that
/// was late, or if none was, that which was read latest. With so many neighbours on each side, and as many
/// more as it takes until a cycle with parts is among them. `timeline` has a report.
Stretch choose(const Timeline& timeline, Around around, std::size_t neighbours);

/// Each cycle is an event from its deadline (or the end of the cycle before, if that is later) until it has
/// written, with what it did as events inside.
knurl::Json to_trace(const Timeline& timeline, const Stretch& stretch);

}  // namespace knurl::cli
