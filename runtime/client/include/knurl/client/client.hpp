#pragma once

/// @file
/// An application's view of Knurl.
///
///     auto client = knurl::Client::connect("knurl:default");
///     auto hand = client.claim("right");        // refused: who holds it, by pid
///     auto floor = hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = 0.0 /* m */, .stiffness = 800});
///     hand.arm();                               // force may follow
///     while (auto frame = hand.newest(50ms)) {  // or newest(0ns) when hand.fd() is readable
///         floor.follow(terrain);                // plane where the hand will be; or floor.set(...)
///         hand.commit();                        // all that changed takes effect in one cycle; "I am alive"
///     }
///
/// Planes and caps come with this header. Every other representation has one of its own: <knurl/reps/spring.hpp>, or
/// <knurl/reps/all.hpp> for all of them.
///
/// All calls throw knurl::Error. A Claim and its handles belong to one thread at a time; in the child of a
/// fork they are inert: every call throws, no destructor does anything to the parent's claim.
///
/// When the servo dies the library knows within 10 ms: connected() is false, newest(), next_report() and
/// latest() return nothing, fd() becomes readable once. When a servo of that name is back, everything that
/// was added is added again under the same handles (ConnectOptions::reattach); force stays off until arm() is
/// called again.

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <knurl/client/asset.hpp>
#include <knurl/client/error.hpp>
#include <knurl/client/predict.hpp>
#include <knurl/link/device.hpp>
#include <knurl/link/network.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/reps/limits.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl {

/// How Client::connect connects.
struct ConnectOptions {
    /// Name that `knurl ls` shows; empty: the program's.
    std::string name{};
    /// How long to wait for a servo that starts, or is full.
    std::chrono::milliseconds wait{2000};
    /// After a restart of the servo: attach, and add everything again.
    bool reattach = true;
    /// Print a line on standard error, once each, where a program forgets arm() or commit(), or reads fewer
    /// reports than come. KNURL_HINTS=0 in the environment switches it off as well.
    bool hints = true;
    /// Of a servo on another host ("knurl://host:port"): largest rate of reports (Hz), sent by datagrams; 0:
    /// every report.
    double report_rate = 0;
    /// Of a servo on another host: path of a file with one line of knurl-bridge's keys file; empty:
    /// $KNURL_KEY, or no key.
    std::string key_file{};
};

/// What Client::claim requests.
struct ClaimOptions {
    /// True: others may hold the device as well, if they say so too.
    bool shared = false;
    /// Radius of the workspace in the application's world (m); 0: the device's own, scale 1.
    double workspace_radius = 0;
    /// Where the centre of the device's workspace lies in the application's world (m).
    Vec3 workspace_centre = {};
    /// How often the application means to commit; 0: measured, see Claim::commit.
    std::chrono::nanoseconds update_interval{0};
    /// Most representations at once, 1 to 1024.
    std::uint32_t representations = 128;
};

/// A report in the claim's world frame (an observer's: the device's), with what only the client knows.
struct HandReport : Report {
    /// Reports that this reader never saw, in all.
    std::uint64_t missed = 0;
    /// Newer reports that are there. It grows for a reader that falls behind.
    std::uint64_t unread = 0;
};

/// The newest report, and what happened since the call of newest() before: also in reports that nobody read,
/// and in those that next_report() or latest() gave meanwhile. In the first frame: since the reader began.
struct HandFrame : HandReport {
    /// A bit for each button that went down at least once. Where reports are missed, or a network thins them
    /// out or loses them, an even number of presses between two reports that came is not seen.
    std::uint32_t pressed = 0;
    /// A bit for each button that came up at least once; see `pressed`.
    std::uint32_t released = 0;
    /// The hand touched a surface of any claim on the device, though it may not touch it now.
    bool touched = false;
    /// Number of contacts that began.
    std::uint32_t touches = 0;
    /// Cycles between the two frames.
    std::uint64_t skipped = 0;
};

/// How late this application is, as measured by the servo.
struct Timing {
    /// Age of a report when the first force that was computed from its answer had been written; the median of
    /// the last seven batches. 0: not measured yet.
    std::chrono::nanoseconds age_at_use{0};
    /// Time between commits, the median of the last seven; until it is measured, the claimed one.
    std::chrono::nanoseconds interval{0};
    /// Batches that the servo has taken. A skipped batch was merged into a later one.
    std::uint64_t batches = 0;
    /// Batches that the servo refused by its own check.
    std::uint64_t refused = 0;
    /// Calls of follow() that were too seldom for the surface's curvature.
    std::uint64_t undersampled = 0;
};

