// The registry: servos announce themselves, programs find them by name, and the dead are gone.

#include <knurl/json/json.hpp>
#include <knurl/protocol/registry.hpp>

#include "e2e.hpp"

namespace {

using namespace knurl;
using namespace dds_test;
using client_test::ServoProcess;

/// Names and states, as the registry of this host lists them.
std::vector<std::string> listed() {
    std::vector<std::string> all;
    const auto servos = protocol::list_servos(own_domain());
    if (!servos) return {"no registry"};
    for (const std::string& text : *servos) {
        const Json servo = Json::parse(text);
        all.push_back(servo.at("name").get<std::string>() + " " + servo.at("state").get<std::string>());
    }
    return all;
}

using List = std::vector<std::string>;

struct RegistryTest : testing::Test {
    RegistryTest() { ::setenv("ROS_DOMAIN_ID", std::to_string(own_domain()).c_str(), 1); }
    ~RegistryTest() override { ::unsetenv("ROS_DOMAIN_ID"); }
};

TEST_F(RegistryTest, a_servo_is_listed_found_by_name_and_claimed) {
    ServoProcess servo;
    DdsProgram program({"--name", "lab"});
    ASSERT_TRUE(eventually([] { return listed() == List{"lab running"}; })) << program.program().said();
    const Json device = Json::parse(protocol::list_servos(own_domain())->front()).at("devices").at(0);
    EXPECT_EQ(device.at("name").get<std::string>(), "cartesian3");
    EXPECT_EQ(device.at("state").get<std::string>(), "idle");
    EXPECT_GT(device.at("k_max").get<double>(), 0);
    // Its own knurl-dds needs no bridge.
    EXPECT_EQ(protocol::resolve_servo("lab", own_domain()), "knurl:default");
    Client client = Client::connect("knurl://lab/cartesian3", {.name = "test", .wait = 20s});
    const Claim hand = client.claim();
    EXPECT_EQ(hand.device().name, "cartesian3");
    EXPECT_EQ(Client::connect("knurl://lab/").devices().size(), 1u);
    EXPECT_THROW(Client::connect("knurl://lab/other").claim(), Error);
}

TEST_F(RegistryTest, what_is_unknown_or_has_no_bridge_is_said_in_one_line) {
    ServoProcess servo;
    const auto why = [](const std::string& name) -> std::string {
        try {
            return protocol::resolve_servo(name, own_domain());
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    };
    EXPECT_NE(why("lab").find("none of domain " + std::to_string(own_domain()) +
                              " runs on this host; start one with `knurl-dds`"),
              std::string::npos)
        << why("lab");
    try {
        Client::connect("knurl://lab/right", {.name = "test", .wait = 0ms});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind, Error::Kind::no_servo);
        EXPECT_NE(std::string(error.what()).find("start one with `knurl-dds`"), std::string::npos)
            << error.what();
    }
    DdsProgram registry({"--registry"});
    EXPECT_NE(why("lab").find("has no servo 'lab'; no servo is announced there"), std::string::npos)
        << why("lab");
    // Another host, as far as the registry knows: a process of the domain with another door.
    Here here;
    Announced other(
        here,
        {.id = "1", .name = "lab", .servo = "default", .host = "far", .state = "running", .devices = {}});
    ASSERT_TRUE(eventually([&] { return why("lab").find("announces no bridge") != std::string::npos; }))
        << why("lab");
    EXPECT_NE(why("lbb").find("did you mean 'lab'?"), std::string::npos) << why("lbb");
    other.change([](auto& entry) { entry.bridge = "10.0.0.7:4096"; });
    EXPECT_TRUE(eventually([&] { return why("lab") == "knurl://10.0.0.7:4096"; })) << why("lab");
    other.change([](auto& entry) { entry.bridge = "\033[31m:x"; });
    EXPECT_TRUE(eventually([&] {
        return why("lab").find("announces a bridge that is none") != std::string::npos;
    })) << why("lab");
    EXPECT_EQ(why("lab").find('\033'), std::string::npos)
        << "a peer's text is shown without control characters";
    other.change([](auto& entry) {
        entry.bridge = "10.0.0.7:4096";
        entry.state = "gone";
    });
    EXPECT_TRUE(eventually([&] {
        return why("lab").find("does not run, only its knurl-dds does") != std::string::npos;
    })) << why("lab");
    EXPECT_THROW(protocol::registry_address("knurl://a b/c"), std::runtime_error);
    EXPECT_FALSE(protocol::registry_address("knurl://lab:4096"));
}

TEST_F(RegistryTest, through_a_bridge_by_name) {
    ServoProcess servo;
    client_test::BridgeProcess bridge;
    DdsProgram announced({"--name", "lab", "--bridge", bridge.host_and_port()});
    // A registry that is not the servo's own.
    const knurl::test::TempFolder elsewhere;
    const std::string here = std::getenv("KNURL_RUNTIME_DIR");
    ::setenv("KNURL_RUNTIME_DIR", elsewhere.path().c_str(), 1);
    DdsProgram registry({"--registry"});
    ASSERT_TRUE(eventually([] { return listed() == List{"lab running"}; }));
    EXPECT_EQ(protocol::resolve_servo("lab", own_domain()), "knurl://" + bridge.host_and_port());
    Client client = Client::connect("knurl://lab/cartesian3", {.name = "test", .wait = 20s});
    EXPECT_EQ(client.claim().device().name, "cartesian3");
    ::setenv("KNURL_RUNTIME_DIR", here.c_str(), 1);
}

TEST_F(RegistryTest, two_servos_of_one_name_are_told_and_neither_is_taken) {
    ServoProcess servo;
    DdsProgram one({"--name", "lab"});
    Here here;
    Announced other(here, {.id = "1",
                           .name = "lab",
                           .servo = "default",
                           .host = "far",
                           .bridge = "10.0.0.7:4096",
                           .state = "running",
                           .devices = {}});
    EXPECT_TRUE(one.program().says("two servos are called 'lab'")) << one.program().said();
    try {
        protocol::resolve_servo("lab", own_domain());
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("2 servos of domain"), std::string::npos) << error.what();
    }
    EXPECT_FALSE(other.registry.name_clashes().empty());
}

