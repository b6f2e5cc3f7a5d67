// In the steady state no message allocates: not in the bridge, not in the library.

#include <thread>

#include <sys/eventfd.h>

#include "net_allocations.hpp"
#include "relay.hpp"
#include "relay_support.hpp"

namespace knurl::bridge::test {
namespace {

/// A bridge in this process, so that its allocations can be counted.
class OwnRelay {
  public:
    explicit OwnRelay(std::vector<Key> keys)
        : relay_({.servo = "default", .listen = resolve_all("127.0.0.1:0"), .keys = std::move(keys)}),
          thread_([this] { relay_.run(stop_.get()); }) {}
    ~OwnRelay() {
        const std::uint64_t one = 1;
        [[maybe_unused]] const ssize_t written = ::write(stop_.get(), &one, sizeof one);
        thread_.join();
    }
    std::string address() const { return "knurl://" + relay_.listening_at(); }

  private:
    shm::UniqueFd stop_{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
    Relay relay_;
    std::thread thread_;
};

void expect_no_allocation(const std::string& key_file, std::vector<Key> keys) {
    ServoProcess servo({"--device", "sim:cartesian3", "--rate", "2000"});
    Client::connect("knurl:default", {.wait = 20s});
    OwnRelay relay(std::move(keys));
    Client client = Client::connect(relay.address(), {.wait = 10s, .key_file = key_file});
    Claim hand = client.claim();
    auto force = hand.add(at_once({}));
    auto other = hand.add(at_once({}));
    const auto work = [&](int cycles) {
        for (int i = 0; i < cycles; ++i) {
            const auto report = hand.next_report(10s);
            ASSERT_TRUE(report);
            force.set(at_once({1e-4 * (i % 100), 0, 0}));
            if (i % 3 == 0) other.set(at_once({0, 1e-4 * (i % 70), 0}));
            hand.commit();
            ASSERT_TRUE(force.feedback() || i < 100);
        }
    };
    work(500);
    const std::uint64_t before = allocations() + openssl_allocations();
    ASSERT_GT(before, 0u) << "they are counted";
    work(1000);
    EXPECT_EQ(allocations() + openssl_allocations() - before, 0u);
}

TEST(Steady, no_message_allocates) {
    expect_no_allocation({}, {});
}

TEST(Steady, no_sealed_message_allocates) {
    KeyRing ring;
    const std::string key = ring.add("anna", Role::control);
    expect_no_allocation(key, read_keys(ring.file()));
}

}  // namespace
}  // namespace knurl::bridge::test
