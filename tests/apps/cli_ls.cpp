// `knurl ls`: servos, devices, clients, representations, who holds what.

#include <cstring>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/json/json.hpp>
#include <knurl/reps/spring.hpp>

#include "../rights.hpp"
#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;

bool says(const Outcome& outcome, const std::string& text) {
    return outcome.out.find(text) != std::string::npos;
}

json servos() {
    const Outcome outcome = knurl({"ls", "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return json::parse(outcome.out).at("servos");
}

/// A socket of a program that is no servo.
class Stranger {
  public:
    explicit Stranger(const std::string& path, bool listens) : fd_(::socket(AF_UNIX, SOCK_SEQPACKET, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
        EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
        if (listens) {
            EXPECT_EQ(::listen(fd_, 1), 0);
        }
    }
    ~Stranger() { ::close(fd_); }

  private:
    int fd_;
};

TEST(Ls, WithoutAServoItSaysHowToStartOneAndSucceeds) {
    const Home home;
    const Outcome outcome = knurl({"ls"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_TRUE(says(outcome, "no servo is running")) << outcome.out;
    EXPECT_TRUE(says(outcome, "knurld --device sim:premium15")) << outcome.out;
    EXPECT_EQ(servos(), json::array());
}

TEST(Ls, ADirectoryThatIsNotThereHasNoServos) {
    const Home home;
    ::setenv("KNURL_RUNTIME_DIR", home.path("nothing").c_str(), 1);
    EXPECT_EQ(knurl({"ls"}).code, 0);
    EXPECT_EQ(servos(), json::array());
}

TEST(Ls, WhereItMayNotLookItSaysSoAndFails) {
    KNURL_NEEDS(missing_other_user());
    const Folder folder;  // the programs, for a user without access
    const Home home;
    ASSERT_EQ(::chmod(home.path("").c_str(), 0700), 0);
    const Outcome outcome = knurl_without_rights(folder, {"ls"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_TRUE(outcome.err.find("cannot be looked into: Permission denied") != std::string::npos)
        << outcome.err;
    EXPECT_FALSE(says(outcome, "no servo is running")) << outcome.out;
    ASSERT_EQ(::chmod(home.path("").c_str(), 0755), 0);
    const Servo servo({"--device", "sim:premium15"});
    const Outcome closed = knurl_without_rights(folder, {"ls"});
    EXPECT_EQ(closed.code, 1) << "the socket's mode lets nobody in\n" << closed.out << closed.err;
    EXPECT_TRUE(closed.err.find("knurl:default: socket ") != std::string::npos) << closed.err;
    EXPECT_FALSE(says(closed, "no servo is running")) << closed.out;
}

TEST(Ls, WithoutADescriptorLeftItSaysSo) {
    KNURL_NEEDS(missing_programs_without_descriptors());
    const Home home;
    const Servo servo({"--device", "sim:premium15"});
    const auto limited = [&](const char* most, const std::string& words) {
        return run({"/bin/sh", "-c",
                    std::string("exec 3>&- 4>&- 5>&- 6>&- 7>&- 8>&- 9>&-; ulimit -n ") +
                        most +  // the test's caller may have left some descriptors open
                        "; exec " + knurl_program() + " " + words});
    };
    for (const char* words :
         {"ls", "top --count 1", "record /dev/null", "reset", "latency --servo default"}) {
        const Outcome outcome = limited("4", words);
        EXPECT_EQ(outcome.code, 1) << words;
        EXPECT_TRUE(outcome.err.find("no descriptor left") != std::string::npos)
            << words << ": " << outcome.err;
        EXPECT_TRUE(outcome.err.find("ulimit -n") != std::string::npos) << words << ": " << outcome.err;
    }
}

TEST(Ls, APathThatIsTooLongForASocketIsToldAtOnce) {
    const Home home;
    const std::string folder = home.path(std::string(120, 'x'));
    ASSERT_EQ(::mkdir(folder.c_str(), 0700), 0);
    ::setenv("KNURL_RUNTIME_DIR", folder.c_str(), 1);
    const std::string reason = "the kernel takes at most 107; use a shorter folder (KNURL_RUNTIME_DIR)";
    for (const Outcome& outcome :
         {run({knurld_program(), "--device", "sim:premium15"}), knurl({"top", "--count", "1"}),
          knurl({"reset"}), knurl({"record", home.path("r.mcap")}),
          knurl({"latency", "--connect", "knurl:default"})}) {
        EXPECT_EQ(outcome.code, 1);
        EXPECT_TRUE(outcome.err.find(reason) != std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find("waited"), std::string::npos) << "a servo that starts would not mend it";
    }
}

TEST(Ls, ASocketThatAKilledServoLeftIsDead) {
    const Home home;
    { const Stranger gone(home.path("left.sock"), false); }
    const Outcome outcome = knurl({"ls"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_TRUE(says(outcome, "knurl:left: dead")) << outcome.out;
    EXPECT_TRUE(says(outcome, "no servo is running")) << outcome.out;
    EXPECT_EQ(servos().at(0).at("alive"), false);
}

TEST(Ls, ADeviceRunsAtTheRateOfItsDescriptionUnlessOneIsStated) {
    const Home home;
    std::string text = text_of_file(KNURL_ARMS "/generic6.toml");
    text.insert(text.find("[drive]\n") + 8, "rate = 500\n");
    const std::string arm = home.file("slow.toml", text);
    const auto rate = [&](const std::vector<std::string>& words) {
        std::vector<std::string> all{"--device", "slow=sim:arm=" + arm};
        all.insert(all.end(), words.begin(), words.end());
        const Servo servo(all);
        return servos().at(0).at("devices").at(0).at("rate").get<double>();
    };
    EXPECT_EQ(rate({}), 500);
    EXPECT_EQ(rate({"--rate", "2000"}), 2000);
}

TEST(Ls, ADeviceThatNobodyHoldsIsIdle) {
    const Home home;
    const Servo servo({"--name", "alpha", "--device", "left=sim:premium15", "--device", "sim:cartesian3"});
    const json all = servos();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0]["address"], "knurl:alpha");
    EXPECT_EQ(all[0]["pid"], servo.pid());
    EXPECT_EQ(all[0]["alive"], true);
    const json& devices = all[0]["devices"];
    ASSERT_EQ(devices.size(), 2u);
    EXPECT_EQ(devices[0]["name"], "left");
    EXPECT_EQ(devices[0]["address"], "sim:premium15");
    EXPECT_EQ(devices[0]["rate"], 1000);
    EXPECT_EQ(devices[0]["state"], "idle");
    EXPECT_GT(devices[0]["k_max"], 0);
    EXPECT_EQ(devices[0]["held_by"], json::array());
    EXPECT_EQ(devices[1]["name"], "cartesian3");
    EXPECT_TRUE(says(knurl({"ls"}), "nobody holds it"));
}

TEST(Ls, ShowsWhoHoldsADeviceAndWhatIsToBeFelt) {
    const Home home;
    const Servo servo({"--device", "sim:premium15"});
    Client client = Client::connect("knurl:default", {.name = "painter"});
    Claim hand = client.claim();
    hand.add(Plane{.stiffness = 500});
    hand.add(Plane{.normal = {1, 0, 0}, .offset = -0.05, .stiffness = 500});
    hand.add(Spring{.stiffness = 20});
    hand.commit();
    Client other = Client::connect("knurl:default", {.name = "viewer"});
    const Observer observer = other.observe();

    json device;
    EXPECT_TRUE(eventually([&] {
        device = servos().at(0).at("devices").at(0);
        const json& clients = device["clients"];
        return clients.size() == 2 && clients[0]["representations"]["plane"] == 2;
    })) << "both clients and the planes are listed";
    EXPECT_EQ(device["held_by"], json::array({::getpid()}));
    const json& claim = device["clients"][0];
    EXPECT_EQ(claim["pid"], ::getpid());
    EXPECT_EQ(claim["name"], "painter");
    EXPECT_EQ(claim["role"], "claim");
    int representations = 0;
    for (const json& count : claim["representations"]) representations += count.get<int>();
    EXPECT_EQ(representations, 3);
    EXPECT_EQ(claim["representations"]["plane"], 2);
    EXPECT_EQ(claim["representations"]["spring"], 1);
    EXPECT_EQ(device["clients"][1]["name"], "viewer");
    EXPECT_EQ(device["clients"][1]["role"], "observer");

    const Outcome text = knurl({"ls"});
    EXPECT_TRUE(says(text, "pid " + std::to_string(::getpid()) + " painter holds it: 2 plane, 1 spring"))
        << text.out;
    EXPECT_TRUE(says(text, "viewer observes")) << text.out;

    hand.release();
    EXPECT_TRUE(eventually([&] { return servos().at(0).at("devices").at(0).at("held_by").empty(); }))
        << "the device is free again";
}

TEST(Ls, AServoThatWasKilledIsDeadAtOnce) {
    const Home home;
    Servo servo({"--device", "sim:premium15"});
    servo.end(SIGKILL);
    EXPECT_TRUE(says(knurl({"ls"}), "knurl:default: dead"));
}

TEST(Ls, AProgramThatIsNoServoIsNotWaitedForForEver) {
    const Home home;
    const Stranger stranger(home.path("odd.sock"), true);
    const Outcome outcome = knurl({"ls"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_TRUE(says(outcome, "knurl:odd: the servo does not answer")) << outcome.out;
}

TEST(Knurl, AnUnknownVerbIsOneLineAndAFailure) {
    const Outcome outcome = knurl({"frobnicate"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err, "knurl: there is no verb 'frobnicate'; see knurl --help\n");
    const Outcome nothing = knurl({});
    EXPECT_EQ(nothing.code, 2);
    EXPECT_EQ(nothing.err.find("knurl: which of ls, "), 0u) << nothing.err;
    EXPECT_EQ(knurl({"ls", "--loud"}).code, 2);
}

TEST(Knurl, EveryVerbHasHelp) {
    for (const char* verb : {"ls", "eval", "latency"}) {
        const Outcome outcome = knurl({verb, "--help"});
        EXPECT_EQ(outcome.code, 0);
        EXPECT_TRUE(says(outcome, "--help")) << outcome.out;
        EXPECT_TRUE(says(knurl({"--help"}), verb));
    }
}

}  // namespace
}  // namespace knurl::test
