// VRPN's framing, against bytes that were written out by hand.

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include <knurl/vrpn/messages.hpp>
#include <knurl/vrpn/wire.hpp>

namespace {

using namespace knurl::vrpn;

std::vector<std::byte> bytes_of(const std::vector<int>& numbers) {
    std::vector<std::byte> bytes;
    for (const int number : numbers) bytes.push_back(static_cast<std::byte>(number));
    return bytes;
}

std::span<const std::byte> bytes_of(const std::string& text) {
    return std::as_bytes(std::span(text));
}

/// A button that goes down: sender 3, type 13, at 1 s and 2 us, the fifth message.
const std::vector<std::byte> button =
    bytes_of(std::vector<int>{0, 0, 0, 32, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 13, 0, 0, 0, 4,  //
                              0, 0, 0, 1,  0, 0, 0, 1});

TEST(VrpnWire, a_message_is_written_as_the_protocol_has_it) {
    PayloadWriter payload;
    payload::button_change(payload, 1, true);
    std::vector<std::byte> written;
    append(written, {.seconds = 1, .microseconds = 2, .sender = 3, .type = 13, .sequence = 4},
           payload.bytes());
    EXPECT_EQ(written, button);
}

TEST(VrpnWire, a_payload_is_padded_and_its_length_is_not) {
    std::vector<std::byte> written;
    append(written, {}, bytes_of(std::vector<int>{1, 2, 3}));
    EXPECT_EQ(written.size(), 32u);
    EXPECT_EQ(written[3], std::byte{27});
    std::span<const std::byte> rest(written);
    Message message;
    ASSERT_EQ(split(rest, message), Split::whole);
    EXPECT_EQ(message.payload.size(), 3u);
    EXPECT_TRUE(rest.empty());
}

TEST(VrpnWire, a_stream_is_split_wherever_it_is_cut) {
    for (std::size_t cut = 0; cut < button.size(); ++cut) {
        std::span<const std::byte> rest = std::span(button).first(cut);
        Message message;
        EXPECT_EQ(split(rest, message), Split::more) << cut;
        EXPECT_EQ(rest.size(), cut) << "nothing is taken";
    }
    std::span<const std::byte> rest(button);
    Message message;
    ASSERT_EQ(split(rest, message), Split::whole);
    EXPECT_EQ(message.header.seconds, 1);
    EXPECT_EQ(message.header.microseconds, 2);
    EXPECT_EQ(message.header.sender, 3);
    EXPECT_EQ(message.header.type, 13);
    EXPECT_EQ(message.header.sequence, 4u);
    EXPECT_EQ(message.payload.size(), 8u);
}

TEST(VrpnWire, a_length_that_cannot_be_is_refused_and_never_computed_with) {
    for (const std::uint32_t length : {0u, 1u, 23u, 24u + 64001u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
        PayloadWriter words;
        words.put(length);
        std::vector<std::byte> bytes(words.bytes().begin(), words.bytes().end());
        bytes.resize(24);
        std::span<const std::byte> rest(bytes);
        Message message;
        EXPECT_EQ(split(rest, message), Split::bad) << length;
    }
}

TEST(VrpnWire, the_cookie_is_the_protocols_and_any_07_is_taken) {
    const auto mine = cookie();
    EXPECT_EQ(std::memcmp(mine.data(), "vrpn: ver. 07.38  0\0\0\0\0\0", 24), 0);
    EXPECT_EQ(read_cookie(mine).refused, "");
    auto other = mine;
    other[14] = std::byte{'0'};
    EXPECT_EQ(read_cookie(other).refused, "") << "07.08";
}

TEST(VrpnWire, a_cookie_of_06_of_a_log_or_of_something_else_is_one_line) {
    auto old = cookie();
    old[12] = std::byte{'6'};
    EXPECT_EQ(read_cookie(old).refused,
              "it speaks 'vrpn: ver. 06.38', and this server 'vrpn: ver. 07.38': use a client of VRPN 07");
    auto log = cookie();
    log[18] = std::byte{'2'};
    EXPECT_NE(read_cookie(log).refused.find("without remote logging"), std::string::npos);
    const std::array<std::byte, cookie_bytes> nothing{};
    EXPECT_EQ(read_cookie(nothing).refused, "it does not speak VRPN");
}

TEST(VrpnWire, a_request_names_a_port_above_1023) {
    const std::string request("127.0.0.1 55311\0", 16);
    EXPECT_EQ(requested_port(bytes_of(request)), 55311);
    EXPECT_EQ(requested_port(bytes_of(std::string("127.0.0.1 55311"))), 55311) << "without the zero";
    for (const std::string bad : {"", "127.0.0.1", "127.0.0.1 ", "127.0.0.1 80", "127.0.0.1 65536",
                                  "127.0.0.1 -1", "127.0.0.1 99999999999", " 5000", "x 1e4"})
        EXPECT_EQ(requested_port(bytes_of(bad)), std::nullopt) << bad;
}

TEST(VrpnWire, a_name_is_as_long_as_it_says_and_no_longer_than_may_be) {
    PayloadWriter good;
    put_name(good, "Phantom0");
    EXPECT_EQ(described_name(good.bytes()), "Phantom0");
    for (const std::int32_t count : {-1, 0, 8, 10, 0x7fffffff}) {
        PayloadWriter bad;
        bad.put(count).put_text("Phantom0", 9);
        EXPECT_EQ(described_name(bad.bytes()), std::nullopt) << count;
    }
    PayloadWriter longest;
    longest.put(std::int32_t{102}).put_text(std::string(101, 'a'), 102);
    EXPECT_EQ(described_name(longest.bytes()), std::nullopt);
    PayloadWriter control;
    control.put(std::int32_t{3}).put_text("\x1b[", 3);
    EXPECT_EQ(described_name(control.bytes()), std::nullopt) << "it would be printed";
}

TEST(VrpnWire, a_payload_that_is_too_short_or_too_long_is_none) {
    for (const std::size_t size : {0u, 39u, 41u, 44u}) {
        const std::vector<std::byte> bytes(size);
        EXPECT_FALSE(read_plane(bytes)) << size;
    }
    EXPECT_TRUE(read_plane(std::vector<std::byte>(40)));
    EXPECT_TRUE(read_field(std::vector<std::byte>(64)));
    EXPECT_TRUE(read_plane_effects(std::vector<std::byte>(24)));
    EXPECT_TRUE(read_vertex(std::vector<std::byte>(20)));
    EXPECT_TRUE(read_triangle(std::vector<std::byte>(32)));
    EXPECT_TRUE(read_trimesh(std::vector<std::byte>(20)));
    EXPECT_TRUE(read_object(Type::transform_trimesh, std::vector<std::byte>(68)));
    EXPECT_TRUE(read_object(Type::object_touchable, std::vector<std::byte>(6)));
    EXPECT_FALSE(read_object(Type::object_touchable, std::vector<std::byte>(8)));
}

TEST(VrpnWire, numbers_are_big_endian) {
    PayloadWriter out;
    out.put(1.0f).put(-2.0).put(std::int16_t{-2});
    EXPECT_EQ(std::vector<std::byte>(out.bytes().begin(), out.bytes().end()),
              bytes_of(std::vector<int>{0x3f, 0x80, 0, 0, 0xc0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xfe}));
    Payload in(out.bytes());
    EXPECT_EQ(in.take<float>(), 1.0f);
    EXPECT_EQ(in.take<double>(), -2.0);
    EXPECT_EQ(in.take<std::int16_t>(), -2);
    EXPECT_TRUE(in.complete());
    EXPECT_EQ(in.take<std::int32_t>(), 0);
    EXPECT_FALSE(in.ok());
}

TEST(VrpnWire, each_type_has_a_name_of_its_own) {
    for (std::size_t i = 0; i < type_count; ++i)
        EXPECT_EQ(type_of(name_of(static_cast<Type>(i))), static_cast<Type>(i));
    EXPECT_EQ(type_of("vrpn_Tracker Acceleration"), std::nullopt);
}

}  // namespace
