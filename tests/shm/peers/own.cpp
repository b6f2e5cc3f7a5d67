// Transports without a library: the bare wake-up, a datagram, and Knurl's ring with its two ways of waking.

#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <thread>

#include <arpa/inet.h>
#include <linux/futex.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/waiter.hpp>

#include "transport.hpp"

namespace knurl::shm::peers {

namespace {

using namespace std::chrono_literals;

/// The floor: no message, only the wake-up; the time of sending is in memory.
class Eventfd : public Transport {
  public:
    Eventfd() : Eventfd("eventfd", "write(), poll(); nothing is carried: the floor") {}
    Eventfd(std::string name, std::string settings)
        : Transport(std::move(name), std::move(settings)),
          segment_(Segment::create("knurl-bench", sizeof(Message))),
          event_(make_event()) {}
    void receive(Inbox& inbox) override {
        for (;;) {
            pollfd wait{.fd = event_.get(), .events = POLLIN, .revents = 0};
            ::poll(&wait, 1, -1);
            inbox.had(*reinterpret_cast<const Message*>(segment_.data()));
            std::uint64_t count = 0;
            [[maybe_unused]] const auto got = ::read(event_.get(), &count, sizeof count);
        }
    }
    void send(const Message& message) override {
        put(message);
        wake();
    }

  protected:
    // The call that wakes is the barrier between the two, as far as a floor needs one.
    void put(const Message& message) { std::memcpy(segment_.data(), &message, 2 * sizeof(std::uint64_t)); }
    void wake() {
        const std::uint64_t one = 1;
        [[maybe_unused]] const auto written = ::write(event_.get(), &one, sizeof one);
    }

  private:
    Segment segment_;
    UniqueFd event_;
};

/// The same through a thread on the sender's own CPU, as Knurl's waker does for several clients: the cost of
/// one futex call, and the second wake-up.
class ByThread final : public Eventfd {
  public:
    explicit ByThread(const Place& place)
        : Eventfd("eventfd, by a thread",
                  "a futex call, and a thread on the sender's CPU write()s; nothing is carried: that way's "
                  "floor"),
          place_(place) {}
    ~ByThread() override {
        if (!thread_.joinable()) return;
        stop_ = true;
        poke();
        thread_.join();
    }
    void connect(const Inbox&) override {
        thread_ = std::thread([this] {
            measure::settle_on(place_.servo_cpu, place_.waker_priority);
            for (std::uint32_t seen = 0; !stop_; seen = word_) {
                ::syscall(SYS_futex, &word_, FUTEX_WAIT_PRIVATE, seen, nullptr, nullptr, 0);
                wake();
            }
        });
    }
    void send(const Message& message) override {
        put(message);
        poke();
    }

  private:
    void poke() {
        ++word_;
        ::syscall(SYS_futex, &word_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
    }

    Place place_;
    std::atomic<std::uint32_t> word_{0};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

class Udp final : public Transport {
  public:
    Udp() : Transport("UDP", "127.0.0.1, connected, send(), blocking recv()") {
        out_ = UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        in_ = UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = ::htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* const any = reinterpret_cast<sockaddr*>(&address);
        if (::bind(in_.get(), any, size) != 0 || ::getsockname(in_.get(), any, &size) != 0 ||
            ::connect(out_.get(), any, size) != 0)
            throw std::runtime_error(std::string("UDP on loopback: ") + std::strerror(errno));
    }
    void receive(Inbox& inbox) override {
        for (Message message;;)
            if (::recv(in_.get(), &message, sizeof message, 0) == sizeof message) inbox.had(message);
    }
    void send(const Message& message) override {
        [[maybe_unused]] const auto sent = ::send(out_.get(), &message, sizeof message, 0);
    }

  private:
    UniqueFd in_, out_;
};

/// A client's segment and the device's, as in knurld.
class ReportRing final : public Transport {
  public:
    /// knurld wakes a single waiting client itself, if it belongs to its own user; the waker wakes all
    /// others.
    enum class WokenBy { servo, waker };
    ReportRing(WokenBy by, const Place& place, Waits waits = Waits::on_flag)
        : Transport(waits == Waits::on_socket ? "Knurl, descriptor"
                    : by == WokenBy::servo    ? "Knurl"
                                              : "Knurl, waker",
                    waits == Waits::on_socket
                        ? "report ring; the client poll()s its socket, to which the waker's thread writes"
                    : by == WokenBy::servo
                        ? "report ring; the servo itself wakes the one client"
                        : "report ring; the servo pokes its waker's thread, as for several clients"),
          by_(by),
          waits_(waits),
          place_(place) {
        broadcast_init(segment_.data() + sizeof(WaiterFlag));
        waker_.add(sleeper());
    }
    ~ReportRing() override {
        if (!thread_.joinable()) return;
        waker_.stop();
        thread_.join();
    }
    void receive(Inbox& inbox) override {
        BroadcastReader reader(segment_.data() + sizeof(WaiterFlag), slots, sizeof(Message), 0);
        Waiter waiter(flag(), wake_.client.get(), reader);
        if (waits_ == Waits::on_socket) {
            for (Message message;;) {
                while (!waiter.rearm())
                    while (reader.next(&message)) inbox.had(message);
                pollfd event{.fd = waiter.fd(), .events = POLLIN, .revents = 0};
                ::poll(&event, 1, 1000);
                while (reader.next(&message)) inbox.had(message);
            }
        }
        for (Message message;;)
            if (waiter.wait(1s))
                while (reader.next(&message)) inbox.had(message);
    }
    void connect(const Inbox&) override {
        thread_ = std::thread([this] {
            measure::settle_on(place_.servo_cpu, place_.waker_priority);
            waker_.run();
        });
    }
    void send(const Message& message) override {
        writer_.publish(&message);
        const WakeTarget one[] = {sleeper()};
        waker_.wake(one);
    }

  private:
    static constexpr std::uint32_t slots = 4096;
    WaiterFlag* flag() { return reinterpret_cast<WaiterFlag*>(segment_.data()); }
    WakeTarget sleeper() {
        return {.flag = flag(), .wake_fd = wake_.servo.get(), .trusted = by_ == WokenBy::servo};
    }

    WokenBy by_;
    Waits waits_;
    Place place_;
    Segment segment_ =
        Segment::create("knurl-bench", sizeof(WaiterFlag) + broadcast_bytes(slots, sizeof(Message)));
    WakePair wake_ = make_wake_pair();
    BroadcastWriter writer_{segment_.data() + sizeof(WaiterFlag), slots, sizeof(Message)};
    Waker waker_;
    std::thread thread_;
};

}  // namespace

void add_floors(Transports& all, const Place& place) {
    all.push_back(std::make_unique<Eventfd>());
    all.push_back(std::make_unique<ByThread>(place));
    all.push_back(std::make_unique<Udp>());
}

void add_knurl(Transports& all, const Place& place) {
    all.push_back(std::make_unique<ReportRing>(ReportRing::WokenBy::servo, place));
    all.push_back(std::make_unique<ReportRing>(ReportRing::WokenBy::waker, place));
    all.push_back(std::make_unique<ReportRing>(ReportRing::WokenBy::waker, place, Waits::on_socket));
}

}  // namespace knurl::shm::peers
