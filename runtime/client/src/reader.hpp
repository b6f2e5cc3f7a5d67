#pragma once
// One reader of a device's reports, and how it survives a restart of the servo: its source is replaced, it
// stays.

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <knurl/client/client.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/link/transport.hpp>
#include <knurl/shm/fd.hpp>

#include "hint.hpp"
#include "since.hpp"

namespace knurl::detail {

class ClientState;

// A sleeper cannot be woken for a servo that died, since the servo's waker does the waking: it looks itself.
// While reports come, no sleep is that long.
inline constexpr std::chrono::nanoseconds longest_sleep = std::chrono::milliseconds(5);

class Reader {
  public:
    Reader(std::shared_ptr<ClientState> client, std::string device, const protocol::ClaimRequest& request);
    virtual ~Reader() = default;
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    std::optional<HandReport> latest();
    std::optional<HandReport> next_report(std::chrono::nanoseconds timeout);
    std::optional<HandFrame> newest(std::chrono::nanoseconds timeout);
    int fd();
    std::uint64_t missed();
    DeviceDescription description();
    Age age(const Report& report);
    Network network();
    bool connected();
    std::uint64_t reattachments();

    /// Gives the device back. Safe to call again; every other call throws from then on.
    void close();

    // By ClientState, which holds its own lock: never called with `mutex_` held.
    const std::string& device_name() const { return device_; }
    const protocol::ClaimRequest& request() const { return request_; }
    void attach(Attachment& attachment);  // takes it over, unless it throws
    std::optional<Attachment> detach();
    void give_up(const std::string& reason);  // it will not come back: calls throw this
    void note_loss(const std::string& why);   // while it is away, calls that need it say so

  protected:
    using Lock = std::unique_lock<std::mutex>;

    /// Locks, or throws: after a fork, after close(), and when the servo has gone for good.
    Lock enter();
    [[noreturn]] void throw_disconnected() const;
    /// The newest report in the world frame, without reading it. None: detached, or before the first cycle.
    std::uint64_t attachments() const { return reattachments_; }  // `mutex_` held
    std::optional<Report> peek(const Lock& lock) const;
    /// After a wait on the event: the application's descriptor has to be ready for the next report again.
    void settle(const Lock& lock, bool waited);

    /// Before on_attach(), and not with the lock: what takes time. Ends with an Error if is_leaving().
    virtual void bring(Attachment&) {}
    bool is_leaving() const noexcept;
    virtual void on_attach(Attachment& attachment, bool again);  // `mutex_` held
    virtual void on_detach() {}                                  // `mutex_` held
    /// The application reads. Where hints are wanted. `mutex_` held
    virtual void on_read() {}
    bool hints() const noexcept;

    const std::uint64_t made_in_ = fork_generation();
    // Held while anything below is looked at or changed, never while sleeping: the watcher may come in then.
    std::mutex mutex_;
    std::condition_variable changed_;  // attached, detached, closed
    std::optional<Attachment> attachment_;
    std::optional<Report> last_;  // read last, world frame

  private:
    /// The next report, in the device's frame, waiting for it.
    std::optional<Report> await(Lock& lock, std::chrono::nanoseconds timeout);
    HandReport taken(const Report& report);
    void fill(HandReport& report) const;  // with what only the client knows
    void look_behind(const Report& read);
    void watch_event(int operation);
    void notify_loop(bool raise);

    std::shared_ptr<ClientState> client_;
    const std::string device_;
    const protocol::ClaimRequest request_;
    std::string given_up_;  // why
    std::string lost_;      // why it was away last
    std::atomic<bool> leaving_{false};
    bool closed_ = false;
    bool was_attached_ = false;
    std::uint64_t missed_before_ = 0;  // of earlier sources
    std::uint64_t reattachments_ = 0;
    // What fd() hands out: an epoll descriptor over the source's event, which a restart replaces, and a
    // notice of our own.
    shm::UniqueFd loop_, notice_;
    bool noticed_ = false;
    Since since_;
    Lasting behind_;
};

}  // namespace knurl::detail
