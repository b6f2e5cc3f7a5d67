// Runs the block of drivers/README.md about a test on the emulated bus; built into those tests.
#include "falcon_bench.hpp"

namespace knurl::drivers::usb_emulator {

TEST(Readme, Bus) {
#include "bus.inc"
    EXPECT_NE(device, nullptr);
}

}  // namespace knurl::drivers::usb_emulator