TEST_F(RegistryTest, a_killed_servo_is_gone_for_everybody_and_one_that_came_back_is_there_once) {
    ServoProcess servo;
    DdsProgram watcher({"--registry"});
    std::optional<DdsProgram> lab(std::in_place, std::vector<std::string>{"--name", "lab"});
    ASSERT_TRUE(eventually([] { return listed() == List{"lab running"}; }));
    lab->end(SIGKILL);
    ASSERT_TRUE(eventually([] { return listed() == List{}; })) << "its lease has ended";
    lab.emplace(std::vector<std::string>{"--name", "lab"});
    ASSERT_TRUE(eventually([] { return listed() == List{"lab running"}; }));
    servo.end(SIGKILL);
    ASSERT_TRUE(eventually([] { return listed() == List{"lab gone"}; }));
    servo.start();
    ASSERT_TRUE(eventually([] { return listed() == List{"lab running"}; })) << lab->program().said();
}

TEST_F(RegistryTest, knurl_dds_lists_a_domain_with_a_registry_and_without) {
    ServoProcess servo;
    Here here;
    Announced other(
        here,
        {.id = "1", .name = "far", .servo = "default", .host = "far", .state = "running", .devices = {}});
    const auto list = [] {
        return knurl::test::run({KNURL_DDS, "list", "--domain", std::to_string(own_domain())});
    };
    const auto alone = list();
    EXPECT_EQ(alone.code, 0) << alone.err;
    EXPECT_NE(alone.out.find("\"name\":\"far\""), std::string::npos) << alone.out << alone.err;
    DdsProgram registry({"--registry"});
    EXPECT_TRUE(eventually([&] { return list().out.find("\"name\":\"far\"") != std::string::npos; }));
}

TEST_F(RegistryTest, knurl_lists_a_domain_for_people) {
    ServoProcess servo;
    DdsProgram program({"--name", "lab", "--bridge", "lab.example:4096", "--command", "cartesian3"});
    const std::string domain = std::to_string(own_domain());
    ASSERT_TRUE(eventually([] { return listed() == List{"lab running"}; }));
    const auto ls = knurl::test::knurl({"ls", "--domain", domain});
    EXPECT_EQ(ls.code, 0) << ls.err;
    EXPECT_NE(ls.out.find("knurl://lab/: on "), std::string::npos) << ls.out;
    EXPECT_NE(ls.out.find(", bridge lab.example:4096\n  cartesian3 (cartesian3, 1000 Hz): idle"),
              std::string::npos)
        << ls.out;
    EXPECT_NE(ls.out.find("nobody holds it, may be commanded by DDS"), std::string::npos) << ls.out;
    EXPECT_TRUE(eventually([&] {
        return knurl::test::knurl({"top", "--domain", domain, "--count", "2", "--rate", "20"})
                   .out.find("cycles/s") != std::string::npos;
    }));
    const auto none = knurl::test::knurl({"ls", "--domain", std::to_string(100 + own_domain())});
    EXPECT_EQ(none.code, 0);
    EXPECT_NE(none.out.find("no servo is announced in domain " + std::to_string(100 + own_domain())),
              std::string::npos)
        << none.out << none.err;
}

TEST_F(RegistryTest, what_cannot_be_is_refused_in_one_line) {
    const knurl::test::Home home;
    const auto says = [](std::vector<std::string> words) {
        words.insert(words.begin(), KNURL_DDS);
        return knurl::test::run(words);
    };
    auto outcome = says({"--interface", "10.255.255.1"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("this host has none with that name or IPv4 address"), std::string::npos)
        << outcome.err;
    outcome = says({"--servo", "knurl://far:4096"});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    outcome = says({"--domain", "500"});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    outcome = says({"--bridge", "a:b"});
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    outcome = says({"--config", home.file("bad.toml", "domian = 1\n")});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("bad.toml:1:1: unknown key \"domian\""), std::string::npos) << outcome.err;
}

}  // namespace
