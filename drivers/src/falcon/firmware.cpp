#include "falcon/firmware.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace knurl::drivers::falcon {

namespace {

constexpr std::uint16_t key = 0x08AA;
constexpr std::size_t reserved_words = 8;
constexpr std::size_t largest_file = 1 << 20;

struct Known {
    const char* digest;
    const char* name;
};
// Digests are facts about files that people have; the files are Novint's.
constexpr Known known[] = {
    {"1119e39c39fab1f37678ea62dfc715b23dd86ee7f13d78f88f707d9f09b896a1", "nvent_firmware.bin"},
    {"b2700d5cd5ca217e48565fb4de5a502a636c53f6e01ebd0cad193e9f84856c6a", "test_firmware.bin"},
};

std::string hexadecimal(std::uint32_t word, int digits) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%0*X", digits, word);
    return text;
}

/// Words from bytes, and where each was.
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

constexpr std::array<std::uint32_t, 64> round_constants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

constexpr std::uint32_t rotated(std::uint32_t x, int by) {
    return x >> by | x << (32 - by);
}

void compress(std::array<std::uint32_t, 8>& state, const std::uint8_t* block) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t i = 0; i < 16; ++i)
        w[i] = std::uint32_t{block[4 * i]} << 24 | std::uint32_t{block[4 * i + 1]} << 16 |
               std::uint32_t{block[4 * i + 2]} << 8 | block[4 * i + 3];
    for (std::size_t i = 16; i < 64; ++i)
        w[i] = w[i - 16] + (rotated(w[i - 15], 7) ^ rotated(w[i - 15], 18) ^ w[i - 15] >> 3) + w[i - 7] +
               (rotated(w[i - 2], 17) ^ rotated(w[i - 2], 19) ^ w[i - 2] >> 10);
    auto [a, b, c, d, e, f, g, h] = state;
    for (std::size_t i = 0; i < 64; ++i) {
        const std::uint32_t first = h + (rotated(e, 6) ^ rotated(e, 11) ^ rotated(e, 25)) +
                                    ((e & f) ^ (~e & g)) + round_constants[i] + w[i];
        const std::uint32_t second =
            (rotated(a, 2) ^ rotated(a, 13) ^ rotated(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
        h = g;
        g = f;
        f = e;
        e = d + first;
        d = c;
        c = b;
        b = a;
        a = first + second;
    }
    const std::array<std::uint32_t, 8> added = {a, b, c, d, e, f, g, h};
    for (std::size_t i = 0; i < 8; ++i) state[i] += added[i];
}

}  // namespace

std::array<std::uint8_t, 32> sha256(std::span<const std::uint8_t> bytes) {
    std::array<std::uint32_t, 8> state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                          0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    // Padding: a one, zeros to 8 bytes before the end of a block, the length in bits.
    std::vector<std::uint8_t> padded(bytes.begin(), bytes.end());
    padded.push_back(0x80);
    while (padded.size() % 64 != 56) padded.push_back(0);
    for (int shift = 56; shift >= 0; shift -= 8)
        padded.push_back(static_cast<std::uint8_t>(std::uint64_t{bytes.size()} * 8 >> shift));
    for (std::size_t at = 0; at < padded.size(); at += 64) compress(state, padded.data() + at);
    std::array<std::uint8_t, 32> digest{};
    for (std::size_t i = 0; i < 32; ++i)
        digest[i] = static_cast<std::uint8_t>(state[i / 4] >> (24 - 8 * (i % 4)));
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
