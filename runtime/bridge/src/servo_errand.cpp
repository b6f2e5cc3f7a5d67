#include "servo_errand.hpp"

#include <exception>

#include <sys/eventfd.h>

#include <knurl/shm/waiter.hpp>

namespace knurl::bridge {

void Errand::run() noexcept {
    if (!abandoned_.load(std::memory_order::relaxed)) {
        try {
            ask();
        } catch (const Error& error) {
            error_ = error;
        } catch (const std::exception& error) {  // e.g. out of memory
            error_.emplace(Error::Kind::exhausted, error.what());
        }
    }
    done_.store(true, std::memory_order::release);
}

void Errand::require_answer() const {
    if (error_) throw *error_;
}

void Errand::abandon() noexcept {
    abandoned_.store(true, std::memory_order::relaxed);
    interrupt();
}

ServoErrands::ServoErrands(std::size_t workers) : event_(shm::make_event()) {
    while (workers_.size() < workers) workers_.emplace_back([this] { work(); });
}

ServoErrands::~ServoErrands() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    more_.notify_all();
}

void ServoErrands::submit(std::shared_ptr<Errand> errand) {
    if (workers_.empty()) return errand->run();
    {
        const std::lock_guard lock(mutex_);
        waiting_.push_back(std::move(errand));
    }
    more_.notify_one();
}

void ServoErrands::clear_event() noexcept {
    eventfd_t count = 0;
    ::eventfd_read(event_.get(), &count);
}

void ServoErrands::work() noexcept {
    for (;;) {
        std::shared_ptr<Errand> errand;
        {
            std::unique_lock lock(mutex_);
            more_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
            if (ending_) return;
            errand = std::move(waiting_.front());
            waiting_.pop_front();
        }
        errand->run();
        errand.reset();  // it may be the last owner
        ::eventfd_write(event_.get(), 1);
    }
}

}  // namespace knurl::bridge
