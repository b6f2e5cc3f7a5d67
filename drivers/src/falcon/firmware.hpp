#pragma once
// The firmware file that a Falcon is booted with. Novint's licence forbids shipping it: the user names a
// file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace knurl::drivers::falcon {

struct Firmware {
    std::vector<std::uint8_t> stream;  // what is sent: up to the stream's own end
    std::string sha256;                // of the whole file, hexadecimal
    std::size_t blocks = 0;
    std::uint32_t entry = 0;  // address that the ROM jumps to

    /// "nvent_firmware.bin" if the digest is that of a file known to work, else empty.
    std::string known_as() const;
};

/// Checks that the bytes are a boot stream of TI's C28x ROM in 8-bit SCI mode (TMS320x280x Boot ROM Reference
/// Guide, "SCI boot"): words, low byte first; 0x08AA, 8 reserved words that are zero, entry address (high
/// word, low word), then blocks of {size in words, address high, address low, data}, size 0 at the end.
/// Throws std::runtime_error: at which byte what was expected. `name` is for that message.
Firmware parse_firmware(std::span<const std::uint8_t> bytes, const std::string& name);

/// Likewise from a file of at most 1 MiB.
Firmware load_firmware(const std::filesystem::path& file);

/// FIPS 180-4.
std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes);

}  // namespace knurl::drivers::falcon
