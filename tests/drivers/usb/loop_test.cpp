// 1 kHz with a hand that moves, the driver and the plainest loop over libusb side by side: no frame of the
// bus goes without a new order, or without a new sample, that the bare loop would have made. Frames pass when
// both have done all that they can do in one, so that the figures are the bus's and not this machine's; now
// and then both devices take no packet for some frames. The long form: KNURL_USB_SECONDS=60 (scripts/usb), of
// the bus's clock.

#include <cstdlib>
#include <ctime>
#include <random>

#include <libusb.h>

#include "falcon_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

constexpr std::uint8_t in = 0x81, out = 0x02;

Nanoseconds clock_now() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

/// Writes 16 bytes, reads until as many have come back, and again: no thread, no parser, nothing to spare.
class BareLoop {
  public:
    BareLoop(const std::string& port, bool event_character) {
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
        for (const auto& [request, value] : {std::pair{9, 1}, {3, 2}, {6, event_character ? 0x013E : 0}})
            libusb_control_transfer(handle_, 0x40, static_cast<std::uint8_t>(request),
                                    static_cast<std::uint16_t>(value), 0, nullptr, 0, 100);
        libusb_fill_bulk_transfer(
            writing_, handle_, out, request_, 16, [](auto) {}, this, 0);
        libusb_fill_bulk_transfer(reading_, handle_, in, heard_, sizeof heard_, on_heard, this, 0);
    }
    ~BareLoop() {
        for (libusb_transfer* transfer : {reading_, writing_}) libusb_cancel_transfer(transfer);
        timeval at_once{.tv_sec = 0, .tv_usec = 100'000};
        libusb_handle_events_timeout_completed(context_, &at_once, nullptr);
        for (libusb_transfer* transfer : {reading_, writing_}) libusb_free_transfer(transfer);
        libusb_release_interface(handle_, 0);
        libusb_close(handle_);
        libusb_exit(context_);
    }
    BareLoop(const BareLoop&) = delete;
    BareLoop& operator=(const BareLoop&) = delete;

    /// Begins an exchange if the one before is over. True: one has come to its end since the last call.
    bool cycle() {
        see_to_it();
        const bool sample = answered_ == 16;
        if (!begun_ || sample) {
            begun_ = true;
            answered_ = 0;
            libusb_submit_transfer(writing_);
            libusb_submit_transfer(reading_);
        }
        see_to_it();
        return sample;
    }

  private:
    static void on_heard(libusb_transfer* transfer) {
        BareLoop& self = *static_cast<BareLoop*>(transfer->user_data);
        if (transfer->status != LIBUSB_TRANSFER_COMPLETED) return;
        self.answered_ += std::max(transfer->actual_length - 2, 0);
        if (self.answered_ < 16) libusb_submit_transfer(transfer);
    }
    /// The bus serves a request within the call that submits it, if at all before the next frame.
    void see_to_it() {
        timeval none{};
        for (int before = -1; before != answered_;) {
            before = answered_;
            libusb_handle_events_timeout_completed(context_, &none, nullptr);
        }
    }

    libusb_context* context_ = nullptr;
    libusb_device_handle* handle_ = nullptr;
    libusb_transfer *writing_ = libusb_alloc_transfer(0), *reading_ = libusb_alloc_transfer(0);
    std::uint8_t request_[17] = "<AAAAAAAAAAAAAA>", heard_[64] = {};
    int answered_ = 0;  // bytes of this exchange
    bool begun_ = false;
};

/// Frames that went without.
struct Missed {
    int samples = 0, orders = 0;
};

class AtOneKilohertz : public testing::TestWithParam<bool> {
  protected:
    static constexpr int warm_up = 10;  // frames before it counts: the driver has read at its start already

    AtOneKilohertz() {
        ours_->hand = [](double t) { return legs_at(circling(t)); };
        bus_.plug(ours_, {.port = "1-1", .serial = "OURS"});
        bus_.plug(theirs_, {.port = "1-2", .serial = "THEIRS"});
    }

    /// The number of the newest order that has arrived; each has another number of counts.
    int arrived() {
        const std::vector<MotorRequest>& requests = ours_->requests();
        for (; looked_at_ < requests.size(); ++looked_at_) {
            const int count = -requests[looked_at_].motors[0];
            if (count == 0) {  // the I/O thread's own: this machine stood still for 10 ms
                disturbed_ = 4;
                continue;
            }
            const int number = last_ + (count - 1 - last_ % most + most) % most;
            twice_ += number == last_ ? 1 : 0;
            last_ = number;
        }
        return last_;
    }
    JointEfforts order(int number) { return {1e-4 * (number % most + 1), 0, 0}; }
    /// The driver has taken what there was, and asks for more.
    bool waits() { return bus_.waiting_at("1-1", in) == 3; }

