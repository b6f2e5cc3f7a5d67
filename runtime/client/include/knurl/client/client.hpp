#pragma once
// An application's view of Knurl.
//
//     auto client = knurl::Client::connect("knurl:default");
//     auto hand = client.claim("right");        // refused: who holds it, by pid
//     auto floor = hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = 0.0 /* m */, .stiffness = 800});
//     hand.arm();                               // force may follow
//     while (auto frame = hand.newest(50ms)) {  // or newest(0ns) when hand.fd() is readable
//         floor.follow(terrain);                // plane where the hand will be; or floor.set(...)
//         hand.commit();                        // all that changed takes effect in one cycle; "I am alive"
//     }
//
// All calls throw knurl::Error. A Claim and its handles belong to one thread at a time; in the child of a
// fork they are inert: every call throws, no destructor does anything to the parent's claim.
//
// When the servo dies the library knows within 10 ms: connected() is false, newest(), next_report() and
// latest() return nothing, fd() becomes readable once. When a servo of that name is back, everything that was
// added is added again under the same handles (ConnectOptions::reattach); force stays off until arm() is
// called again.

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <knurl/client/asset.hpp>
#include <knurl/client/error.hpp>
#include <knurl/client/predict.hpp>
#include <knurl/link/device.hpp>
#include <knurl/link/network.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/reps/limits.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl {

struct ConnectOptions {
    std::string name{};                    // what `knurl ls` shows; empty: the program's
    std::chrono::milliseconds wait{2000};  // for a servo that starts, or is full
    bool reattach = true;                  // after a restart of the servo, and add everything again
    // A line on standard error, once each, where a program forgets arm() or commit() or reads fewer reports
    // than come. KNURL_HINTS=0 in the environment switches it off as well.
    bool hints = true;
    // Of a servo on another host, "knurl://host:port":
    double report_rate = 0;  // Hz, at most, by datagrams; 0: every report
    std::string key_file{};  // one line of knurl-bridge's keys file; empty: $KNURL_KEY, or none
};

struct ClaimOptions {
    bool shared = false;                          // others may hold the device as well
    double workspace_radius = 0;                  // m, of the application's world; 0: the device's own
    Vec3 workspace_centre = {};                   // m, where the device's centre lies in that world
    std::chrono::nanoseconds update_interval{0};  // how often it means to commit; 0: measured, see commit()
    std::uint32_t representations = 128;          // at most
};

/// A report in the claim's world frame (an observer's: the device's), with what only the client knows.
struct HandReport : Report {
    std::uint64_t missed = 0;  // reports never seen by this reader, in all
    std::uint64_t unread = 0;  // newer ones that are there: a reader that falls behind sees it grow
};

/// The newest report, and what happened since the call of newest() before: also in reports that nobody read,
/// and in those that next_report() or latest() gave meanwhile. Of the first call: since the reader began.
struct HandFrame : HandReport {
    // A bit per button that went down, and that came up; in both: at least once each. Of reports that were
    // missed, or that a network thins out or loses, every second press between two that came is not known.
    std::uint32_t pressed = 0, released = 0;
    bool touched = false;       // a surface of any claim on the device was felt, though it may not be now
    std::uint32_t touches = 0;  // contacts that began
    std::uint64_t skipped = 0;  // cycles between the two frames
};

/// How late this application is, as measured by the servo.
struct Timing {
    // Of the report that a batch was computed from, when the first force made of it had been written; the
    // median of the last seven batches. 0: not measured yet.
    std::chrono::nanoseconds age_at_use{0};
    // between commits, the median of the last seven; as claimed until measured
    std::chrono::nanoseconds interval{0};
    std::uint64_t batches = 0;       // taken by the servo; those it did not take alone it had in a later one
    std::uint64_t refused = 0;       // by the servo's own check of its copy
    std::uint64_t undersampled = 0;  // calls of follow() that were too seldom for the surface's curvature
};

