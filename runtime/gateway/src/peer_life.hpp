#pragma once
// What is done with a peer's commands and when: the whole life of a PeerHand but for its thread. It asks no clock and
// knows no servo, so that tests play both. Private to this module.

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <knurl/gateway/peer_hand.hpp>
#include <knurl/protocol/report.hpp>

namespace knurl::gateway {

using TimePoint = std::chrono::steady_clock::time_point;

/// A force and a torque.
struct Push {
    Vec3 force;
    Vec3 torque;
    friend bool operator==(const Push&, const Push&) = default;
    bool is_nothing() const { return *this == Push{}; }
};

/// One change to the peer's representations.
struct ItemChange {
    enum class What { add, set, remove };
    What what = What::add;
    std::string name;
    Kind kind = 0;
    std::vector<std::byte> params;
    AddOptions options;
    std::shared_ptr<const PeerMesh> mesh{};  // of an `add`: a Shape is made of it
};

/// What the peer has said since it was taken last.
struct Orders {
    std::optional<Push> push;
    std::optional<Vec3> target;
    std::deque<ItemChange> changes;
    bool alive = false;
    TimePoint at{};  // of the last message
};

/// What is known of the device and of the hold on it.
struct Seen {
    bool connected = false;
    std::uint64_t servos = 0;  // changes with each servo that came in place of another
    DeviceState state = DeviceState::disconnected;
    std::uint32_t faults = 0;
    std::optional<Vec3> position;
};

/// The claim. All but `close` throw knurl::Error.
class PeerPort {
  public:
    virtual ~PeerPort() = default;
    virtual void open() = 0;
    virtual void close() noexcept = 0;
    virtual Seen look() = 0;
    virtual void arm() = 0;
    /// Its change reaches the hand over `fade` (s); negative: as soon as changes of this rate can.
    virtual void push(const Push& push, double fade) = 0;
    /// The spring's end moves from where it is (at first: from `from`) to there in so many seconds.
    virtual void pull(const Vec3& from, const Vec3& to, double duration) = 0;
    virtual void let_go() = 0;
    virtual void change(const ItemChange& change) = 0;
    /// Meshes are on their way to the servo: come again soon.
    virtual bool busy() const { return false; }
    /// Places those that have arrived; true: there were some.
    virtual bool progress() { return false; }
    virtual void commit() = 0;
    virtual std::map<std::string, PeerFeedback> feedback() = 0;
};

/// One step at a time.
class PeerLife {
  public:
    PeerLife(PeerPort& port, const PeerOptions& options) : port_(port), options_(options) {}

    /// Does what is to be done now. Returns when to come again if nothing is said meanwhile; none: never.
    std::optional<TimePoint> step(TimePoint now, Orders orders);
    /// Releases.
    void end() noexcept;

    const PeerStatus& status() const { return status_; }
    std::vector<Said> said() { return std::exchange(said_, {}); }

  private:
    /// Something that the peer commands anew again and again, or else it lapses.
    template <class T>
    struct Held {
        std::optional<T> value;
        TimePoint at{};
        bool lapsed(TimePoint now, std::chrono::nanoseconds after) const {
            return value && now >= at + after;
        }
    };

    void take(TimePoint now, Orders& orders);
    bool want() const { return push_.value.has_value() || target_.value.has_value() || !items_.empty(); }
    bool open(TimePoint now);
    bool look(TimePoint now);
    void apply(bool alive);
    void lapse(TimePoint now);
    void arm(TimePoint now);
    void close();
    std::optional<TimePoint> next(TimePoint now) const;
    /// Says it, unless it was said last about this subject.
    void say(const std::string& subject, Said::Level level, const std::string& text);
    /// What was said about it is over.
    void over(const std::string& subject) { last_said_.erase(subject); }

    PeerPort& port_;
    const PeerOptions& options_;
    PeerStatus status_;
    std::vector<Said> said_;
    std::map<std::string, std::string> last_said_;

    bool open_ = false;
    bool connected_ = false;
    bool fault_ = false;
    std::uint64_t servos_ = 0;
    std::optional<Vec3> hand_;
    TimePoint heard_{};     // the last command
    TimePoint try_open_{};  // not before
    TimePoint try_arm_{};
    Held<Push> push_;
    Held<Vec3> target_;
    std::optional<Push> pushed_;  // as the servo was told
    std::optional<Vec3> pulled_;
    std::map<std::string, ItemChange> items_;  // as they should be: replayed when the device is claimed anew
    std::deque<ItemChange> changes_;           // not told yet
};

}  // namespace knurl::gateway
