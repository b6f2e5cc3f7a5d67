// 1 kHz with turning encoders, the driver and a minimal loop over libusb side by side. In every frame the
// driver must have a new order and a new sample where the minimal loop has them. A frame passes when both
// have done all they can in it, so the figures belong to the bus and not to this machine. At times both
// devices accept no packet for some frames. The long form: KNURL_USB_SECONDS=60 (scripts/usb), of the bus's
// clock.

#include <cstdlib>
#include <ctime>
#include <random>

#include <libusb.h>

#include "motor_bench.hpp"

namespace knurl::drivers {
namespace {

using namespace usb_emulator;

Nanoseconds clock_now() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

/// How a program without this library would use a device.
struct Cable {
    const char* name;
    const MotorDevice& device;
    const char* options;                        // appended to the driver's address
    std::vector<std::pair<int, int>> controls;  // vendor requests and their values, before anything else
    std::vector<std::uint8_t> request;          // zero
    int status_bytes, reply_bytes;              // of each packet; of all packets of a reply without them
    bool answers;                               // it sends only in answer to a packet; else in every frame
};
std::ostream& operator<<(std::ostream& text, const Cable& cable) {
    return text << cable.name;
}

Cable ftdi(const char* name, bool event_character) {
    constexpr std::string_view zero = "<AAAAAAAAAAAAAA>";
    return {.name = name,
            .device = falcon_device,
            .options = event_character ? ",event_char=on" : ",event_char=off",
            .controls = {{9, 1}, {3, 2}, {6, event_character ? 0x013E : 0}},
            .request = {zero.begin(), zero.end()},
            .status_bytes = 2,
            .reply_bytes = 16,
            .answers = true};
}
Cable raw_hid() {
    return {.name = "Wooden",
            .device = wooden_device,
            .options = "",
            .controls = {},
            .request = std::vector<std::uint8_t>(64),
            .status_bytes = 0,
            .reply_bytes = 64,
            .answers = false};
}

/// Writes a packet, reads until the reply has come, and repeats: no thread, no parser, minimal work. If the
/// device sends by itself, neither direction waits for the other.
class BareLoop {
  public:
    BareLoop(const std::string& port, const Cable& cable, const Identity& identity)
        : cable_(cable), request_(cable.request) {
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
        for (const auto& [request, value] : cable.controls)
            libusb_control_transfer(handle_, 0x40, static_cast<std::uint8_t>(request),
                                    static_cast<std::uint16_t>(value), 0, nullptr, 0, 100);
        const auto fill =
            identity.interrupt_endpoints ? libusb_fill_interrupt_transfer : libusb_fill_bulk_transfer;
        fill(writing_, handle_, identity.endpoints[1], request_.data(), static_cast<int>(request_.size()),
             on_written, this, 0);
        fill(reading_, handle_, identity.endpoints[0], heard_, sizeof heard_, on_heard, this, 0);
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
        const bool sample = answered_ >= cable_.reply_bytes, next = sample || !begun_;
        if (!in_flight_ && (next || !cable_.answers)) {
            in_flight_ = libusb_submit_transfer(writing_) == 0;
            ++written_;
        }
        if (next) {
            answered_ = 0;
            libusb_submit_transfer(reading_);
        }
        begun_ = true;
        see_to_it();
        return sample;
    }
    std::size_t written() const { return written_; }

  private:
    static void on_written(libusb_transfer* transfer) {
        static_cast<BareLoop*>(transfer->user_data)->in_flight_ = false;
    }
    static void on_heard(libusb_transfer* transfer) {
        BareLoop& self = *static_cast<BareLoop*>(transfer->user_data);
        if (transfer->status != LIBUSB_TRANSFER_COMPLETED) return;
        self.answered_ += std::max(transfer->actual_length - self.cable_.status_bytes, 0);
        if (self.answered_ < self.cable_.reply_bytes) libusb_submit_transfer(transfer);
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
    const Cable& cable_;
    std::vector<std::uint8_t> request_;
    std::uint8_t heard_[64] = {};
    int answered_ = 0;  // bytes of this exchange
    bool begun_ = false, in_flight_ = false;
    std::size_t written_ = 0;
};

/// Frames without an order or sample, and how many frames before its end the newest arrived order was
/// written: their sum.
struct Missed {
    int samples = 0, orders = 0;
    double late = 0;
};

class AtOneKilohertz : public testing::TestWithParam<Cable> {
  protected:
    static constexpr int warm_up = 10;  // frames before it counts: the driver has read at its start already