/// What the hand and the application's end feel of one representation.
struct HandFeedback {
    // On the hand, N and N m; the application's end feels the opposite. Of a surface while a change on its
    // probe (any surface's) is cross-faded, Feedback::fading: its share in what is faded in, from nothing to
    // all of it; what fades out is told of nobody. A simulation that is pushed by it sends `recovery = 0`, or
    // does without while the flag is set. An effect's is whole.
    Vec3 force, torque;
    Vec3 contact_point;    // m; of what is not touched: the probe, when the rest last changed
    double stiffness = 0;  // N/m applied: less than asked for if Feedback::stiffness_clamped is set
    double tangential_stiffness = 0;  // N/m of its friction, as applied; 0: it has none
    std::uint32_t flags = 0;          // Feedback::touching, ...
    // In which it was so: equal for representations felt in the same cycle. While the claim has
    // nothing within the hand's reach it stays that of the last change.
    std::uint64_t cycle = 0;
    // The share of `force` that reached the hand: the claim's gain, and less where all parts of all claims together
    // would be stiffer than the device stands (k_max).
    double share = 1;
    // The same of what velocity adds to the force: less where all parts together would damp the hand more than the
    // device stands (b_max).
    double damping_share = 1;
};

namespace detail {
class ClaimState;   // one claim: segment, channels, pending changes, replay list
class ClientState;  // one connection
class Reader;       // reports of one device
}  // namespace detail

template <Listed R>
class Handle;

/// Reads the reports of a device without holding it. Copies share one position in the stream.
class Observer {
  public:
    explicit Observer(std::shared_ptr<detail::Reader> reader);

    /// For a program that draws or computes, however often: the newest report, with all that happened to
    /// buttons and contacts since the call before. Waits until there is one that was not read. None: none
    /// came in time, or not connected.
    std::optional<HandFrame> newest(std::chrono::nanoseconds timeout);
    /// The newest report, though it may have been read already. None: before the first cycle, or not
    /// connected.
    std::optional<HandReport> latest();
    /// For a program that wants every report: the next one in order, waiting for it. Called less often than
    /// reports come it falls behind, by up to 4095 of them, before any is missed (HandReport::unread). None:
    /// none came in time, or not connected.
    std::optional<HandReport> next_report(std::chrono::nanoseconds timeout);
    /// For poll, epoll, any loop: readable while a report is there that was not read, and once when the servo
    /// has gone. One descriptor for life, also across a restart of the servo; it stays the library's: do not
    /// close it.
    int fd();
    // reports overwritten before they were read; those latest() passes over are not
    std::uint64_t missed() const;
    DeviceDescription device() const;

    /// How old a report is now: since the device was read, by the servo's clock. Throws while detached.
    Age age(const Report& report) const;
    /// What is between here and the servo; all 0 on one box. Throws while detached.
    Network network() const;

    bool connected() const;               // false: the servo is gone, and not back yet
    std::uint64_t reattachments() const;  // how often it came back

  protected:
    std::shared_ptr<detail::Reader> reader_;
};

/// The hold on a device. Its end releases the device: the force fades. Handles do not prolong it.
class Claim : public Observer {
  public:
    explicit Claim(std::shared_ptr<detail::ClaimState> state);
    Claim(Claim&&) noexcept = default;
    Claim& operator=(Claim&& other) noexcept;
    ~Claim();

    /// Adds a representation; in force from the next cycle on. Bad parameters throw here.
    template <Listed R>
    Handle<R> add(const R& params, const AddOptions& options = {}) {
        return Handle<R>(state_, add_raw(kind_of<R>, &params, sizeof params, options));
    }
    /// All commands issued inside `changes` take effect in one cycle, or none does. If `changes` throws,
    /// nothing is sent. commit() has no place inside.
    void together(const std::function<void()>& changes);

    void place_probe(std::uint32_t probe, const ProbePlacement& placement);

    /// Sends the surface of a solid, once; it is felt as Shape{.asset = sent.asset} says. Waits until the
    /// servo has it, and throws with the reason if it is refused. Meanwhile the claim is silent: to go on
    /// committing, begin_sending.
    SentShape send(const Triangles& mesh, const SendOptions& options = {});
    SentShape send(const Heights& field);
    Sending begin_sending(const Triangles& mesh, const SendOptions& options = {});
    Sending begin_sending(const Heights& field);
    /// What no representation is made of any more; its number and memory are free again.
    void forget(std::uint32_t asset);

    // These wait for the servo's answer, at most a second, and throw with the reason if it is no.
    void arm();  // force may follow
    void disarm();
    void reset_fault();  // idle, without force: arm() comes after it

