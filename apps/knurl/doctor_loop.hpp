#pragma once
// A servo's cycle as the machine lets it begin: a loop with nothing in it, the real servo, and a witness on
// another CPU that tells when the whole machine stood still.

#include <optional>
#include <string>
#include <vector>

#include <knurl/servo/realtime.hpp>

#include "latency_floors.hpp"

namespace knurl::cli {

/// How late each cycle began, in the order in which they came.
struct Beginnings {
    std::vector<Nanoseconds> deadline;  // CLOCK_MONOTONIC
    std::vector<Nanoseconds> late;
};

/// When a thread that does nothing but sleep was late by more than `long_gap`.
struct Gap {
    Nanoseconds begin = 0, end = 0;
};

/// Sleeps for 1 ms at a time on a CPU, with a priority above everybody's, until it ends.
class Witness {
  public:
    static constexpr Nanoseconds long_gap = 1'000'000;

    explicit Witness(unsigned cpu);
    ~Witness();
    Witness(const Witness&) = delete;
    Witness& operator=(const Witness&) = delete;
    /// Those that it has seen since the last call.
    std::vector<Gap> gaps();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The servo's way of sleeping, on its CPU and with its priority, and nothing in between.
Beginnings bare_loop(double rate, unsigned cpu, Nanoseconds length);

/// The same of a real servo, by its reports, with an armed claim and a plane; `address` as for
/// Client::connect.
Beginnings servo_loop(const std::string& address, Nanoseconds length);

/// Beginnings that fall into a standstill of the whole machine: the loop and the witness were late at the
/// same time. They are taken out, and told apart.
struct Stalls {
    std::size_t count = 0;
    Nanoseconds longest = 0;
};
Stalls take_out_stalls(Beginnings& beginnings, const std::vector<Gap>& gaps);

}  // namespace knurl::cli