    static constexpr int most = 2000;
    Bus bus_;
    std::shared_ptr<Falcon> ours_ = falcon_at_centre(), theirs_ = falcon_at_centre();
    std::size_t looked_at_ = 0;
    int last_ = -1, twice_ = 0;
    int disturbed_ = 0;  // frames that count for neither, from now
};

TEST_P(AtOneKilohertz, TheDriverMissesNoTransferThatABareLoopWouldHaveMade) {
    const bool event_character = GetParam();
    const char* asked = std::getenv("KNURL_USB_SECONDS");
    const int frames = 1000 * (asked != nullptr ? std::atoi(asked) : 2);
    const unsigned seed = 20260123;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto device =
        open_device(std::string("falcon:OURS,low_pass=0,event_char=") + (event_character ? "on" : "off"),
                    {.hand_file = "", .seed = 1, .io_priority = 56});
    BareLoop bare("1-2", event_character);

    Missed missed, bare_missed;
    double worst = 0;  // rad, of a sample against the leg
    int stuck_for = 0, stuck = 0, compared = 0;
    std::array<double, 3> answered{};  // legs when the last order arrived
    bool fresh = false;
    bus_.hold_clock(true);
    for (int k = 0; k < frames + warm_up; ++k) {
        const bool counts = k >= warm_up && disturbed_ == 0;
        disturbed_ = std::max(disturbed_ - 1, 0);
        compared += counts ? 1 : 0;
        // Before the first read the I/O thread sleeps.
        ASSERT_TRUE(bus_.settles([&] { return k == 0 || waits(); })) << "frame " << k;
        JointSample sample;
        const bool read = device->read(clock_now(), sample) == ReadStatus::ok;
        double off = 0;
        for (std::size_t leg = 0; read && fresh && leg < 3; ++leg)
            off = std::max(off, std::abs(sample.position[leg] - answered[leg]));
        device->write(clock_now(), order(k));
        const std::size_t before = bus_.locked([&] { return theirs_->requests().size(); });
        const bool bare_read = bare.cycle();
        // Until the order is there or, where none is taken, the packet waits for it: two do at most.
        const std::size_t on_their_way = static_cast<std::size_t>(std::min(stuck, 2));
        ASSERT_TRUE(bus_.settles([&] {
            return waits() && (stuck > 0 ? bus_.waiting_at("1-1", out) >= on_their_way : arrived() == k);
        })) << "order "
            << k << " never came";
        bus_.locked([&] {
            fresh = arrived() == k;
            if (counts && disturbed_ == 0) worst = std::max(worst, off);
            answered = ours_->legs();
            missed.orders += counts && !fresh ? 1 : 0;
            bare_missed.orders += counts && theirs_->requests().size() == before ? 1 : 0;
            missed.samples += counts && !read ? 1 : 0;
            bare_missed.samples += counts && !bare_read ? 1 : 0;
            // In one frame of a hundred it begins: neither device takes a packet, for one to three.
            stuck_for = stuck_for > 0         ? stuck_for - 1
                        : random() % 100 == 0 ? 1 + static_cast<int>(random() % 3)
                                              : 0;
            stuck = stuck_for > 0 ? stuck + 1 : 0;
            ours_->faults.stuck = theirs_->faults.stuck = stuck > 0;
        });
        bus_.tick();
    }
    bus_.locked([&] { ours_->faults.stuck = theirs_->faults.stuck = false; });
    bus_.hold_clock(false);

    std::printf("%d frames: without a new order %d (bare loop %d), without a new sample %d (bare loop %d)\n",
                compared, missed.orders, bare_missed.orders, missed.samples, bare_missed.samples);
    EXPECT_LE(missed.orders, bare_missed.orders);
    EXPECT_LE(missed.samples, bare_missed.samples);
    EXPECT_LT(bare_missed.orders, compared / 10) << "the bare loop ran";
    EXPECT_EQ(twice_, 0) << "orders that arrived more than once";
    EXPECT_LT(worst, 0.6 * falcon_radians_per_count) << "of the frame in which it was asked for";
    RecordProperty("orders_missed", missed.orders);
    RecordProperty("bare_orders_missed", bare_missed.orders);
    RecordProperty("samples_missed", missed.samples);
    RecordProperty("bare_samples_missed", bare_missed.samples);
}

INSTANTIATE_TEST_SUITE_P(Falcon, AtOneKilohertz, testing::Bool(),
                         [](const auto& of) { return of.param ? "EventCharacter" : "LatencyTimer"; });

}  // namespace
}  // namespace knurl::drivers
