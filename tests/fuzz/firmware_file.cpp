// Any bytes as a Falcon's firmware, as they are (first byte even) or after a valid header: refused in one
// line, or a stream that ends exactly where the bytes state.

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "falcon/firmware.hpp"
#include "refusal.hpp"

using namespace knurl::drivers;
using knurl::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    std::vector<std::uint8_t> bytes;
    if ((data[0] & 1) != 0) {
        bytes.assign(18, 0);  // the key, and eight reserved words
        bytes[0] = 0xAA;
        bytes[1] = 0x08;
    }
    bytes.insert(bytes.end(), data + 1, data + size);
    bytes.shrink_to_fit();
    try {
        const falcon::Firmware firmware = falcon::parse_firmware(bytes, "f.bin");
        require(firmware.blocks > 0 && firmware.stream.size() >= 28 &&
                    firmware.stream.size() <= bytes.size() &&
                    std::equal(firmware.stream.begin(), firmware.stream.end(), bytes.begin()),
                "the stream is the beginning of the file");
        require(firmware.sha256.size() == 64 && firmware.known_as().empty(), "a digest has 64 digits");
        const falcon::Firmware again = falcon::parse_firmware(firmware.stream, "f.bin");
        require(again.blocks == firmware.blocks && again.entry == firmware.entry &&
                    again.stream == firmware.stream,
                "the stream is a firmware by itself");
        try {
            falcon::parse_firmware(std::span(firmware.stream).first(firmware.stream.size() - 1), "f.bin");
            require(false, "a stream that is cut off is refused");
        } catch (const std::runtime_error&) {
        }
    } catch (const std::runtime_error& error) {
        knurl::fuzz::check_refusal(error.what(), "firmware \"f.bin\"");
    }
    return 0;
}
