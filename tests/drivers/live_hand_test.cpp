// Mouse and keyboard move the simulated hand: events as the kernel's input layer writes them, through a pipe.

#include <chrono>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/input.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/drivers/registry.hpp>

namespace knurl::drivers {
namespace {

/// A named pipe in place of /dev/input/eventN.
class InputNode {
  public:
    explicit InputNode(const std::string& name)
        : path_((std::filesystem::temp_directory_path() / ("knurl-live-" + std::to_string(getpid()) + name))
                    .string()) {
        unlink(path_.c_str());
        if (mkfifo(path_.c_str(), 0600) != 0) throw std::runtime_error("mkfifo");
        fd_ = open(path_.c_str(), O_RDWR | O_CLOEXEC);
    }
    ~InputNode() {
        close(fd_);
        unlink(path_.c_str());
    }
    InputNode(const InputNode&) = delete;
    InputNode& operator=(const InputNode&) = delete;

    void send(std::uint16_t type, std::uint16_t code, std::int32_t value) const {
        input_event event{};
        event.type = type;
        event.code = code;
        event.value = value;
        ASSERT_EQ(write(fd_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
    }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
    int fd_ = -1;
};

class LiveHandTest : public testing::Test {
  protected:
    InputNode mouse_{"m"}, keyboard_{"k"};
    std::unique_ptr<Device> device_ =
        open_device("sim:cartesian3,live=" + mouse_.path() + ":" + keyboard_.path());
    JointSample sample_;
    Nanoseconds now_ = 0;

    void step() { device_->read(now_ += 1'000'000, sample_); }
    /// Runs cycles, on the virtual clock, until it is so; the listener reads at its own pace.
    template <class Wanted>
    bool eventually(Wanted wanted) {
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (std::chrono::steady_clock::now() < give_up) {
            step();
            if (wanted()) return true;
        }
        return false;
    }
    bool near(double x, double y, double z) {
        return std::abs(sample_.position[0] - x) < 1e-3 && std::abs(sample_.position[1] - y) < 1e-3 &&
               std::abs(sample_.position[2] - z) < 1e-3;
    }
};

TEST_F(LiveHandTest, TheMouseMovesItInThePlaneAndTheWheelUpAndDown) {
    step();
    EXPECT_TRUE(near(0, 0, 0));
    mouse_.send(EV_REL, REL_X, 100);
    mouse_.send(EV_REL, REL_Y, -50);
    mouse_.send(EV_REL, REL_WHEEL, -5);
    EXPECT_TRUE(eventually([&] { return near(0.02, 0.01, -0.01); })) << sample_.position[0];
}

TEST_F(LiveHandTest, AKeyMovesItWhileItIsHeldAndNoFurtherThanTheWorkspace) {
    keyboard_.send(EV_KEY, KEY_RIGHT, 1);
    EXPECT_TRUE(eventually([&] { return sample_.position[0] > 0.03; }));
    EXPECT_TRUE(eventually([&] { return near(device_->link().workspace_radius, 0, 0); }));
    for (int i = 0; i < 2000; ++i) step();
    EXPECT_LT(sample_.position[0], device_->link().workspace_radius + 1e-3);
    keyboard_.send(EV_KEY, KEY_RIGHT, 0);
    keyboard_.send(EV_KEY, KEY_LEFT, 1);
    EXPECT_TRUE(eventually([&] { return sample_.position[0] < 0.05; }));
}

TEST_F(LiveHandTest, AProgramSaysThePlaceAndTheMouseMovesItOnFromThere) {
    mouse_.send(EV_ABS, ABS_X, 3000);  // 10 um a unit
    mouse_.send(EV_ABS, ABS_Y, -1000);
    mouse_.send(EV_ABS, ABS_Z, 2000);
    EXPECT_TRUE(eventually([&] { return near(0.03, -0.01, 0.02); })) << sample_.position[0];
    mouse_.send(EV_REL, REL_X, 50);
    EXPECT_TRUE(eventually([&] { return near(0.04, -0.01, 0.02); })) << sample_.position[0];
    mouse_.send(EV_ABS, ABS_X, 3000);
    EXPECT_TRUE(eventually([&] { return near(0.03, -0.01, 0.02); })) << "the same place once more";
}

TEST_F(LiveHandTest, ButtonsAreTheReports) {
    mouse_.send(EV_KEY, BTN_RIGHT, 1);
    EXPECT_TRUE(eventually([&] { return sample_.buttons == 2; }));
    keyboard_.send(EV_KEY, KEY_SPACE, 1);
    EXPECT_TRUE(eventually([&] { return sample_.buttons == 3; }));
    mouse_.send(EV_KEY, BTN_RIGHT, 0);
    EXPECT_TRUE(eventually([&] { return sample_.buttons == 1; }));
}

TEST(LiveHand, ANodeThatCannotBeOpenedIsNamed) {
    try {
        open_device("sim:premium15,live=/dev/input/no-such-event");
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("cannot open \"/dev/input/no-such-event\""),
                  std::string::npos)
            << error.what();
        EXPECT_NE(std::string(error.what()).find("/dev/input/by-id"), std::string::npos) << error.what();
    }
}

TEST(LiveHand, WhatIsNoInputDeviceIsRefused) {
    const InputNode mouse{"n"};
    for (const std::string path : {"/etc/passwd", "/dev/null", "/tmp"}) {
        try {
            open_device("sim:premium15,live=" + mouse.path() + ":" + path);
            ADD_FAILURE() << path;
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find("\"" + path + "\" is no input device; /dev/input/by-id"),
                      std::string::npos)
                << error.what();
        }
    }
}

}  // namespace
}  // namespace knurl::drivers