    AtOneKilohertz() {
        plug_in(bus_, GetParam().device, ours_, "1-1", "ONE");
        plug_in(bus_, GetParam().device, theirs_, "1-2", "THEIRS");
    }

    // The following with the bus locked.

    /// The number of the newest order that has arrived; each has another size.
    int arrived() {
        const std::vector<MotorRequest>& requests = ours_->requests();
        for (; looked_at_ < requests.size(); ++looked_at_) {
            const int size = std::abs(requests[looked_at_].motors[0]);
            if (size == 0) {  // the I/O thread's own: this machine stood still for 10 ms
                disturbed_ = 4;
                continue;
            }
            const int number = last_ + (size - 1 - last_ % most + most) % most;
            twice_ += number == last_ ? 1 : 0;
            last_ = number;
        }
        return last_;
    }
    /// The driver has taken what there was, and asks for more.
    bool waits() { return bus_.waiting_at("1-1", ours_->identity().endpoints[0]) == kept_for_samples; }
    std::size_t on_their_way() { return bus_.waiting_at("1-1", ours_->identity().endpoints[1]); }
    /// Packets that the driver has sent, whether they have arrived or not.
    std::size_t sent() { return ours_->requests().size() + on_their_way(); }

    JointEfforts order(int number) const {
        constexpr double much = 1000;  // N m, against rounding
        return {(number % most + 1) * much / std::abs(GetParam().device.all(much)[0]), 0, 0};
    }

