#pragma once
// knurl_bench_peers: one 256-byte message a millisecond from a servo's thread to a process that sleeps in the
// transport's own blocking wait, by Knurl's report ring and by alternatives.

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <knurl/measure/sleeper.hpp>

namespace knurl::shm::peers {

using measure::Nanoseconds, measure::now_ns;

struct Message {
    Nanoseconds sent = 0;      // CLOCK_MONOTONIC, before the call that sends it
    std::uint64_t number = 0;  // 0: only to see whether anybody listens
    std::uint64_t padding[30] = {};
};
static_assert(sizeof(Message) == 256);

/// What a receiver has seen, in memory that it shares with the sender. The sender reads of it only what was
/// sent before.
class Inbox {
  public:
    /// For messages 1 to `most`. Throws std::runtime_error.
    explicit Inbox(std::size_t most);
    ~Inbox();
    Inbox(const Inbox&) = delete;
    Inbox& operator=(const Inbox&) = delete;

    void had(const Message& message) noexcept {
        if (message.number > most_) return;
        took_[message.number].store(now_ns() - message.sent + 1, std::memory_order::release);
    }
    /// How long it took, ns; -1: it has not come.
    Nanoseconds took(std::uint64_t number) const noexcept {
        return took_[number].load(std::memory_order::acquire) - 1;
    }

    /// Where the receiver is reached, if that is its own choice.
    void announce(const std::string& address);
    /// Waits for that. Throws std::runtime_error.
    std::string announced() const;

  private:
    struct Address;
    std::size_t most_;
    void* memory_;
    Address* address_;
    std::atomic<Nanoseconds>* took_;
};

/// Constructed before the processes separate.
class Transport {
  public:
    explicit Transport(std::string name, std::string settings)
        : name_(std::move(name)), settings_(std::move(settings)) {}
    virtual ~Transport() = default;
    Transport(const Transport&) = delete;
    Transport& operator=(const Transport&) = delete;

    const std::string& name() const { return name_; }
    const std::string& settings() const { return settings_; }

    /// The receiver's process, for ever.
    virtual void receive(Inbox& inbox) = 0;
    /// The sender's process, once, when the receiver already runs. Threads created here are scheduled like
    /// the caller.
    virtual void connect(const Inbox&) {}
    virtual void send(const Message& message) = 0;

  private:
    std::string name_, settings_;
};

using Transports = std::vector<std::unique_ptr<Transport>>;
/// Who runs where; 0: not in real time.
struct Place {
    unsigned servo_cpu = 0, client_cpu = 0;
    int servo_priority = 0, waker_priority = 0, client_priority = 0;
};
void add_floors(Transports& all, const Place& place);  // eventfd, the same by a thread, UDP
void add_knurl(Transports& all, const Place& place);
void add_zeromq(Transports& all);
void add_cyclone(Transports& all);

}  // namespace knurl::shm::peers
