// knurl-bodies as a person runs it: on simulated devices, with a hand that a mouse moves (a FIFO replaces the
// mouse), and on a terminal.

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/client/client.hpp>

#include "program.hpp"

namespace {

using namespace std::chrono_literals;
using knurl::test::Background;
using knurl::test::eventually;
using knurl::test::Home;
using knurl::test::OnTerminal;
using knurl::test::Outcome;
using knurl::test::run;
using knurl::test::Servo;
using testing::HasSubstr;

/// Writes the events of a mouse.
class Mouse {
  public:
    explicit Mouse(const std::string& path) {
        if (::mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error(path + ": no FIFO for the test");
        fifo_ = knurl::shm::UniqueFd(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    }
    void button(bool pressed) { write(EV_KEY, BTN_LEFT, pressed); }
    /// Notches of 2 mm.
    void up(int notches) { write(EV_REL, REL_WHEEL, notches); }

  private:
    void write(unsigned short type, unsigned short code, int value) {
        input_event event{};
        event.type = type;
        event.code = code;
        event.value = value;
        ASSERT_EQ(::write(fifo_.get(), &event, sizeof event), static_cast<ssize_t>(sizeof event));
    }
    knurl::shm::UniqueFd fifo_;
};

class BodiesProgram : public testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directory(temporary_);
        ::setenv("TMPDIR", temporary_.c_str(), 1);
    }
    void TearDown() override { ::unsetenv("TMPDIR"); }

