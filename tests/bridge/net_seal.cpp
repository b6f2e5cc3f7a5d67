// Sealed datagrams: opening one gives exactly what the peer sent, and only once, or nothing.

#include <random>

#include <gtest/gtest.h>

#include "net_allocations.hpp"
#include "net_pair.hpp"
#include "seal.hpp"

namespace knurl::bridge::test {
namespace {

using Datagram = std::vector<std::byte>;

struct Seal : testing::Test {
    static std::array<std::byte, key_bytes> key_of(int first) {
        std::array<std::byte, key_bytes> key;
        for (std::size_t i = 0; i < key.size(); ++i)
            key[i] = static_cast<std::byte>(first + static_cast<int>(i));
        return key;
    }
    Datagram sealed(std::uint64_t counter, std::string_view header, std::string_view text) {
        Datagram room(header.size() + text.size() + tag_bytes);
        std::memcpy(room.data(), header.data(), header.size());
        std::memcpy(room.data() + header.size(), text.data(), text.size());
        EXPECT_EQ(sealer.seal(counter, room, header.size(), header.size() + text.size()), room.size());
        return room;
    }
    Sealer sealer{key_of(0x80)};
    Opener opener{key_of(0x80)};
};

TEST_F(Seal, TheOtherEndReadsItAndTheWireDoesNot) {
    Datagram datagram = sealed(7, "header", "the hand is at 1, 2, 3");
    EXPECT_EQ(text_of(datagram).substr(0, 6), "header");
    EXPECT_EQ(text_of(datagram).find("hand"), std::string::npos);
    ASSERT_TRUE(opener.open(7, datagram, 6));
    EXPECT_EQ(text_of(datagram).substr(0, datagram.size() - tag_bytes), "headerthe hand is at 1, 2, 3");
}

/// The key of RFC 8439, 2.8.2, with this project's nonce. The bytes come from the RFC's pseudo-code in Python
/// integers, which gives the RFC's own tag for the RFC's own input.
TEST_F(Seal, IsTheCipherOfTheRfc) {
    const Datagram datagram =
        sealed(0x0807060504030201, "PQRSabcd", "Ladies and Gentlemen of the class of '99");
    std::string hex;
    for (const std::byte b : datagram) {
        char two[3];
        std::snprintf(two, sizeof two, "%02x", std::to_integer<unsigned>(b));
        hex += two;
    }
    EXPECT_EQ(hex,
              "5051525361626364add870917296579931fd43fb5c82cb4cabbee663b7b6154f088ad7d0dfef2bcb"
              "b6c6ca0ecab1eedef6702bc66a8dcd75619b1cdcad6fc1e0");
}

TEST_F(Seal, AChangeOfAnyBitAnywhereIsSeen) {
    const Datagram datagram = sealed(1, "head", "sixteen bytes...");
    for (std::size_t bit = 0; bit < 8 * datagram.size(); ++bit) {
        Datagram forged = datagram;
        forged[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
        EXPECT_FALSE(opener.open(1, forged, 4)) << "bit " << bit;
    }
    Datagram untouched = datagram;
    EXPECT_TRUE(opener.open(1, untouched, 4)) << "forgeries leave nothing behind";
}

TEST_F(Seal, AnotherCounterKeyOrLengthOfTheHeaderIsSeen) {
    const Datagram datagram = sealed(1, "head", "text");
    Datagram copy = datagram;
    EXPECT_FALSE(opener.open(2, copy, 4));
    copy = datagram;
    EXPECT_FALSE(Opener(key_of(0)).open(1, copy, 4));
    copy = datagram;
    EXPECT_FALSE(opener.open(1, copy, 3));
}

TEST_F(Seal, EveryTruncationIsSeen) {
    const Datagram datagram = sealed(1, "head", "some text");
    for (std::size_t bytes = 0; bytes < datagram.size(); ++bytes) {
        Datagram shorter(datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(bytes));
        EXPECT_FALSE(opener.open(1, shorter, 4)) << bytes;
    }
    Datagram longer = datagram;
    longer.push_back(std::byte{0});
    EXPECT_FALSE(opener.open(1, longer, 4));
}

TEST_F(Seal, AHeaderAloneIsProtectedToo) {
    Datagram datagram = sealed(1, "ping", "");
    EXPECT_EQ(datagram.size(), 4 + tag_bytes);
    EXPECT_TRUE(opener.open(1, datagram, 4));
    datagram[0] ^= std::byte{1};
    EXPECT_FALSE(opener.open(1, datagram, 4));
}

TEST_F(Seal, ACounterIsUsedOnce) {
    sealed(5, "h", "a");
    Datagram room(100);
    EXPECT_EQ(sealer.seal(5, room, 1, 10), 0u);
    EXPECT_EQ(sealer.seal(4, room, 1, 10), 0u);
    EXPECT_EQ(sealer.seal(0, room, 1, 10), 0u);
    EXPECT_GT(sealer.seal(6, room, 1, 10), 0u);
}

TEST_F(Seal, WithoutRoomForTheTagNothingIsSealed) {
    Datagram room(20);
    EXPECT_EQ(sealer.seal(1, room, 4, 5), 0u);
    EXPECT_EQ(sealer.seal(1, room, 4, 4), 20u);
    EXPECT_EQ(sealer.seal(2, room, 5, 4), 0u) << "a header longer than the datagram";
}

TEST_F(Seal, OfEverySizeAndContent) {
    constexpr unsigned seed = 3;
    std::mt19937 random(seed);
    for (std::uint64_t counter = 1; counter <= 2000; ++counter) {
        const std::size_t header = random() % 40, bytes = header + random() % 1300;
        Datagram plain(bytes);
        for (std::byte& b : plain) b = static_cast<std::byte>(random());
        Datagram datagram = plain;
        datagram.resize(bytes + tag_bytes);
        ASSERT_EQ(sealer.seal(counter, datagram, header, bytes), datagram.size()) << "seed " << seed;
        ASSERT_TRUE(opener.open(counter, datagram, header)) << "seed " << seed << " counter " << counter;
        datagram.resize(bytes);
        ASSERT_EQ(datagram, plain) << "seed " << seed << " counter " << counter;
    }
}

TEST_F(Seal, AllocatesNothing) {
    Datagram datagram = sealed(1, "head", "text");
    opener.open(1, datagram, 4);
    const std::uint64_t before = allocations(), openssl = openssl_allocations();
    for (std::uint64_t counter = 2; counter < 1000; ++counter) {
        ASSERT_GT(sealer.seal(counter, datagram, 4, 8), 0u);
        ASSERT_TRUE(opener.open(counter, datagram, 4));
        datagram[5] ^= std::byte{1};
        ASSERT_FALSE(opener.open(counter, datagram, 4));
    }
    EXPECT_EQ(allocations() - before, 0u);
    EXPECT_EQ(openssl_allocations() - openssl, 0u);
}

}  // namespace
}  // namespace knurl::bridge::test
