#pragma once
// One reader of a device's reports. When the servo restarts, its source is replaced and the reader stays.

#include <atomic>
#include <condition_variable>
#include <cstddef>
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

// A dead servo cannot wake a sleeper, since its waker does the waking. So a sleeper checks at this interval.
// While reports arrive, no sleep lasts that long.
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
    /// At first + i * stride begins a HandReport.
    std::size_t drain(std::byte* first, std::size_t stride, std::size_t most);
    int fd();
    std::uint64_t missed();
    DeviceDescription description();
    Age age(const Report& report);
    Network network();
    bool connected();
    std::uint64_t reattachments();

    /// Releases the device. May be called again; every other call throws from then on.
    void close();

    // For ClientState, which holds its own lock: never called with `mutex_` held.
    const std::string& device_name() const { return device_; }
    const protocol::ClaimRequest& request() const { return request_; }
    void attach(Attachment& attachment);  // takes the attachment over, unless it throws
    std::optional<Attachment> detach();
    void give_up(const std::string& reason);  // the servo will not come back: calls throw this
    void note_loss(const std::string& why);   // until the servo is back, calls that need it throw this

  protected:
    using Lock = std::unique_lock<std::mutex>;

    /// Locks, or throws: after a fork, after close(), and when the servo is gone for good.
    Lock enter();
    [[noreturn]] void throw_disconnected() const;
    /// The newest report in the world frame; does not count as read. None: detached, or before the first
    /// cycle.
    std::uint64_t attachments() const { return reattachments_; }  // `mutex_` held
    std::optional<Report> peek(const Lock& lock) const;
    /// After a wait on the event: makes the application's descriptor ready for the next report again.
    void settle(const Lock& lock, bool waited);

    /// Before on_attach(), without the lock: work that takes time. Ends with an Error if is_leaving().
    virtual void bring(Attachment&) {}
    bool is_leaving() const noexcept;
    virtual void on_attach(Attachment& attachment, bool again);  // `mutex_` held
    virtual void on_detach() {}                                  // `mutex_` held
    /// The application reads: the place for hints. `mutex_` held.
    virtual void on_read() {}
    bool hints() const noexcept;

    const std::uint64_t made_in_ = fork_generation();
    // Held while anything below is read or changed, never during a sleep: then the watcher may enter.
    std::mutex mutex_;
    std::condition_variable changed_;  // attached, detached, closed
    std::optional<Attachment> attachment_;
    std::optional<Report> last_;  // the last one read, world frame

  private:
    /// Waits for the next report, in the device's frame.
    std::optional<Report> await(Lock& lock, std::chrono::nanoseconds timeout);
    HandReport taken(const Report& report);
    void fill(HandReport& report) const;  // adds what only the client knows
    void look_behind(const Report& read);
    void watch_event(int operation);
    void notify_loop(bool raise);

    std::shared_ptr<ClientState> client_;
    const std::string device_;
    const protocol::ClaimRequest request_;
    std::string given_up_;  // reason
    std::string lost_;      // reason of the last loss
    std::atomic<bool> leaving_{false};
    bool closed_ = false;
    bool was_attached_ = false;
    std::uint64_t missed_before_ = 0;  // of earlier sources
    std::uint64_t reattachments_ = 0;
    // What fd() returns: an epoll descriptor over the source's event, which a restart replaces, and over an
    // eventfd of the reader.
    shm::UniqueFd loop_, notice_;
    bool noticed_ = false;
    Since since_;
    Lasting behind_;
};

}  // namespace knurl::detail