    void release();  // force fades, the device is free; also done by the destructor
    /// Renews the claim and makes all changes since the last commit take effect in one cycle. An empty commit
    /// says "I am alive": a claim that says nothing is silent after max(250 ms, 3 of its intervals), and its
    /// force fades. Until three intervals were measured that is 3.5 s, unless ClaimOptions::update_interval
    /// states one. Returns the batch's number. Throws, after it has sent this batch, if the servo has
    /// refused a command or a batch since the last call (once for each; the library checks before it sends,
    /// so this means that the two disagree). Not connected, it keeps the changes for the servo's return.
    std::uint64_t commit();

    Limits limits() const;  // world units: what stiffness is clamped to
    Timing timing() const;
    /// Where the hand will be when an update computed now is half-way through its life: what follow() looks
    /// at. Its own position until the latency is known, and at most 20 mm from it.
    Vec3 predicted_position();
    /// Waits until the batch `number` (0: the newest committed) has taken effect; throws if it was refused.
    bool wait_applied(std::uint64_t number, std::chrono::nanoseconds timeout);

  private:
    RepresentationId add_raw(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
    std::shared_ptr<detail::ClaimState> state_;
};

/// A handle on one representation of a claim. Copies name the same one.
class AnyHandle {
  public:
    void remove();
    /// In the newest cycle; none before the servo has evaluated it.
    std::optional<HandFeedback> feedback() const;
    /// N/m, after clamping to what the device allows; none before the servo has answered (one cycle after
    /// add).
    std::optional<double> applied_stiffness() const;
    RepresentationId id() const { return id_; }

  protected:
    AnyHandle(std::shared_ptr<detail::ClaimState> state, RepresentationId id, Kind kind)
        : state_(std::move(state)), id_(id), kind_(kind) {}
    void set_raw(const void* params, std::size_t bytes);
    void get_raw(void* params, std::size_t bytes) const;
    Followed follow_raw(const SurfaceModel& model);

    std::shared_ptr<detail::ClaimState> state_;
    RepresentationId id_;
    Kind kind_;
};

template <Listed R>
class Handle : public AnyHandle {
  public:
    Handle(std::shared_ptr<detail::ClaimState> state, RepresentationId id)
        : AnyHandle(std::move(state), id, kind_of<R>) {}

    /// New parameters; sent with the next commit. Bad ones throw here and change nothing.
    void set(const R& params) { set_raw(&params, sizeof params); }
    R params() const {
        R r;
        get_raw(&r, sizeof r);
        return r;
    }
    /// Asks `model` for the surface where the hand will be when this update is felt, checks the answer (an
    /// unchecked prediction can push a hand through a plate) and sets it: a plane as the tangent plane, a cap
    /// with the curvatures that the model tells, too. In a concave corner it adds the other sides as
    /// representations of its own, with the same parameters, and parks them out of reach when they are not
    /// needed; they count among the claim's, and feedback() has the sum of all. Set by hand or removed, this
    /// one takes them along. What is returned says how it went; without any face: there is no report yet.
    Followed follow(const SurfaceModel& model) requires(std::same_as<R, Plane> || std::same_as<R, Cap>) {
        return follow_raw(model);
    }
};

class Client {
  public:
    /// "knurl:NAME" (or NAME): the servo of that name on this box. "knurl://HOST:PORT": the one that a
    /// knurl-bridge on another host stands before (IPv6: "knurl://[::1]:4096"). Waits for one that is still
    /// starting, then says how to start it.
    static Client connect(const std::string& address = "knurl:default", const ConnectOptions& options = {});

    std::vector<DeviceDescription> devices() const;
    Claim claim(const std::string& device = "", const ClaimOptions& options = {});  // "": the only one
    Observer observe(const std::string& device = "");
    /// Leaves the fault of a device, whoever holds it: it is idle then, and without force until who holds it
    /// calls arm() again. Throws with the reason if it is in no fault, if what led to the fault goes on, if
    /// the hand moves, and of a servo on another host (there a claim may reset it: role control).
    void reset_fault(const std::string& device = "");
    pid_t servo_pid() const;  // 0: not connected
    bool connected() const;

  private:
    explicit Client(std::shared_ptr<detail::ClientState> state);
    std::shared_ptr<detail::ClientState> state_;
};

}  // namespace knurl
