#pragma once
// A servo's cycle as the machine lets it begin: a loop with nothing in it, the real servo, and a witness on
// another CPU that tells when the whole machine stood still.

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include <knurl/measure/sleeper.hpp>

namespace knurl::cli {

using measure::Beginnings, measure::Gap, measure::Nanoseconds, measure::now_ns, measure::sleep_until,
    measure::Witness;

/// A witness on this CPU, above everybody. None: there is no right to that.
std::unique_ptr<Witness> witness_on(unsigned cpu);

/// Nothing but a servo's way of sleeping, on its CPU and with its priority. `stop` ends it early, as the next.
Beginnings bare_loop(double rate, unsigned cpu, Nanoseconds length, const std::atomic<bool>& stop);

/// The same of a real servo, by its reports, with an armed claim and a plane; `address` as for
/// Client::connect.
Beginnings servo_loop(const std::string& address, Nanoseconds length, const std::atomic<bool>& stop);

/// Beginnings that fall into a standstill of the whole machine: the loop and the witness were late at the
/// same time. They are taken out, and told apart.
struct Stalls {
    std::size_t count = 0;
    Nanoseconds longest = 0;
};
Stalls take_out_stalls(Beginnings& beginnings, const std::vector<Gap>& gaps);

}  // namespace knurl::cli
