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
#include <knurl/view/rates.hpp>

namespace knurl::cli {

using namespace view;

using measure::Nanoseconds;

/// The duration of each part of one cycle, as the servo stamped it.
struct CycleParts {
    std::uint64_t cycle = 0;
    std::array<Nanoseconds, cycle_parts.size()> ns{};
};

/// Separates the parts of each stamped cycle from the sums that a servo's counters show at two looks.
class PartsWatch {
  public:
    static constexpr std::uint64_t every = 64;  // cycles, one of which is stamped

    /// A look at the counters; `before` and `after`: the newest reported cycles before and after it.
    void look(const DeviceView& device, std::uint64_t before, std::uint64_t after);
    /// In their order.
    const std::vector<CycleParts>& seen() const { return seen_; }

  private:
    struct Sums {
        std::uint64_t cycle = 0, stamped = 0;  // the newest cycle included; the number of stamped cycles
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

/// A stretch of a timeline's reports, and its subject.
struct Stretch {
    std::size_t begin = 0, middle = 0, end = 0;
    // the cycle drawn with all its parts; none: none was stamped
    std::optional<std::uint64_t> stamped{};
    bool late = false;  // the middle is a late cycle
};

enum class Around { last, late };

/// last: around the newest cycle with known parts (none: the newest). late: around the newest late cycle or,
/// if none was late, the one that was read latest. Has so many neighbours on each side, and more until a
/// cycle with parts is included. `timeline` must have a report.
Stretch choose(const Timeline& timeline, Around around, std::size_t neighbours);

/// Each cycle is an event from its deadline (or the later end of the previous cycle) until its write, with
/// its parts as events inside.
knurl::Json to_trace(const Timeline& timeline, const Stretch& stretch);

}  // namespace knurl::cli