    static constexpr int most = 2000;
    Bus bus_;
    std::shared_ptr<MotorModel> ours_ = GetParam().device.make(), theirs_ = GetParam().device.make();
    std::size_t looked_at_ = 0;
    int last_ = -1, twice_ = 0;
    int disturbed_ = 0;  // frames that count for neither, from now
};

TEST_P(AtOneKilohertz, TheDriverMissesNoTransferThatABareLoopWouldHaveMade) {
    const Cable& cable = GetParam();
    const char* asked = std::getenv("KNURL_USB_SECONDS");
    const int frames = 1000 * (asked != nullptr ? std::atoi(asked) : 2);
    const unsigned seed = 20260123;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto device = open_device(std::string(cable.device.address) + cable.options,
                                    {.hand_file = "", .seed = 1, .io_priority = 56});
    BareLoop bare("1-2", cable, theirs_->identity());

    Missed missed, bare_missed;
    double worst = 0;  // rad, of a sample against the encoder
    int stuck_for = 0, compared = 0;
    int turned = 0, shown = 0;  // counts, since the beginning: by now, and as the next sample is to say
    JointSample first;
    bool fresh = false, owed = false;
    std::size_t sent_before = 0, bare_before = 0;
    int newest_before = -1;
    std::vector<int> bare_orders;  // in which frame each was written
    bus_.hold_clock(true);
    for (int k = 0; compared < frames; ++k) {
        ASSERT_LT(k, 4 * frames + warm_up) << "only " << compared << " frames were undisturbed: the machine "
                                           << "stands still too often, or the driver sends zeros by itself";
        const bool undisturbed = k >= warm_up && disturbed_ == 0;
        disturbed_ = std::max(disturbed_ - 1, 0);
        // Before the first read the I/O thread sleeps. What could not be sent goes when a
        // packet was taken, or never: where there is one, the next order takes its place.
        const auto taken_up = [&] {
            return sent() > sent_before || on_their_way() == kept_of_efforts(*ours_);
        };
        ASSERT_TRUE(bus_.settles([&] { return k == 0 || (waits() && (!owed || taken_up())); }))
            << "frame " << k;
        JointSample sample;
        const bool read = device->read(clock_now(), sample) == ReadStatus::ok;
        if (k == 0) first = sample;
        double off = 0;
        for (std::size_t axis = 0; read && fresh && axis < 3; ++axis)
            off = std::max(off, std::abs(sample.position[axis] - first.position[axis] -
                                         shown * device->link().radians_per_count[axis]));
        sent_before = bus_.locked([&] { return sent(); });
        device->write(clock_now(), order(k));
        const bool bare_read = bare.cycle();
        bare_orders.resize(bare.written(), k);
        // Until the order is there, or waits for the device, or for those that wait.
        ASSERT_TRUE(bus_.settles([&] {
            return waits() && taken_up() && (!cable.answers || ours_->faults.stuck || arrived() == k);
        })) << "order "
            << k << " never came";
        bus_.locked([&] {
            const bool news = arrived() > newest_before;
            newest_before = last_;
            fresh = !cable.answers || last_ == k;
            owed = kept_of_efforts(*ours_) > 1 && sent() == sent_before;
            const bool counts = undisturbed && disturbed_ == 0;
            compared += counts ? 1 : 0;
            missed.late += counts ? k - last_ : 0;
            bare_missed.late += counts ? k - bare_orders[theirs_->requests().size() - 1] : 0;
            if (counts) worst = std::max(worst, off);
            missed.orders += counts && !news ? 1 : 0;
            bare_missed.orders += counts && theirs_->requests().size() == bare_before ? 1 : 0;
            missed.samples += counts && !read ? 1 : 0;
            bare_missed.samples += counts && !bare_read ? 1 : 0;
            sent_before = sent();
            bare_before = theirs_->requests().size();
            // In one frame of a hundred it begins: neither device takes a packet, for one to three.
            stuck_for = stuck_for > 0         ? stuck_for - 1
                        : random() % 100 == 0 ? 1 + static_cast<int>(random() % 3)
                                              : 0;
            ours_->faults.stuck = theirs_->faults.stuck = stuck_for > 0;
            // A device that answers orders sends a sample in the frame of its order.
            if (cable.answers) shown = turned;
            const int by = k / 500 % 2 == 0 ? 2 : -2;
            for (std::size_t axis = 0; axis < 3; ++axis) ours_->slip(axis, by);
            turned += by;
            if (!cable.answers) shown = turned;
        });
        bus_.tick();
    }
    bus_.locked([&] { ours_->faults.stuck = theirs_->faults.stuck = false; });
    bus_.hold_clock(false);

    std::printf(
        "%s, %d frames: without a new order %d (bare loop %d), without a new sample %d (bare loop %d), "
        "orders %.2f frames late on average (bare loop %.2f)\n",
        cable.name, compared, missed.orders, bare_missed.orders, missed.samples, bare_missed.samples,
        missed.late / compared, bare_missed.late / compared);
    EXPECT_LE(missed.orders, bare_missed.orders);
    EXPECT_LE(missed.samples, bare_missed.samples);
    // A standstill of the machine during an order of one of the two costs a frame or two in total.
    EXPECT_LE(missed.late / compared, bare_missed.late / compared + 0.01);
    EXPECT_LT(bare_missed.orders, compared / 10) << "the bare loop ran";
    EXPECT_EQ(twice_, 0) << "orders that arrived more than once";
    EXPECT_LT(worst, 1e-9) << "of the frame in which it was asked for";
    RecordProperty("orders_missed", missed.orders);
    RecordProperty("bare_orders_missed", bare_missed.orders);
    RecordProperty("samples_missed", missed.samples);
    RecordProperty("bare_samples_missed", bare_missed.samples);
}

INSTANTIATE_TEST_SUITE_P(Devices, AtOneKilohertz,
                         testing::Values(ftdi("FalconLatencyTimer", false),
                                         ftdi("FalconEventCharacter", true), raw_hid()),
                         [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace knurl::drivers
