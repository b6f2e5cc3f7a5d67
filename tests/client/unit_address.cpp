// The valid addresses, and the answer to each mistake.

#include <gtest/gtest.h>

#include <knurl/client/error.hpp>

#include "address.hpp"

namespace {

using knurl::Error;
using knurl::detail::bridge_endpoints;
using knurl::detail::servo_name;

std::string refusal(const std::string& address) {
    try {
        servo_name(address);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind, Error::Kind::no_servo);
        return error.what();
    }
    return "accepted";
}

TEST(Address, is_a_name_with_or_without_the_scheme) {
    EXPECT_EQ(servo_name("knurl:default"), "default");
    EXPECT_EQ(servo_name("default"), "default");
    EXPECT_EQ(servo_name("knurl:lab-2_b.left"), "lab-2_b.left");
    EXPECT_EQ(servo_name(std::string(63, 'x')), std::string(63, 'x'));
}

TEST(Address, of_another_host_is_that_of_its_bridge) {
    EXPECT_TRUE(bridge_endpoints("knurl:default").empty());
    const auto only = [](const std::string& address) { return bridge_endpoints(address).at(0); };
    const auto v4 = only("knurl://127.0.0.1:4000"), v6 = only("knurl://[::1]:4001"),
               usual = only("knurl://127.0.0.1");
    EXPECT_EQ(knurl::bridge::numeric(v4.address), "127.0.0.1:4000");
    EXPECT_EQ(v4.text, "127.0.0.1:4000");
    EXPECT_EQ(knurl::bridge::numeric(v6.address), "[::1]:4001");
    EXPECT_EQ(knurl::bridge::numeric(usual.address), "127.0.0.1:4096");
    EXPECT_TRUE(v4.loopback() && v6.loopback());
}

TEST(Address, of_another_host_that_cannot_be_says_what_is_wrong_with_it) {
    const auto refused = [](const std::string& address) -> std::string {
        try {
            bridge_endpoints(address);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind, Error::Kind::no_servo);
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return "accepted";
    };
    EXPECT_NE(refused("knurl://").find("the host is missing"), std::string::npos);
    EXPECT_NE(refused("knurl://lab:x").find("the port is a number"), std::string::npos);
    EXPECT_NE(refused("knurl://lab:70000").find("up to 65535"), std::string::npos);
    EXPECT_NE(refused("knurl://::1:4096").find("in brackets"), std::string::npos);
    EXPECT_NE(refused("knurl://[::1:4096").find("']' is missing"), std::string::npos);
    EXPECT_NE(refused("knurl://no-such-host.invalid:4096").find("not known here"), std::string::npos);
}

TEST(Address, that_can_be_no_servo_is_refused_with_what_would_do) {
    for (const char* bad : {"", "knurl:", "knurl:a/b", "../default", "knurl:a b", ".hidden", "knurl:\n"})
        EXPECT_NE(refusal(bad).find("give NAME, knurl:NAME or the path of its socket"), std::string::npos)
            << '"' << bad << '"';
    EXPECT_NE(refusal(std::string(64, 'x')).find("1 to 63"), std::string::npos);
}

}  // namespace
