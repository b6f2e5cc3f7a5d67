// 1 kHz for some seconds, the driver and a bare loop in turns: how many cycles went without a new sample,
// against how many the plainest loop over libusb did not finish in its millisecond, on the same machine and
// bus. Prints figures; asserts what does not depend on the machine: orders arrive in their order, none twice.
// The long form: KNURL_USB_SECONDS=60 (scripts/usb).

#include <cstdlib>
#include <ctime>

#include <libusb.h>

#include "falcon_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

Nanoseconds clock_now() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

/// Calls `cycle` every millisecond, and says how often it was not done before the next one was due.
template <class Cycle>
int paced(int cycles, Cycle&& cycle) {
    int late = 0;
    Nanoseconds due = clock_now();
    for (int i = 0; i < cycles; ++i) {
        due += millisecond;
        const timespec until{.tv_sec = due / 1'000'000'000, .tv_nsec = due % 1'000'000'000};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
        cycle();
        const Nanoseconds now = clock_now();
        if (now < due + millisecond) continue;
        ++late;
        due = now;
    }
    return late;
}

void real_time() {
    const sched_param parameters{.sched_priority = 55};
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);  // where it may
}

/// Write 16 bytes, read until as many have come back: no thread, no parser, nothing to spare.
class BareLoop {
  public:
    explicit BareLoop(const std::string& port) {
        libusb_init(&context_);
        libusb_device** all = nullptr;
        const ssize_t n = libusb_get_device_list(context_, &all);
        for (ssize_t i = 0; i < n; ++i) {
            std::uint8_t number = 0;
            if (libusb_get_port_numbers(all[i], &number, 1) == 1 && "1-" + std::to_string(number) == port)
                libusb_open(all[i], &handle_);
        }
        libusb_free_device_list(all, 1);
        if (handle_ == nullptr) throw std::runtime_error("no device in port " + port);
        libusb_set_auto_detach_kernel_driver(handle_, 1);
        libusb_claim_interface(handle_, 0);
        for (const auto& [request, value] : {std::pair{9, 1}, {3, 2}, {6, 0x013E}})
            libusb_control_transfer(handle_, 0x40, static_cast<std::uint8_t>(request),
                                    static_cast<std::uint16_t>(value), 0, nullptr, 0, 100);
    }
    ~BareLoop() {
        libusb_release_interface(handle_, 0);
        libusb_close(handle_);
        libusb_exit(context_);
    }
    BareLoop(const BareLoop&) = delete;
    BareLoop& operator=(const BareLoop&) = delete;

    void exchange() {
        std::uint8_t out[17] = "<AAAAAAAAAAAAAA>", in[64];
        int moved = 0;
        libusb_bulk_transfer(handle_, 0x02, out, 16, &moved, 100);
        for (int heard = 0; heard < 16; heard += moved - 2)
            if (libusb_bulk_transfer(handle_, 0x81, in, sizeof in, &moved, 100) != 0 || moved < 2) return;
    }

  private:
    libusb_context* context_ = nullptr;
    libusb_device_handle* handle_ = nullptr;
};

TEST(AtOneKilohertz, TheDriverMissesNoTransferThatABareLoopWouldHaveMade) {
    const char* asked = std::getenv("KNURL_USB_SECONDS");
    const int seconds = asked != nullptr ? std::atoi(asked) : 1;
    const int cycles = 1000 * seconds;
    Bus bus;
    const auto ours = falcon_at_centre(), theirs = falcon_at_centre();
    ours->hand = [](double t) { return legs_at(circling(t)); };
    bus.plug(ours, {.port = "1-1", .serial = "OURS"});
    bus.plug(theirs, {.port = "1-2", .serial = "THEIRS"});
    const auto device =
        open_device("falcon:OURS,event_char=on,low_pass=0", {.hand_file = "", .seed = 1, .io_priority = 56});
    BareLoop bare("1-2");

    int stale = 0, late = 0, bare_late = 0, order = 0;
    const auto in_real_time = [](auto&& what) {
        std::thread([&] {
            real_time();
            what();
        }).join();
    };
    // In turns, a second each: side by side, the two would share the mock's one worker.
    for (int second = 0; second < seconds; ++second) {
        in_real_time([&] {
            late += paced(1000, [&] {
                JointSample sample;
                stale += device->read(clock_now(), sample) == ReadStatus::ok ? 0 : 1;
                // Every order another, so that each can be told among what arrived.
                device->write(clock_now(), {1e-4 * (++order % 2000 + 1), 0, 0});
            });
        });
        in_real_time([&] { bare_late += paced(1000, [&] { bare.exchange(); }); });
    }

    int arrived = 0, last = 0, disorder = 0;
    bus.locked([&] {
        for (const MotorRequest& request : ours->requests()) {
            const int count = -request.motors[0];
            if (count == 0 || count == last) continue;
            ++arrived;
            disorder += count < last && last - count < 1900 ? 1 : 0;
            last = count;
        }
    });
    std::printf(
        "%d cycles: %d orders arrived, %d reads without a new sample, %d cycles late; bare loop: %d not done "
        "in "
        "time\n",
        cycles, arrived, stale, late, bare_late);
    EXPECT_LE(arrived, cycles);
    EXPECT_EQ(disorder, 0);
    EXPECT_GT(arrived, 0);
    RecordProperty("orders_arrived", arrived);
    RecordProperty("stale", stale);
    RecordProperty("bare_late", bare_late);
}

}  // namespace
}  // namespace knurl::drivers
