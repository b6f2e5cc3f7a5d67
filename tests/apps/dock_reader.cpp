// Reads the bytes of IMD messages, cut at any place.

#include <bit>
#include <cmath>
#include <cstring>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "imd_reader.hpp"

namespace {

using dock::ImdError;
using dock::ImdFrame;
using dock::ImdReader;
using testing::HasSubstr;

std::string raw(std::uint32_t word) {
    return {reinterpret_cast<const char*>(&word), 4};
}
std::string number(float value) {
    return raw(std::bit_cast<std::uint32_t>(value));
}
std::string header(std::int32_t type, std::int32_t length) {
    return raw(htonl(static_cast<std::uint32_t>(type))) + raw(htonl(static_cast<std::uint32_t>(length)));
}
const std::string hello = header(4, 0).substr(0, 4) + raw(2);

std::string energies(std::int32_t step) {
    std::string bytes = header(1, 1) + raw(static_cast<std::uint32_t>(step));
    for (int i = 0; i < 9; ++i) bytes += number(10.0F + static_cast<float>(i));
    return bytes;
}
std::string atoms(int n, float first = 0) {
    std::string bytes = header(2, n);
    for (int i = 0; i < 3 * n; ++i) bytes += number(first + static_cast<float>(i));
    return bytes;
}

void feed(ImdReader& reader, const std::string& bytes) {
    reader.feed({reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()});
}

std::string complaint(const std::string& bytes) {
    ImdReader reader;
    feed(reader, bytes);
    try {
        while (reader.next()) {
        }
        return "";
    } catch (const ImdError& error) {
        return error.what();
    }
}

TEST(ImdReader, FindsTheSameFramesHoweverTheBytesAreCut) {
    const std::string bytes =
        hello + atoms(2, 100) + energies(7) + atoms(2, 200) + energies(8) + energies(9) + atoms(2);
    for (std::size_t cut = 1; cut <= bytes.size(); ++cut) {
        ImdReader reader;
        std::vector<ImdFrame> frames;
        for (std::size_t at = 0; at < bytes.size(); at += cut) {
            feed(reader, bytes.substr(at, cut));
            while (auto frame = reader.next()) frames.push_back(*frame);
        }
        ASSERT_EQ(frames.size(), 3u) << cut;
        EXPECT_FALSE(frames[0].energies);
        EXPECT_EQ(frames[0].atoms[1], Eigen::Vector3f(103, 104, 105));
        ASSERT_TRUE(frames[1].energies && frames[2].energies);
        EXPECT_EQ(frames[1].energies->step, 7);
        EXPECT_EQ(frames[1].energies->temperature, 10);
        EXPECT_EQ(frames[2].energies->step, 9) << "the newest";
        EXPECT_FALSE(reader.within_message());
    }
}

TEST(ImdReader, NamesWhatIsNoImd) {
    EXPECT_THAT(complaint("HTTP/1.1 400 Bad Request\r\n\r\n"), HasSubstr("handshake"));
    EXPECT_THAT(complaint(header(4, 0).substr(0, 4) + raw(3)), HasSubstr("version 3"));
    EXPECT_THAT(complaint(hello + header(1, 2)), HasSubstr("length 2"));
    EXPECT_THAT(complaint(hello + header(2, 0)), HasSubstr("0 atoms"));
    EXPECT_THAT(complaint(hello + header(2, -1)), HasSubstr("-1 atoms"));
    EXPECT_THAT(complaint(hello + header(2, 2'000'000'000)), HasSubstr("2000000000 atoms"))
        << "before it is waited for";
    EXPECT_THAT(complaint(hello + atoms(2) + atoms(3)), HasSubstr("3 atoms, and there were 2"));
    EXPECT_THAT(complaint(hello + header(2, 1) + number(1) + number(NAN) + number(1)), HasSubstr("atom 0"));
    EXPECT_THAT(complaint(hello + header(9, 0)), HasSubstr("error"));
    for (const int type : {-1, 3, 4, 6, 8, 10})
        EXPECT_THAT(complaint(hello + header(type, 1)), HasSubstr("makes no sense"));
}

TEST(ImdReader, KnowsThatASimulationPausesOrGoes) {
    ImdReader reader;
    feed(reader, hello + atoms(1) + header(7, 0));
    EXPECT_TRUE(reader.next());
    EXPECT_FALSE(reader.next());
    EXPECT_TRUE(reader.paused());
    feed(reader, atoms(1));
    EXPECT_TRUE(reader.next());
    EXPECT_FALSE(reader.paused());
    feed(reader, header(0, 0) + atoms(1));
    EXPECT_FALSE(reader.next());
    EXPECT_TRUE(reader.ended());
    EXPECT_FALSE(reader.within_message());
}

}  // namespace