/// Feedback of one representation: what it does to the hand. The application's end feels the opposite.
struct HandFeedback {
    /// Force on the hand (N), world frame. While a change of any surface on the probe is cross-faded
    /// (Feedback::fading), a surface's force is its share in the new set, which grows from nothing to all of
    /// it; what fades out is in no representation's feedback. A simulation that this force pushes sends
    /// `recovery = 0`, or ignores the force while the flag is set. An effect's force is always whole.
    Vec3 force;
    /// Torque on the hand (N m), about the probe's position; as `force`.
    Vec3 torque;
    /// Contact point (m), world frame. Where it is not touched: the probe's position at the last change of
    /// the other fields.
    Vec3 contact_point;
    /// Stiffness as applied (N/m): less than was set if Feedback::stiffness_clamped is set.
    double stiffness = 0;
    /// Stiffness of its friction as applied (N/m); 0: it has none.
    double tangential_stiffness = 0;
    /// Bit mask of Feedback::touching and the others.
    std::uint32_t flags = 0;
    /// Cycle to which this belongs: equal for representations of the same cycle. While the claim has nothing
    /// within the hand's reach it stays that of the last change.
    std::uint64_t cycle = 0;
    /// Share of `force` that reached the hand (0 to 1): the claim's gain, and less where all parts of all
    /// claims together would be stiffer than the device stands (k_max).
    double share = 1;
    /// Share of the force's damping part that reached the hand (0 to 1): less where all parts together would
    /// damp the hand more than the device stands (b_max).
    double damping_share = 1;
};

namespace detail {
class ClaimState;   // one claim: segment, channels, pending changes, replay list
class ClientState;  // one connection
class Reader;       // reports of one device
}  // namespace detail

class AnyHandle;
/// A handle on a representation of type R.
template <Described R>
class Handle;

/// Reads the reports of a device without holding it. Copies share one position in the stream.
class Observer {
  public:
    /// Made by Client::observe.
    explicit Observer(std::shared_ptr<detail::Reader> reader);

    /// For a program that draws or computes, at any rate: the newest report, with all that happened to
    /// buttons and contacts since the call before. Waits until there is one that was not read, for at most
    /// `timeout`. None: no report came in time, or not connected.
    std::optional<HandFrame> newest(std::chrono::nanoseconds timeout);
    /// The newest report, though it may have been read already. None: before the first cycle, or not
    /// connected.
    std::optional<HandReport> latest();
    /// For a program that wants every report: the next one in order, waiting for it for at most `timeout`. A
    /// program that calls it less often than reports come falls behind, by up to 4095 reports, before any is
    /// missed (HandReport::unread). None: no report came in time, or not connected.
    std::optional<HandReport> next_report(std::chrono::nanoseconds timeout);
    /// For a program that wants every report, but seldom: those that were not read, in order, as many as
    /// `out` has room for. Does not wait. Returns how many.
    std::size_t drain(std::span<HandReport> out);
    /// As drain(), into structs of another layout, as other languages have them: a HandReport begins at
    /// first + i * stride (bytes, both multiples of 8).
    std::size_t drain_rows(std::byte* first, std::size_t stride, std::size_t most);
    /// A descriptor for poll, epoll or any loop: readable while a report is there that was not read, and once
    /// when the servo has gone. It stays the same also across a restart of the servo. It belongs to the
    /// library: do not close it.
    int fd();
    /// Reports that were overwritten before they were read. Those that latest() passes over do not count.
    std::uint64_t missed() const;
    /// What the servo says about the device.
    DeviceDescription device() const;

    /// How old a report is now: since the device was read, by the servo's clock. Throws while detached.
    Age age(const Report& report) const;
    /// What is between here and the servo; all 0 on one box. Throws while detached.
    Network network() const;

    /// False: the servo is gone, and not back yet.
    bool connected() const;
    /// How often the servo came back.
    std::uint64_t reattachments() const;
    /// Ends the reading, of copies too: calls that wait in other threads, and all others from now on, throw. Of
    /// a claim: the force fades and the device is free, as by its destructor.
    void release();

  protected:
    /// The reader of the reports.
    std::shared_ptr<detail::Reader> reader_;
};

