// HTTP of the Inverse Service: a request, and what is answered.

#include <gtest/gtest.h>

#include "inverse_fakes.hpp"

namespace {

using namespace inverse_test;

class InverseHttp : public ::testing::Test {
  protected:
    void SetUp() override {
        fake.source->list.push_back(device("left", "0A14"));
        fake.start();
        fake.socket.sent.clear();
    }
    InverseReply ask(const std::string& method, const std::string& target, const std::string& body = "",
                     Role role = Role::control) {
        const auto query = target.find("?session=");
        return fake.service.http({.method = method,
                                  .path = target.substr(0, query),
                                  .session = query == std::string::npos ? "" : target.substr(query + 9),
                                  .body = body,
                                  .role = role});
    }
    static Json json(const InverseReply& reply) { return Json::parse(reply.body); }
    /// "404: text"
    std::string refusal(const std::string& method, const std::string& target, const std::string& body = "",
                        Role role = Role::control) {
        const InverseReply reply = ask(method, target, body, role);
        const Json answer = json(reply);
        EXPECT_EQ(answer["ok"], false) << reply.body;
        return std::to_string(reply.status) + ": " + answer["error"].get<std::string>();
    }
    FakeService fake;
};

TEST_F(InverseHttp, version_and_devices) {
    EXPECT_EQ(json(ask("GET", "/version"))["project_version"], "1.2.3");
    const Json devices = json(ask("GET", "/devices"));
    ASSERT_EQ(devices["inverse3"].size(), 2u)
        << "three lists at the top, as the service's tutorial reads them";
    EXPECT_EQ(devices["inverse3"][1]["device_id"], "0A14");
    EXPECT_TRUE(devices["inverse3"][0].contains("config"));
    EXPECT_EQ(devices["wireless_verse_grip"].size(), 2u);
    EXPECT_EQ(devices["inverse3"][0]["state"]["cursor_position"]["y"], -0.2);
}

TEST_F(InverseHttp, a_session_is_named_by_index_or_number) {
    fake.session->text(R"({"session":{"configure":{"basis":{"permutation":"XZY"}}}})");
    for (const char* selector : {":0", ":-1", "1", "#1"}) {
        const Json devices = json(ask("GET", std::string("/devices?session=") + selector));
        EXPECT_EQ(devices["inverse3"][0]["state"]["cursor_position"]["z"], -0.2) << selector;
    }
    EXPECT_EQ(refusal("GET", "/devices?session=:1"), "404: there is no session ':1'; 1 are open");
    EXPECT_EQ(refusal("GET", "/devices?session=9"), "404: there is no session '9'; 1 are open");
    EXPECT_TRUE(refusal("GET", "/devices?session=co.haply.hub").starts_with("400: "));
    EXPECT_EQ(json(ask("POST", "/inverse3/0/config/basis?session=:0",
                       R"({"permutation":"X-YZ"})"))["data"]["permutation"],
              "X-YZ");
    EXPECT_EQ(json(ask("GET", "/inverse3/0/config/basis?session=:0"))["data"]["permutation"], "X-YZ");
    EXPECT_TRUE(refusal("POST", "/inverse3/0/config/basis?session=:0", R"({"permutation":"W"})")
                    .starts_with("400: "));
    EXPECT_TRUE(refusal("GET", "/inverse3/0/config/basis").starts_with("400: a basis is a session's"));
}

TEST_F(InverseHttp, handedness_is_kept_by_id_index_or_for_all) {
    const auto hands = [&] {
        const Json devices = json(ask("GET", "/devices"));
        return devices["inverse3"][0]["config"]["handedness"].get<std::string>() + " " +
               devices["inverse3"][1]["config"]["handedness"].get<std::string>();
    };
    EXPECT_EQ(json(ask("POST", "/inverse3/0A14/config/handedness",
                       R"({"handedness":"left"})"))["data"]["handedness"],
              "left");
    EXPECT_EQ(hands(), "right left");
    ask("POST", "/inverse3/0/config/handedness", R"({"handedness":"left"})");
    EXPECT_EQ(hands(), "left left");
    ask("POST", "/inverse3/*/config/handedness", R"({"handedness":"right"})");
    EXPECT_EQ(hands(), "right right");
    EXPECT_TRUE(
        refusal("POST", "/inverse3/0/config/handedness", R"({"handedness":"both"})").starts_with("400: "));
}

TEST_F(InverseHttp, what_is_not_done_is_not_said_to_be_done) {
    for (const char* what : {"gravity_compensation", "torque_scaling"}) {
        const std::string target = std::string("/inverse3/049D/config/") + what;
        EXPECT_EQ(json(ask("GET", target))["data"]["enabled"], false);
        EXPECT_EQ(json(ask("POST", target, R"({"enabled":false})"))["ok"], true);
        EXPECT_TRUE(
            refusal("POST", target, R"({"enabled":true})").starts_with("409: device 'right' has no "));
        EXPECT_TRUE(refusal("POST", target, "{}").starts_with("400: the body must have enabled"));
    }
}

TEST_F(InverseHttp, mistakes) {
    EXPECT_TRUE(refusal("GET", "/").starts_with("404: "));
    EXPECT_TRUE(refusal("GET", "/inverse3/0/config/colour").starts_with("404: there is no config 'colour'"));
    EXPECT_TRUE(refusal("GET", "/inverse3/*/config/handedness").starts_with("400: GET needs one device"));
    EXPECT_TRUE(refusal("GET", "/inverse3/7/config/handedness").starts_with("404: there is no inverse3 '7'"));
    EXPECT_TRUE(refusal("DELETE", "/devices").starts_with("405: "));
    EXPECT_TRUE(refusal("POST", "/inverse3/0/config/handedness", "{").starts_with("400: "));
    EXPECT_TRUE(
        refusal("POST", "/inverse3/0/config/handedness", std::string(5000, ' ')).starts_with("413: "));
    EXPECT_TRUE(refusal("POST", "/inverse3/0/config/handedness", R"({"handedness":"left"})", Role::observe)
                    .starts_with("403: "));
}

}  // namespace
