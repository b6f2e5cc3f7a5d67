// The firmware file that the user names: which are accepted, and the message about others.

#include "falcon/firmware.hpp"

#include <random>

#include "../../refusal.hpp"
#include "falcon/packet.hpp"
#include "falcon_bench.hpp"

namespace knurl::drivers::falcon {
namespace {

using usb_emulator::made_up_firmware;
using usb_emulator::TemporaryFile;
using Bytes = std::vector<std::uint8_t>;

std::string error_of(const Bytes& bytes) {
    return test::refusal_of([&] { parse_firmware(bytes, "f.bin"); });
}

TEST(FalconFirmware, IsABootStream) {
    const Bytes bytes = made_up_firmware();
    const Firmware firmware = parse_firmware(bytes, "f.bin");
    EXPECT_EQ(firmware.stream, bytes);
    EXPECT_EQ(firmware.blocks, 2U);
    EXPECT_EQ(firmware.entry, 0x3F8002U);
    EXPECT_EQ(firmware.known_as(), "");
}

TEST(FalconFirmware, WhatLiesBehindTheStreamIsNotSentButCountsForTheDigest) {
    Bytes bytes = made_up_firmware();
    const std::string before = parse_firmware(bytes, "f.bin").sha256;
    bytes.resize(bytes.size() + 100, 0xff);
    const Firmware firmware = parse_firmware(bytes, "f.bin");
    EXPECT_EQ(firmware.stream.size(), bytes.size() - 100);
    EXPECT_NE(firmware.sha256, before);
}

TEST(FalconFirmware, AnythingElseIsRefusedWithTheByteAndWhatWasExpectedThere) {
    EXPECT_NE(error_of({}).find("at byte 0 the key 0x08AA was expected, but the file ends"),
              std::string::npos);
    EXPECT_NE(
        error_of({0x7f, 'E', 'L', 'F'}).find("at byte 0 the key 0x08AA was expected, but 0x457F is there"),
        std::string::npos);
    Bytes bytes = made_up_firmware();
    bytes[9] = 1;
    EXPECT_NE(error_of(bytes).find("at byte 8 a reserved word 0x0000 was expected, but 0x0100 is there"),
              std::string::npos);
    bytes = made_up_firmware();
    bytes.resize(700);
    EXPECT_NE(
        error_of(bytes).find("at byte 700 the rest of block 2 of 300 words was expected, but the file ends"),
        std::string::npos)
        << error_of(bytes);
    bytes = made_up_firmware();
    bytes.resize(bytes.size() - 2);
    EXPECT_NE(error_of(bytes).find("the size of a block, or 0x0000 for the end"), std::string::npos);
    EXPECT_THROW(load_firmware("/no/such/file"), std::runtime_error);
    EXPECT_THROW(load_firmware(TemporaryFile(Bytes(2 << 20)).path()), std::runtime_error);
}

TEST(FalconFirmware, CutAnywhereItIsRefused) {
    const Bytes whole = made_up_firmware(20);
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_ANY_THROW(parse_firmware(std::span(whole).first(length), "f.bin")) << length;
}

TEST(FalconFirmware, NoiseIsRefusedOrParsesWithinItsBytes) {
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
        Bytes bytes = made_up_firmware(30);
        for (int k = 0; k < 3; ++k)
            bytes[22 + random() % (bytes.size() - 22)] = static_cast<std::uint8_t>(random());
        try {
            EXPECT_LE(parse_firmware(bytes, "f.bin").stream.size(), bytes.size());
        } catch (const std::runtime_error&) {
        }
    }
}

std::string digest_of(const std::string& text) {
    std::string hex;
    for (const std::uint8_t byte :
         sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()})) {
        char pair[3];
        std::snprintf(pair, sizeof pair, "%02x", byte);
        hex += pair;
    }
    return hex;
}

// FIPS 180-4's examples, and lengths about the end of a block (from coreutils' sha256sum).
TEST(Sha256, IsThatOfTheStandard) {
    EXPECT_EQ(digest_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(digest_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(digest_of(std::string(1000000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(FalconPacket, MessagesAreFoundInAStreamWhereAnythingMayBeMissing) {
    std::mt19937 random(11);
    int sent = 0, found = 0;
    Reader reader;
    for (int i = 0; i < 2000; ++i) {
        std::array<std::uint8_t, message_bytes> message{};
        encode({.motors = {static_cast<std::int16_t>(random()), static_cast<std::int16_t>(random()), -4096}},
               message);
        Bytes bytes(message.begin(), message.end());
        if (random() % 4 == 0)
            bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size()));
        if (random() % 4 == 0)
            bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size()),
                         static_cast<std::uint8_t>(random() % 0x3c));
        const bool whole = bytes == Bytes(message.begin(), message.end());
        // In pieces of any size.
        const std::size_t cut = random() % bytes.size();
        const auto seen = [&](const State& state) { found += state.encoders[2] == -4096 ? 1 : 0; };
        reader.add(std::span(bytes).first(cut), seen);
        reader.add(std::span(bytes).subspan(cut), seen);
        sent += whole ? 1 : 0;
    }
    EXPECT_GT(sent, 1000);
    // A whole one is lost only where the one before it lacked its end.
    EXPECT_GT(found, sent * 9 / 10);
}

}  // namespace
}  // namespace knurl::drivers::falcon