/// An application's hold on a device. Its destructor releases the device: the force fades. Handles do not
/// prolong it.
class Claim : public Observer {
  public:
    /// Made by Client::claim.
    explicit Claim(std::shared_ptr<detail::ClaimState> state);
    /// Moves; the other one holds nothing any more.
    Claim(Claim&&) noexcept = default;
    /// Moves; the other one holds nothing any more.
    Claim& operator=(Claim&& other) noexcept;
    /// As release().
    ~Claim();

    /// Adds a representation, in force from the next cycle on. Throws Error for parameters out of range, with
    /// the field, its value and its range.
    template <Described R>
    Handle<R> add(const R& params, const AddOptions& options = {}) {
        return Handle<R>(state_, add_raw(kind_number<R>(), &params, sizeof params, options));
    }
    /// All commands issued inside `changes` take effect in one cycle, or none does. If `changes` throws,
    /// nothing is sent. Do not call commit() inside.
    void together(const std::function<void()>& changes);
    /// As together(), for languages without functions to give: commands from here on are one group, until
    /// end_group() sends it or cancel_group() forgets it. Groups may lie within others; the outermost is
    /// sent.
    void begin_group();
    /// Sends the group: all of its commands take effect in one cycle, or none does. Waits and throws as the
    /// commands in it.
    void end_group();
    /// Forgets the group.
    void cancel_group();

    /// Adds a representation of a kind that is known at run time alone: its parameters, KindInfo::size bytes.
    AnyHandle add_bytes(Kind kind, std::span<const std::byte> params, const AddOptions& options = {});

    /// Places a probe (0 to 15) on the hand. Initially all probes are at the tip, with radius 0. Throws
    /// Error.
    void place_probe(std::uint32_t probe, const ProbePlacement& placement);

    /// Sends a triangle mesh, once; Shape{.asset = sent.asset} then places it. Waits until the servo has it,
    /// and throws Error with the reason if it is refused. Meanwhile the claim is silent: an application that
    /// must go on committing calls begin_sending.
    SentShape send(const Triangles& mesh, const SendOptions& options = {});
    /// Sends a height field, once; as above.
    SentShape send(const Heights& field);
    /// Begins to send a triangle mesh; does not wait.
    Sending begin_sending(const Triangles& mesh, const SendOptions& options = {});
    /// Begins to send a height field; does not wait.
    Sending begin_sending(const Heights& field);
    /// Forgets an asset of which no representation is made any more: its number and memory are free again.
    void forget(std::uint32_t asset);

    /// Allows force: it ramps up over 0.5 s once the hand is slow. Waits for the servo's answer, at most a
    /// second; throws Error with the reason if it is refused.
    void arm();
    /// Takes this claim's force away. Waits and throws as arm() does.
    void disarm();
    /// Leaves a fault: the device is idle then, without force, until arm() is called. Waits and throws as
    /// arm() does.
    void reset_fault();

    /// Sends all changes since the last commit as one batch, which takes effect in one cycle, and renews the
    /// claim. An empty commit says that the application is alive. A claim without commits is silent after
    /// max(250 ms, 3 of its intervals), and its force fades. Until three intervals were measured it is silent
    /// after 3.5 s, unless ClaimOptions::update_interval states one. Not connected, it keeps the changes for
    /// the servo's return.
    ///
    /// Returns the batch's number. Throws Error, after it has sent this batch, if the servo has refused a
    /// command or a batch since the last call (once for each). The library checks before it sends, so this
    /// means that the two disagree.
    std::uint64_t commit();
    /// Renews the claim without a commit: uncommitted changes stay uncommitted, and the interval between
    /// commits is measured as if nothing had been sent. For a thread beside the one that commits, which may
    /// stand still for long and shall not be taken for dead. May be called from any thread while another one
    /// uses the claim.
    void keep_alive();

    /// The device's limits in world units: what stiffness is clamped to.
    Limits limits() const;
    /// How late this application is.
    Timing timing() const;
    /// Where the hand will be (m, world frame) when an update computed now is half-way through its life: what
    /// follow() looks at. The hand's own position until the latency is known; at most 20 mm from it.
    Vec3 predicted_position();
    /// Waits until the batch `number` (0: the newest committed) has taken effect. False: not in that time.
    /// Throws Error if the batch was refused.
    bool wait_applied(std::uint64_t number, std::chrono::nanoseconds timeout);

  private:
    RepresentationId add_raw(Kind kind, const void* params, std::size_t bytes, const AddOptions& options);
    std::shared_ptr<detail::ClaimState> state_;
};

