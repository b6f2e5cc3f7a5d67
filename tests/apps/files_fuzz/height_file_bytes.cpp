// Any bytes as PNG, PGM or ESRI ASCII grid. They are refused in one line, or become finite heights.

#include <cstdint>

#include "check_heights.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    knurl::fuzz::check_heights({reinterpret_cast<const char*>(data), size});
    return 0;
}
