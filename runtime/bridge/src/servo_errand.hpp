#pragma once
// Requests that wait for the servo's answer (a client, a claim, an asset). A stopped servo, or one whose door
// is crowded, answers late or never, so workers wait for it. The thread that relays only hears of the answer.

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <knurl/link/error.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::bridge {

/// One request. It owns what it needs: whoever asked may be gone before the answer.
class Errand {
  public:
    virtual ~Errand() = default;
    /// Asks, unless it was abandoned before. By a worker.
    void run() noexcept;
    /// From then on the others are the relaying thread's.
    bool done() const noexcept { return done_.load(std::memory_order::acquire); }
    /// Throws Error if the servo refused, or did not answer.
    void require_answer() const;
    /// Nobody waits for the answer any more.
    void abandon() noexcept;

  protected:
    virtual void ask() = 0;  // throws Error
    /// Ends a wait that has begun. By the relaying thread, beside ask().
    virtual void interrupt() noexcept {}

  private:
    std::optional<Error> error_;
    std::atomic<bool> done_{false}, abandoned_{false};
};

/// The one request that a peer waits for, and how it goes on then.
class Awaited {
  public:
    /// `then`: after the answer, by Awaited::go_on(). False: the peer must be closed.
    void ask(std::shared_ptr<Errand> errand, std::function<bool()> then) {
        errand_ = std::move(errand);
        then_ = std::move(then);
    }
    const std::shared_ptr<Errand>& errand() const noexcept { return errand_; }
    bool waits() const noexcept { return errand_ != nullptr; }
    bool answered() const noexcept { return errand_ && errand_->done(); }
    bool go_on() {
        const std::shared_ptr<Errand> answered = std::move(errand_);  // `then` may ask the next one
        return std::exchange(then_, nullptr)();
    }
    void abandon() noexcept {
        if (errand_) errand_->abandon();
        errand_.reset();
        then_ = nullptr;
    }

  private:
    std::shared_ptr<Errand> errand_;
    std::function<bool()> then_;
};

/// The workers. Each peer has at most one errand in here, so the queue is bounded.
class ServoErrands {
  public:
    /// None: submit() asks by itself, for tests.
    explicit ServoErrands(std::size_t workers = 4);
    ~ServoErrands();  // waits for the answers that are under way
    ServoErrands(const ServoErrands&) = delete;
    ServoErrands& operator=(const ServoErrands&) = delete;

    void submit(std::shared_ptr<Errand> errand);
    /// Readable when an errand is done.
    int event() const noexcept { return event_.get(); }
    void clear_event() noexcept;

  private:
    void work() noexcept;

    shm::UniqueFd event_;
    std::mutex mutex_;
    std::condition_variable more_;
    std::deque<std::shared_ptr<Errand>> waiting_;
    bool ending_ = false;
    std::vector<std::jthread> workers_;
};

}  // namespace knurl::bridge