/// A handle on one representation of a claim. Copies name the same one.
class AnyHandle {
  public:
    /// Removes the representation: it fades over its `recovery`. The handle is stale then.
    void remove();
    /// Feedback of the newest cycle; none: the servo has not evaluated it yet.
    std::optional<HandFeedback> feedback() const;
    /// Stiffness after clamping to what the device allows (N/m); none: the servo has not answered yet (one
    /// cycle after add).
    std::optional<double> applied_stiffness() const;
    /// Slot and generation of the representation.
    RepresentationId id() const { return id_; }
    /// Kind of the representation.
    Kind kind() const { return kind_; }
    /// As Handle::set; `params`: KindInfo::size bytes.
    void set_bytes(std::span<const std::byte> params);
    /// As Handle::params; `params`: KindInfo::size bytes.
    void get_bytes(std::span<std::byte> params) const;
    /// As Handle::follow. Throws Error, too, where it is no plane and no cap.
    Followed follow_model(const SurfaceModel& model);

  protected:
    friend class Claim;
    /// For Handle.
    AnyHandle(std::shared_ptr<detail::ClaimState> state, RepresentationId id, Kind kind)
        : state_(std::move(state)), id_(id), kind_(kind) {}
    /// The claim.
    std::shared_ptr<detail::ClaimState> state_;
    /// As id().
    RepresentationId id_;
    /// Kind of the representation.
    Kind kind_;
};

/// A handle on a representation of type R.
template <Described R>
class Handle : public AnyHandle {
  public:
    /// Made by Claim::add.
    Handle(std::shared_ptr<detail::ClaimState> state, RepresentationId id)
        : AnyHandle(std::move(state), id, kind_number<R>()) {}

    /// New parameters, sent with the next commit. Throws Error for parameters out of range, and changes
    /// nothing then.
    void set(const R& params) { set_bytes(std::as_bytes(std::span(&params, 1))); }
    /// The parameters as they were set last.
    R params() const {
        R r;
        get_bytes(std::as_writable_bytes(std::span(&r, 1)));
        return r;
    }
    /// Evaluates `model` where the hand will be when this update takes effect, checks the answer (an
    /// unchecked prediction can push a hand through a plate) and sets it: a plane as the tangent plane, a cap
    /// with the model's curvatures, too.
    ///
    /// In a concave corner it adds the other sides as representations of its own, with the same parameters.
    /// It parks them out of reach when they are not needed. They count among the claim's, and feedback() has
    /// the sum of all. Setting or removing this one removes them. The result says how it went; no face: there
    /// is no report yet. Throws Error.
    Followed follow(const SurfaceModel& model) requires(std::same_as<R, Plane> || std::same_as<R, Cap>) {
        return follow_model(model);
    }
};

/// A connection to a servo.
class Client {
  public:
    /// Connects to "knurl:NAME" (or NAME), the servo of that name on this box, or to "knurl://HOST:PORT", the
    /// servo behind a knurl-bridge on another host (IPv6: "knurl://[::1]:4096"), or to "knurl://SERVO/DEVICE", which
    /// the registry of this host (knurl-dds) looks up, here or on another host; DEVICE is then what claim() and
    /// observe() take where they name none. Waits for a servo that is still starting, then throws Error, which says
    /// how to start it.
    static Client connect(const std::string& address = "knurl:default", const ConnectOptions& options = {});

    /// The servo's devices.
    std::vector<DeviceDescription> devices() const;
    /// Claims a device by name; "": the only one. Throws Error: who holds it by pid, or which devices there
    /// are.
    Claim claim(const std::string& device = "", const ClaimOptions& options = {});
    /// Reads the reports of a device without claiming it; "": the only one. Throws Error.
    Observer observe(const std::string& device = "");
    /// Leaves the fault of a device, whoever holds it: it is idle then, and without force until its holder
    /// calls arm() again. Throws Error with the reason if the device is in no fault, if the cause of the
    /// fault goes on, or if the hand moves; and for a servo on another host (there a claim may reset it: role
    /// control).
    void reset_fault(const std::string& device = "");
    /// Process number of the servo; 0: not connected.
    pid_t servo_pid() const;
    /// False: the servo is gone, and not back yet.
    bool connected() const;

  private:
    explicit Client(std::shared_ptr<detail::ClientState> state);
    std::shared_ptr<detail::ClientState> state_;
};

}  // namespace knurl
