// A real knurld that owns two devices on the emulated bus: an event on one does not affect the other. Run by
// scripts/usb (KNURL_USB_TWO_HANDS=1), not by ctest: two devices at 1 kHz need 8 exchanges a millisecond of
// umockdev's one worker, and a virtual machine on which one takes 0.3 ms carries 3. Both hands then stand
// still for tens of milliseconds, unplugged or not.

#include <csignal>
#include <cstdlib>

#include "knurld_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

/// One servo owns a Falcon and a WoodenHaptics; the parameter is the one that is unplugged.
class TwoHandsOfOneApplication : public testing::TestWithParam<std::size_t> {
  protected:
    struct Hand {
        const MotorDevice& device;
        const char *name, *port;
        std::shared_ptr<MotorModel> model = device.make();
        std::optional<Claim> claim = {};
        std::optional<Handle<Plane>> floor = {};
        std::array<int, 3> steady = {};
    };

    void SetUp() override {
        if (not_here != nullptr) GTEST_SKIP() << not_here;
        if (std::getenv("KNURL_USB_TWO_HANDS") == nullptr)
            GTEST_SKIP()
                << "more than the emulated bus carries on some machines: KNURL_USB_TWO_HANDS=1 runs it";
        std::vector<std::string> arguments;
        for (Hand& hand : hands_) {
            plug_in(bus_, hand.device, hand.model, hand.port);
            arguments.insert(arguments.end(),
                             {"--device", std::string(hand.name) + "=" + hand.device.address});
        }
        servo_ = std::make_unique<client_test::ServoProcess>(arguments);
        client_.emplace(client_test::connect());
        for (Hand& hand : hands_) {
            hand.claim.emplace(client_->claim(hand.name));
            hand.floor.emplace(hand.claim->add(felt_floor));
        }
        ASSERT_TRUE(both_push());
        for (Hand& hand : hands_) hand.steady = bus_.locked([&] { return hand.model->motors(); });
    }
    void TearDown() override {
        if (servo_) servo_->end(SIGTERM);
    }

    bool both_push() {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (std::chrono::steady_clock::now() < deadline) {
            int pushing = 0;
            for (Hand& hand : hands_)
                pushing += try_to_arm(*hand.claim) == DeviceState::active &&
                                   bus_.locked([&] { return hand.model->motors() != std::array<int, 3>{}; })
                               ? 1
                               : 0;
            if (pushing == 2) return true;
        }
        return false;
    }
    /// The application continues for so many ms, or until the unplugged device's state is `until`; the other
    /// must always be active.
    bool go_on(Hand& pulled, Hand& other, std::uint64_t frames, DeviceState until) {
        for (const std::uint64_t end = bus_.frame() + frames; bus_.frame() < end;) {
            const auto seen = other.claim->next_report(1s);
            EXPECT_TRUE(seen && seen->state == DeviceState::active) << (seen ? "it let go" : "no report");
            other.claim->commit();
            const auto gone = pulled.claim->latest();
            pulled.claim->commit();
            if (gone && gone->state == until) return true;
        }
        return false;
    }
    std::size_t requests(const Hand& hand) {
        return bus_.locked([&] { return hand.model->requests().size(); });
    }
    /// Only the floor's effort has reached that hand since its packet number `first`, except for the zero
    /// that its I/O thread sends when this machine has stood still for 10 ms.
    void expect_floor(const Hand& hand, std::size_t first) {
        bus_.locked([&] {
            const std::size_t all = hand.model->requests().size();
            EXPECT_GT(all, first + 100);
            std::size_t zeros = 0;
            for (std::size_t i = first; i < all; ++i) {
                const MotorRequest& request = hand.model->requests()[i];
                zeros += request.is_zero() ? 1 : 0;
                for (std::size_t motor = 0; motor < 3 && !request.is_zero(); ++motor)
                    EXPECT_NEAR(request.motors[motor], hand.steady[motor], 2) << i;
            }
            EXPECT_LE(zeros, (all - first) / 20);
        });
    }

    Bus bus_;
    std::array<Hand, 2> hands_ = {Hand{falcon_device, "right", "1-1"}, Hand{wooden_device, "left", "1-2"}};
    std::unique_ptr<client_test::ServoProcess> servo_;
    std::optional<Client> client_;
};

TEST_P(TwoHandsOfOneApplication, OneIsUnpluggedAndTheOtherGoesOnFeeling) {
    Hand &pulled = hands_[GetParam()], &other = hands_[1 - GetParam()];
    const std::size_t felt = requests(other);
    bus_.unplug(pulled.port);
    const std::size_t before = requests(pulled);
    ASSERT_TRUE(go_on(pulled, other, 10000, DeviceState::disconnected));
    go_on(pulled, other, 200, DeviceState::active);
    plug_in(bus_, pulled.device, pulled.model, pulled.port);
    EXPECT_FALSE(go_on(pulled, other, 500, DeviceState::active)) << "nobody has armed it";
    expect_floor(other, felt);
    bus_.locked([&] {
        EXPECT_GT(pulled.model->requests().size(), before) << "it is back";
        for (std::size_t i = before; i < pulled.model->requests().size(); ++i)
            EXPECT_TRUE(pulled.model->requests()[i].is_zero());
    });
    EXPECT_TRUE(!pulled.device.homed_after_replug || both_push());
}

INSTANTIATE_TEST_SUITE_P(Devices, TwoHandsOfOneApplication, testing::Values(0U, 1U),
                         [](const auto& of) { return of.param == 0 ? "falcon" : "wooden"; });

}  // namespace
}  // namespace knurl::drivers
