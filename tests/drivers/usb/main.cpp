// GoogleTest under umockdev.

#include <gtest/gtest.h>

#include "bus.hpp"

int main(int argc, char** argv) {
    knurl::drivers::usb_emulator::start_under_umockdev(argc, argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
