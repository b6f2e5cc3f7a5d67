#pragma once
// The firmware file with which a Falcon is booted. Novint's licence forbids shipping it, so the user names a
// file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace knurl::drivers::falcon {

struct Firmware {
    std::vector<std::uint8_t> stream;  // the bytes to send: up to the stream's own end
    std::string sha256;                // of the whole file, hexadecimal
    std::size_t blocks = 0;
    std::uint32_t entry = 0;  // address to which the ROM jumps

    /// "nvent_firmware.bin" if the digest is that of a file known to work, else empty.
    std::string known_as() const;
};

/// Checks that the bytes are a boot stream of TI's C28x ROM in 8-bit SCI mode (TMS320x280x Boot ROM Reference
/// Guide, "SCI boot"): words, low byte first; 0x08AA, 8 reserved words that are zero, entry address (high
/// word, low word), then blocks of {size in words, address high, address low, data}, size 0 at the end.
/// Throws std::runtime_error with the byte position and the expected value. `name` appears in the message.
Firmware parse_firmware(std::span<const std::uint8_t> bytes, const std::string& name);

/// The same from a file of at most 1 MiB.
Firmware load_firmware(const std::filesystem::path& file);

/// FIPS 180-4.
std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes);

}  // namespace knurl::drivers::falcon
