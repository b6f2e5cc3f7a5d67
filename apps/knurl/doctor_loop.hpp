#pragma once
// How late the machine lets a servo's cycle begin: an empty loop, the real servo, and a witness on another
// CPU that shows standstills of the whole machine.

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include <knurl/measure/sleeper.hpp>

namespace knurl::cli {

using measure::Beginnings, measure::Gap, measure::Nanoseconds, measure::now_ns, measure::sleep_until,
    measure::Witness;

/// A witness on this CPU, above all other priorities. None: no right to that.
std::unique_ptr<Witness> witness_on(unsigned cpu);

/// Only a servo's sleeps, on its CPU and with its priority. `stop` ends it early, and the next one too.
Beginnings bare_loop(double rate, unsigned cpu, Nanoseconds length, const std::atomic<bool>& stop);

/// The same for a real servo, from its reports, with an armed claim and a plane; `address` as for
/// Client::connect.
Beginnings servo_loop(const std::string& address, Nanoseconds length, const std::atomic<bool>& stop);

/// Beginnings during a standstill of the whole machine: the loop and the witness were late at the same time.
/// They are removed and reported separately.
struct Stalls {
    std::size_t count = 0;
    Nanoseconds longest = 0;
};
Stalls take_out_stalls(Beginnings& beginnings, const std::vector<Gap>& gaps);

}  // namespace knurl::cli
