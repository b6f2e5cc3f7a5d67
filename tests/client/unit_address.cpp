// What a user may write as an address, and what each mistake is answered with.

#include <gtest/gtest.h>

#include <knurl/client/error.hpp>

#include "address.hpp"

namespace {

using knurl::Error;
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

TEST(Address, of_another_host_needs_the_bridge_and_says_so) {
    EXPECT_NE(refusal("knurl://lab:4000").find("bridge"), std::string::npos);
}

TEST(Address, that_can_be_no_servo_is_refused_with_what_would_do) {
    for (const char* bad : {"", "knurl:", "knurl:a/b", "../default", "knurl:a b", ".hidden", "knurl:\n"})
        EXPECT_NE(refusal(bad).find("give 'knurl:NAME'"), std::string::npos) << '"' << bad << '"';
    EXPECT_NE(refusal(std::string(64, 'x')).find("1 to 63"), std::string::npos);
}

}  // namespace
