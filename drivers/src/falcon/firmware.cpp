#include "falcon/firmware.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <nettle/sha2.h>

namespace knurl::drivers::falcon {

namespace {

constexpr std::uint16_t key = 0x08AA;
constexpr std::size_t reserved_words = 8;
constexpr std::size_t largest_file = 1 << 20;

struct Known {
    const char* digest;
    const char* name;
};
// The digests are facts about known files; the files belong to Novint.
constexpr Known known[] = {
    {"1119e39c39fab1f37678ea62dfc715b23dd86ee7f13d78f88f707d9f09b896a1", "nvent_firmware.bin"},
    {"b2700d5cd5ca217e48565fb4de5a502a636c53f6e01ebd0cad193e9f84856c6a", "test_firmware.bin"},
};

std::string hexadecimal(std::uint32_t word, int digits) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%0*X", digits, word);
    return text;
}

/// Reads words from bytes, with their positions.
class Words {
  public:
    Words(std::span<const std::uint8_t> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    std::uint16_t next(const std::string& expected) {
        if (bytes_.size() - at_ < 2) fail(at_, expected, "the file ends");
        const auto word = static_cast<std::uint16_t>(bytes_[at_] | bytes_[at_ + 1] << 8);
        at_ += 2;
        return word;
    }
    void skip(std::size_t words, const std::string& expected) {
        if ((bytes_.size() - at_) / 2 < words) fail(bytes_.size(), expected, "the file ends");
        at_ += 2 * words;
    }
    [[noreturn]] void fail(std::size_t at, const std::string& expected, const std::string& found) const {
        throw std::runtime_error("firmware \"" + name_ + "\" is no boot stream: at byte " +
                                 std::to_string(at) + " " + expected + " was expected, but " + found +
                                 "; give the file that the Falcon's maker supplies, as it is");
    }
    std::size_t at() const { return at_; }

  private:
    std::span<const std::uint8_t> bytes_;
    const std::string& name_;
    std::size_t at_ = 0;
};

}  // namespace

std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes.size(), bytes.data());
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    sha256_digest(&context, digest.size(), digest.data());
    return digest;
}

std::string Firmware::known_as() const {
    const auto* found =
        std::ranges::find(known, sha256, [](const Known& one) { return std::string(one.digest); });
    return found == std::end(known) ? "" : found->name;
}

Firmware parse_firmware(std::span<const std::uint8_t> bytes, const std::string& name) {
    Words words(bytes, name);
    if (const std::uint16_t first = words.next("the key 0x08AA"); first != key)
        words.fail(0, "the key 0x08AA", hexadecimal(first, 4) + " is there");
    for (std::size_t i = 0; i < reserved_words; ++i)
        if (const std::uint16_t word = words.next("a reserved word 0x0000"); word != 0)
            words.fail(words.at() - 2, "a reserved word 0x0000", hexadecimal(word, 4) + " is there");
    Firmware firmware;
    const std::uint32_t high = words.next("the entry address");
    firmware.entry = high << 16 | words.next("the entry address");
    for (;;) {
        const std::uint16_t size = words.next("the size of a block, or 0x0000 for the end");
        if (size == 0) break;
        ++firmware.blocks;
        const std::string block =
            "block " + std::to_string(firmware.blocks) + " of " + std::to_string(size) + " words";
        words.skip(2, "the address of " + block);
        words.skip(size, "the rest of " + block);
    }
    if (firmware.blocks == 0) words.fail(words.at() - 2, "the size of a first block", "the end is there");
    firmware.stream.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(words.at()));
    for (const std::uint8_t byte : falcon::sha256(bytes)) firmware.sha256 += hexadecimal(byte, 2).substr(2);
    std::ranges::transform(firmware.sha256, firmware.sha256.begin(),
                           [](char c) { return c >= 'A' ? static_cast<char>(c - 'A' + 'a') : c; });
    return firmware;
}

Firmware load_firmware(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw std::runtime_error("cannot read the firmware \"" + file.string() +
                                 "\": firmware=FILE names the file that the Falcon's maker supplies");
    std::vector<char> bytes(largest_file + 1);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    if (bytes.size() > largest_file)
        throw std::runtime_error("the firmware \"" + file.string() +
                                 "\" is larger than 1 MiB; a Falcon's has 8 KiB");
    const std::vector<std::uint8_t> raw(bytes.begin(), bytes.end());
    return parse_firmware(raw, file.string());
}

}  // namespace knurl::drivers::falcon