    const Home home_;
    const std::filesystem::path temporary_ = home_.path("tmp");
};

/// The number after that text; the test fails if it is missing.
double figure(const std::string& in, const std::string& behind) {
    const auto at = in.find(behind);
    EXPECT_NE(at, std::string::npos) << behind << " in " << in;
    return at == std::string::npos ? 0 : std::stod(in.substr(at + behind.size()));
}

TEST_F(BodiesProgram, ShowsItselfWithoutADevice) {
    const std::string picture = home_.path("b.png"), csv = home_.path("b.csv");
    Outcome shown;
    // The hand moves by the clock: if the machine stalls, the cube is out of reach.
    for (int tries = 0; tries < 3 && shown.err.find("lets go of the cube") == std::string::npos; ++tries)
        shown = run({KNURL_BODIES_PROGRAM, "--demo", "--device", "sim:generic6", "--fingers", "3",
                     "--picture", picture, "--csv", csv});
    ASSERT_EQ(shown.code, 0) << shown.err;
    EXPECT_THAT(shown.err, HasSubstr("holds the cube"));
    EXPECT_THAT(shown.err, HasSubstr("lets go of the cube"));
    EXPECT_THAT(shown.out, HasSubstr("cube: from"));
    EXPECT_GT(figure(shown.out, "torque up to "), 1e-3) << "N m";
    EXPECT_LE(figure(shown.out, "the bodies got "), figure(shown.out, "the hand put in "));
    EXPECT_EQ(knurl::test::text_of_file(picture).substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_GT(std::filesystem::file_size(csv), 10'000u);
    EXPECT_TRUE(std::filesystem::is_empty(temporary_)) << "it leaves nothing behind";
}

TEST_F(BodiesProgram, ComparesAndSaysBothFigures) {
    const Outcome compared = run({KNURL_BODIES_PROGRAM, "--compare", "--rate", "60"});
    ASSERT_EQ(compared.code, 0) << compared.err;
    EXPECT_THAT(compared.out, HasSubstr("60 frames a second"));
    for (const char* what : {"force sent", "surface", "as admitted", "pressed from above", "pushed along it",
                             "felt", "twice the same"})
        EXPECT_THAT(compared.out, HasSubstr(what));
}

TEST_F(BodiesProgram, SaysThatTheSimulationIsSlowAndStaysStable) {
    const Outcome slow = run({KNURL_BODIES_PROGRAM, "--demo", "--slow", "0.04", "--seconds", "9"});
    ASSERT_EQ(slow.code, 0) << slow.err;
    EXPECT_THAT(slow.err, HasSubstr("slower than real time"));
    EXPECT_LT(figure(slow.out, "change of the force in a cycle "), 2) << "N";
    EXPECT_LE(figure(slow.out, "the bodies got "), figure(slow.out, "the hand put in "));
}

TEST_F(BodiesProgram, SaysThatTheEngineHasLostABodyAndEndsWithAFailure) {
    const Outcome lost = run({KNURL_BODIES_PROGRAM, "--demo", "--lose-at", "1"});
    EXPECT_EQ(lost.code, 1);
    EXPECT_THAT(lost.err, HasSubstr("the engine has lost the slab"));
    EXPECT_THAT(lost.err, HasSubstr("let go of everything"));
}

TEST_F(BodiesProgram, SaysWhatIsWrong) {
    const auto says = [](std::vector<std::string> words) {
        words.insert(words.begin(), KNURL_BODIES_PROGRAM);
        return run(words);
    };
    for (const std::vector<std::string>& nonsense :
         std::vector<std::vector<std::string>>{{"--rate", "0"},
                                               {"--rate", "nan"},
                                               {"--fingers", "2"},
                                               {"--servo", "a b"},
                                               {"--stiffness", "-1"},
                                               {"--slow", "-1"},
                                               {"--seconds", "soon"},
                                               {"--juggle"}}) {
        const Outcome refused = says(nonsense);
        EXPECT_EQ(refused.code, 2) << nonsense[0];
        EXPECT_THAT(refused.err, HasSubstr(nonsense[0]));
    }
    const Outcome alone = says({"--wait", "0"});
    EXPECT_EQ(alone.code, 1);
    EXPECT_THAT(alone.err, HasSubstr("no servo 'default' listens"));
    EXPECT_THAT(says({"--demo", "--picture", "/nowhere/p.png"}).err, HasSubstr("/nowhere"));
    const Outcome device = says({"--demo", "--device", "sim:nothing"});
    EXPECT_EQ(device.code, 1);
    EXPECT_THAT(device.err, HasSubstr("nothing"));
}

/// A servo with a mouse for a hand, above the cube.
struct OnAServo : BodiesProgram {
    /// Takes the cube with the button, and lifts it.
    void lift(Background& program) {
        ASSERT_TRUE(eventually([&] { return active(); })) << "the device is active";
        mouse_.up(-5);
        // Waits until the hand has arrived, since before that no body is within reach.
        ASSERT_TRUE(eventually([&] { return newest().position.z < -0.008; }));
        mouse_.button(true);
        ASSERT_TRUE(program.says("holds the cube")) << program.said();
        mouse_.up(15);
        ASSERT_TRUE(eventually([&] { return lifted(); })) << "it weighs 1 N";
    }
    knurl::HandReport newest() { return observer_.latest().value_or(knurl::HandReport{}); }
    /// True: the cube is lifted, and the hand has reached its target.
    bool lifted() {
        const knurl::HandReport now = newest();
        return now.position.z > 0.005 && now.scene_force.z < -0.5 &&
               knurl::to_eigen(now.velocity).norm() < 0.02;
    }
    bool active() { return newest().state == knurl::DeviceState::active; }

    Mouse mouse_{home_.path("mouse")};
    Servo servo_{{"--device", "sim:premium15,live=" + home_.path("mouse")}};
    knurl::Client client_ = knurl::Client::connect("knurl:default", {.name = "beside", .wait = 20s});
    knurl::Observer observer_ = client_.observe();
};

TEST_F(OnAServo, TakesWithTheButtonAndTheDeviceIsAtRestHoweverItEnds) {
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        SCOPED_TRACE(signal);
        Background program({KNURL_BODIES_PROGRAM});
        ASSERT_NO_FATAL_FAILURE(lift(program));
        while (observer_.next_report(0ms)) {
        }
        EXPECT_EQ(program.end(signal), signal == SIGKILL ? 128 + SIGKILL : 0) << program.said();
        // The force fades to zero, without a step.
        knurl::HandReport last = newest();
        double step = 0;
        EXPECT_TRUE(eventually([&] {
            while (const auto report = observer_.next_report(0ms)) {
                if (report->cycle == last.cycle + 1)
                    step = std::max(
                        step,
                        (knurl::to_eigen(report->sent_force) - knurl::to_eigen(last.sent_force)).norm());
                EXPECT_EQ(report->faults, 0u);
                EXPECT_LT(knurl::to_eigen(report->velocity).norm(), 0.5) << "m/s";
                last = *report;
            }
            return last.sent_force == knurl::Vec3{} && last.state == knurl::DeviceState::idle;
        }));
        EXPECT_LT(step, 0.5) << "N in a cycle";
        mouse_.button(false);
        mouse_.up(-10);
        ASSERT_TRUE(eventually([&] { return std::abs(newest().position.z) < 0.004; })) << "the hand is back";
    }
}

TEST_F(OnAServo, SaysThatTheServoHasGone) {
    Background program({KNURL_BODIES_PROGRAM});
    ASSERT_NO_FATAL_FAILURE(lift(program));
    servo_.end(SIGKILL);
    EXPECT_TRUE(program.says("the servo has gone; start it again")) << program.said();
    EXPECT_EQ(program.end(0), 1);
}

TEST_F(OnAServo, TakesLetsGoPutsBackAndEndsByKeys) {
    KNURL_NEEDS(knurl::test::missing_terminal());
    OnTerminal program({KNURL_BODIES_PROGRAM});
    ASSERT_TRUE(eventually([&] { return active(); }));
    program.type(' ');
    ASSERT_TRUE(program.shows("nothing within reach")) << program.shown;
    mouse_.up(-5);
    ASSERT_TRUE(eventually([&] { return newest().position.z < -0.008; }));
    // On a busy machine the program may know the hand of some frames ago.
    constexpr int tries_to_take = 20;
    bool held = false;
    for (int i = 0; i < tries_to_take && !held; ++i) {
        program.shown.clear();
        program.type(' ');
        ASSERT_TRUE(program.shows_one_of({"holds the cube", "nothing within reach"})) << program.shown;
        held = program.shown.find("holds the cube") != std::string::npos;
    }
    ASSERT_TRUE(held) << program.shown;
    program.type(' ');
    ASSERT_TRUE(program.shows("lets go of the cube")) << program.shown;
    program.shown.clear();
    program.type(' ');
    ASSERT_TRUE(program.shows("holds the cube")) << program.shown;
    mouse_.up(15);
    // If the machine stalls the cube is lost, with a message; a person resets and takes it again.
    const auto lifted_or_seconds_later = [&] {
        int looks = 0;
        (void)eventually([&] { return lifted() || ++looks == 5000; });
        return lifted();
    };
    for (int tries = 0; tries < 5 && !lifted_or_seconds_later(); ++tries) {
        ASSERT_TRUE(program.shows("the cube has slipped out of the hand")) << program.shown;
        mouse_.up(-15);
        program.type('r');
        ASSERT_TRUE(eventually([&] { return newest().position.z < -0.008; }));
        program.shown.clear();
        program.type(' ');
        ASSERT_TRUE(program.shows("holds the cube")) << program.shown;
        mouse_.up(15);
    }
    ASSERT_TRUE(eventually([&] { return lifted(); })) << program.shown;
    program.shown.clear();
    program.type('r');
    ASSERT_TRUE(program.shows("the cube has slipped out of the hand")) << program.shown;
    program.type('q');
    EXPECT_EQ(program.end(), 0);
    EXPECT_THAT(program.shown, HasSubstr("were put elsewhere"));
}

}  // namespace
