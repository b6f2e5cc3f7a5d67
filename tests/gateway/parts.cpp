// The parts without sockets: addresses, cookies, sessions on a virtual clock, the log.

#include <gtest/gtest.h>

#include "limited_log.hpp"
#include "sessions.hpp"
#include "target.hpp"

namespace knurl::gateway {

namespace {

using namespace std::chrono_literals;

TEST(GatewayTarget, Decodes) {
    const auto target = parse_target("/a%20b/c?x=1&y=%26+&x=2&&z&=q");
    ASSERT_TRUE(target);
    EXPECT_EQ(target->path, "/a b/c");
    EXPECT_EQ(target->query, (std::map<std::string, std::string>{{"x", "2"}, {"y", "& "}, {"z", ""}}));
    EXPECT_EQ(parse_target("/a+b")->path, "/a+b") << "only a form's + is a blank";
    EXPECT_TRUE(parse_target("/?"));
    for (const char* bad : {"", "a", "*", "/%", "/%4", "/%4x", "/a%0d", "/%7f", "/?%00=1", "http://host/"})
        EXPECT_FALSE(parse_target(bad)) << bad;
    std::string many = "/?";
    for (int i = 0; i < 65; ++i) many += "a" + std::to_string(i) + "=1&";
    EXPECT_FALSE(parse_target(many));
}

TEST(GatewayTarget, Cookies) {
    EXPECT_EQ(cookie_of("a=1; knurl_8080=abc; b=2", "knurl_8080"), "abc");
    EXPECT_EQ(cookie_of("knurl_80801=no;knurl_8080=abc", "knurl_8080"), "abc");
    EXPECT_EQ(cookie_of("xknurl_8080=no", "knurl_8080"), "");
    EXPECT_EQ(cookie_of("knurl_8080", "knurl_8080"), "");
    EXPECT_EQ(cookie_of("", "knurl_8080"), "");
}

TEST(GatewayTarget, Patterns) {
    EXPECT_TRUE(fits("/a", "/a"));
    EXPECT_FALSE(fits("/a", "/a/"));
    EXPECT_TRUE(fits("/a/*", "/a/b/c"));
    EXPECT_FALSE(fits("/a/*", "/a"));
    EXPECT_GT(*fits("/a/b", "/a/b"), *fits("/a/*", "/a/b"));
    EXPECT_GT(*fits("/a/b", "/a/b"), *fits("/a/b*", "/a/b"));
    EXPECT_EQ(listed(" a , b,,\tc "), (std::vector<std::string_view>{"a", "b", "c"}));
}

constexpr Sessions::Time start{};

TEST(GatewaySessions, EndWhenIdle) {
    Sessions sessions(4, 10h, {});
    const std::string secret = *sessions.login_by_token(sessions.new_token(Role::render, start), start);
    EXPECT_EQ(sessions.by_cookie(secret, start + 9h)->role, Role::render);
    EXPECT_TRUE(sessions.by_cookie(secret, start + 18h)) << "it was used";
    sessions.touch(sessions.by_cookie(secret, start + 18h)->session, start + 27h);
    EXPECT_TRUE(sessions.by_cookie(secret, start + 36h)) << "it had a socket";
    EXPECT_FALSE(sessions.by_cookie(secret, start + 47h));
}

TEST(GatewaySessions, TokenEndsWithTime) {
    Sessions sessions(4, 10h, {});
    const std::string token = sessions.new_token(Role::control, start);
    EXPECT_FALSE(sessions.login_by_token(token, start + 11h));
    EXPECT_EQ(sessions.count(), 0U);
}

TEST(GatewaySessions, Keys) {
    bridge::Key look = bridge::make_key("look", bridge::Role::observe),
                all = bridge::make_key("all", bridge::Role::control);
    look.secret.fill(std::byte{0xab});
    all.secret.fill(std::byte{0x01});
    Sessions sessions(4, 10h, {look, all});
    std::string text;
    for (int i = 0; i < 32; ++i) text += "aB";
    EXPECT_EQ(sessions.by_key(text)->role, Role::observe);
    EXPECT_EQ(sessions.by_key(text)->session, "key look");
    const auto secret = sessions.login_by_key(text, start);
    ASSERT_TRUE(secret);
    EXPECT_EQ(sessions.by_cookie(*secret, start)->role, Role::observe);
    EXPECT_FALSE(sessions.by_key(text.substr(2)));
    EXPECT_FALSE(sessions.by_key(""));
    EXPECT_FALSE(sessions.by_cookie("", start));
    text.back() = 'c';
    EXPECT_FALSE(sessions.by_key(text));
}

TEST(GatewayLog, LineASecondOfEachKind) {
    std::vector<std::string> lines;
    LimitedLog log([&](const std::string& line) { lines.push_back(line); });
    const LimitedLog::Time now = LimitedLog::Time() + 1h;
    log.say("a", "one", now);
    log.say("a", "two", now + 1ms);
    log.say("a", "three", now + 2ms);
    log.say("b", "other", now + 3ms);
    log.say("a", "four", now + 1001ms);
    EXPECT_EQ(lines, (std::vector<std::string>{"one", "other", "four (and 2 more of this kind)"}));
}

TEST(GatewayLog, RefusalOfAHostOnceAMinute) {
    std::vector<std::string> lines;
    LimitedLog log([&](const std::string& line) { lines.push_back(line); });
    LimitedLog::Time now = LimitedLog::Time() + 1h;
    log.refused("origin", "h", "one", now);
    log.refused("origin", "h", "two", now + 2s);
    log.refused("origin", "i", "three", now + 4s);
    log.refused("origin", "h", "four", now + 61s);
    EXPECT_EQ(lines, (std::vector<std::string>{"one", "three", "four"}));
}

}  // namespace

}  // namespace knurl::gateway
