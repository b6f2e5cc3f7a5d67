#pragma once
// A guarantee in milliseconds on a machine that stands still at times: how often it may be tried.

#include <knurl/measure/measure.hpp>
#include <knurl/measure/sleeper.hpp>

namespace knurl::drivers::usb_emulator {

/// If the machine itself stood still for as long as the zero was late, the test is repeated, as in the chaos
/// runner. Once it is repeated without such a witness, since the witness does not see what delays the bus's
/// own thread, which is not real-time.
class Chances {
  public:
    explicit Chances(int promised) : promised_(promised) {}  // ms

    void begin() { witness_.gaps(); }  // those before are of no interest
    bool is_the_last(int late) {
        const double stood_still = 1e-6 * static_cast<double>(measure::stood_still(witness_.gaps()));
        unexplained_ += late - stood_still > promised_ ? 1 : 0;
        return late <= promised_ || ++tried_ == most || unexplained_ > 1;
    }

  private:
    static constexpr int most = 5, above_all = 95;
    measure::Witness witness_{measure::allowed_cpus(), above_all};
    int promised_, tried_ = 0, unexplained_ = 0;
};

}  // namespace knurl::drivers::usb_emulator
