// GoogleTest under umockdev.

#include <gtest/gtest.h>

#include "bus.hpp"

#if defined(__SANITIZE_THREAD__)
// Libraries that are not built for the sanitizer: it sees neither their locks nor how they start their
// threads.
extern "C" const char* __tsan_default_suppressions();
extern "C" const char* __tsan_default_suppressions() {
    return "called_from_lib:libudev.so\ncalled_from_lib:libumockdev.so\ncalled_from_lib:libumockdev-preload."
           "so\n"
           "called_from_lib:libusb-1.0.so\ncalled_from_lib:libglib-2.0.so\ncalled_from_lib:libgio-2.0.so\n"
           "called_from_lib:libgobject-2.0.so\nrace:std::__mutex_base::__mutex_base\n";
}
#endif

int main(int argc, char** argv) {
    knurl::drivers::usb_emulator::start_under_umockdev(argc, argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
