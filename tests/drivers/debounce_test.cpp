// Buttons that bounce: which changes of their contacts become an edge, and when.

#include <bit>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/drivers/debounce.hpp>
#include <knurl/drivers/motion_device.hpp>
#include <knurl/drivers/registry.hpp>

using namespace knurl::drivers;

namespace {

constexpr Nanoseconds ms = 1'000'000;

/// "0001011111": a reading of one button each millisecond; returns what is reported.
std::string told(const std::string& contacts, double hold = Debounce::usual) {
    Debounce debounce(hold);
    std::string levels;
    Nanoseconds now = 7 * ms;
    for (const char level : contacts) levels += debounce(now += ms, level == '1' ? 1 : 0) != 0 ? '1' : '0';
    return levels;
}

TEST(Debounce, ChatterIsOneEdgeAndThatOneIsNotLate) {
    EXPECT_EQ(told("000101011111111000"), "000111111111111000") << "pressed at the first contact";
    EXPECT_EQ(told("111111111101010000"), "111111111100000000") << "let go at the first gap";
    EXPECT_EQ(told("1"), "1") << "held when the device is opened";
}

TEST(Debounce, APressShorterThanTheHoldIsToldAsOneThatLong) {
    EXPECT_EQ(told("0010000000000"), "0011111000000");
    EXPECT_EQ(told("1111111011111111"), "1111111000001111") << "and so is a gap";
}

TEST(Debounce, AfterTheHoldTheLevelIsFollowed) {
    EXPECT_EQ(told("0101010100000000"), "0111110000000000");
    EXPECT_EQ(told("01011110000000"), "01111110000000");
    EXPECT_EQ(told("010000000000000000", 10e-3), "011111111110000000");
}

TEST(Debounce, EachButtonHasAHoldOfItsOwn) {
    Debounce debounce(Debounce::usual);
    EXPECT_EQ(debounce(1 * ms, 0x1), 0x1u);
    EXPECT_EQ(debounce(2 * ms, 0x80000002), 0x80000003u);
    EXPECT_EQ(debounce(6 * ms, 0x80000000), 0x80000002u);
    EXPECT_EQ(debounce(7 * ms, 0x80000000), 0x80000000u);
}

TEST(Debounce, WhateverTheContactsDoEdgesAreApartAndEveryLevelThatStaysIsTold) {
    const unsigned seed = std::random_device{}();
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Debounce debounce(Debounce::usual);
    Nanoseconds now = 0, last_edge = -100 * ms, steady_since = 0;
    std::uint32_t raw = 0, before = 0;
    for (int i = 0; i < 100'000; ++i) {
        now += random() % (2 * ms);
        if (random() % 8 < 3) raw ^= 1, steady_since = now;
        const std::uint32_t level = debounce(now, raw);
        if (level != before) {
            EXPECT_GE(now - last_edge, 5 * ms);
            EXPECT_EQ(level, raw) << "an edge is what the contacts say at that moment";
            last_edge = now;
        }
        if (now - steady_since >= 5 * ms) {
            EXPECT_EQ(level, raw);
        }
        before = level;
    }
}

/// A probe at rest whose contacts a test sets, and whose samples may be bad.
class Clicker final : public Device {
  public:
    static inline std::uint32_t contacts = 0;
    static inline ReadStatus status = ReadStatus::ok;
    const LinkConfig& link() const noexcept override { return rest_.link(); }
    const Mechanism& mechanism() const noexcept override { return rest_.mechanism(); }
    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override {
        rest_.read(now, sample);
        sample.buttons = status == ReadStatus::ok ? contacts : ~contacts;
        return status;
    }
    bool write(Nanoseconds, const JointEfforts&) noexcept override { return true; }
    void make_safe() noexcept override {}

  private:
    MotionDevice rest_{Motion(std::vector<MotionRow>{{.t = 0}, {.t = 1}})};
};

class OpenedDevice : public testing::Test {
  protected:
    OpenedDevice() {
        Clicker::contacts = 0;
        Clicker::status = ReadStatus::ok;
        drivers().push_back(
            {.scheme = "clicker", .help = "", .open = [this](std::string_view what, const OpenOptions&) {
                 what_ = what;
                 return std::make_unique<Clicker>();
             }});
    }
    ~OpenedDevice() override { drivers().pop_back(); }

    std::string what_;
};

TEST_F(OpenedDevice, IsDebouncedWhateverItsDriver) {
    const auto device = open_device("clicker:a,b=1");
    EXPECT_EQ(what_, "a,b=1");
    JointSample sample;
    device->read(1 * ms, sample);
    Clicker::contacts = 4;
    device->read(2 * ms, sample);
    EXPECT_EQ(sample.buttons, 4u);
    Clicker::contacts = 0;
    device->read(4 * ms, sample);
    EXPECT_EQ(sample.buttons, 4u);
    Clicker::status = ReadStatus::bad;
    device->read(9 * ms, sample);
    EXPECT_EQ(sample.buttons, 4u) << "garbage is no edge";
    Clicker::status = ReadStatus::ok;
    device->read(10 * ms, sample);
    EXPECT_EQ(sample.buttons, 0u);
}

TEST_F(OpenedDevice, TellsTheContactsThemselvesOnRequest) {
    const auto device = open_device("clicker:a,debounce=0,b=1");
    EXPECT_EQ(what_, "a,b=1") << "the driver does not see the option";
    JointSample sample;
    for (Nanoseconds now = ms; now < 20 * ms; now += ms) {
        Clicker::contacts ^= 1;
        device->read(now, sample);
        EXPECT_EQ(sample.buttons, Clicker::contacts);
    }
    open_device("clicker:debounce=0.01");
    EXPECT_EQ(what_, "");
}

TEST_F(OpenedDevice, SaysWhatDebounceMayBe) {
    for (const char* value : {"", "x", "-1", "nan", "0.2", "1e-3s"}) {
        const std::string address = std::string("clicker:,debounce=") + value;
        try {
            open_device(address);
            FAIL() << address;
        } catch (const std::runtime_error& error) {
            const std::string what = error.what();
            EXPECT_EQ(what.rfind(address + ": cannot use debounce=", 0), 0u) << what;
            EXPECT_NE(what.find("give 0 to 0.1 s"), std::string::npos) << what;
        }
    }
}

}  // namespace
