#include "usb/io_thread.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <span>
#include <stdexcept>

#include <sys/eventfd.h>
#include <unistd.h>

namespace knurl::drivers::usb {

namespace {

Nanoseconds monotonic() noexcept {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * Nanoseconds{1'000'000'000} + t.tv_nsec;
}

}  // namespace

IoThread::Poke::Poke() : fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd_ < 0) throw std::runtime_error(std::string("usb: eventfd: ") + std::strerror(errno));
}

IoThread::Poke::~Poke() {
    ::close(fd_);
}

void IoThread::Poke::set() const noexcept {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t n = write(fd_, &one, sizeof one);
}

void IoThread::Poke::take() const noexcept {
    std::uint64_t pokes = 0;
    [[maybe_unused]] const ssize_t n = read(fd_, &pokes, sizeof pokes);
}

IoThread::IoThread(Wanted wanted, std::unique_ptr<Protocol> protocol, int priority)
    : wanted_(std::move(wanted)),
      protocol_(std::move(protocol)),
      priority_(priority),
      context_(priority > 0) {
    std::array<std::uint8_t, packet_bytes> zero{};
    zero_line_.emplace(std::span(zero.data(), protocol_->takes_efforts() ? protocol_->pack({}, zero) : 0));
    for (auto& [list, n] : {std::pair{&in_, transfers_in}, std::pair{&out_, transfers_out}})
        for (int i = 0; i < n; ++i) {
            list->push_back(std::make_unique<Transfer>());
            list->back()->owner = this;
            list->back()->block.reset(libusb_alloc_transfer(0));
            if (!list->back()->block) throw std::bad_alloc();
        }
    waits_.reserve(16);
    if (!wanted_.wait || !is_absent()) {
        open();
        info_ = session_->info();
        first_ = reading_;
        seen_session_ = number_;
    }

    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, stack_bytes);
    sigset_t all, before;  // signals are the program's concern
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(
        &thread_, &attributes,
        [](void* self) -> void* {
            static_cast<IoThread*>(self)->live();
            return nullptr;
        },
        this);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    pthread_attr_destroy(&attributes);
    if (error != 0) throw std::runtime_error(std::string("usb: no thread: ") + std::strerror(error));
    pthread_setname_np(thread_, "knurl-usb");
}

IoThread::~IoThread() {
    stop_.store(true, std::memory_order_relaxed);
    poke_.set();
    pthread_join(thread_, nullptr);
}

// ------------------------------------------------------------------------------------------------ the cycle

ReadStatus IoThread::take(Reading& reading) noexcept {
    if (!begun_) {
        begun_ = true;
        awake_.store(true, std::memory_order_release);
        poke_.set();
    }
    seen_acts_ = zero_line_->acts();
    // Pairs with the release in open(): an odd number guarantees its first reading.
    const std::uint64_t session = session_number_.load(std::memory_order_acquire);
    if (session != seen_session_) {
        seen_session_ = session;
        return ReadStatus::unplugged;
    }
    if ((session & 1U) == 0) return ReadStatus::unplugged;
    if (deaf_.load(std::memory_order_relaxed)) return ReadStatus::bad;
    Reading next;
    const std::uint64_t garbage = garbage_.load(std::memory_order_relaxed);
    const bool more_garbage = garbage != seen_garbage_;
    seen_garbage_ = garbage;
    if (!readings_.take(next) || next.session != session)
        return more_garbage ? ReadStatus::bad : ReadStatus::stale;
    reading = next;
    return ReadStatus::ok;
}

bool IoThread::send(Orders orders) noexcept {
    if (!begun_)
        return there();  // no answer to a sample: the thread that the first take() wakes must not find orders
    orders.session = seen_session_;
    orders.acts = seen_acts_;
    newest_orders_.publish(orders);
    poke_.set();
    return there();
}

void IoThread::make_safe() noexcept {
    zero_line_->zero();
    if (!zero_line_->forked()) poke_.set();
}

IoCounts IoThread::counts() const noexcept {
    return {.readings = readings_count_.load(std::memory_order_relaxed),
            .sent = sent_.load(std::memory_order_relaxed),
            .missed = missed_.load(std::memory_order_relaxed),
            .garbage = garbage_.load(std::memory_order_relaxed),
            .errors = errors_.load(std::memory_order_relaxed),
            .openings = (session_number_.load(std::memory_order_relaxed) + 1) / 2};
}

// ---------------------------------------------------------------------------------------------- the thread

bool IoThread::is_absent() const {
    return std::ranges::none_of(context_.list(wanted_.ids, wanted_.scheme), [this](const Found& one) {
        return (wanted_.serial.empty() || one.info.serial == wanted_.serial) &&
               (wanted_.port.empty() || one.info.port == wanted_.port);
    });
}

void IoThread::open() {
    session_.emplace(context_, context_.find(wanted_), protocol_->interface(), stop_);
    reading_ = {};
    protocol_->start(*session_, reading_);
    // After a replug, only this very device is accepted.
    if (wanted_.serial.empty()) wanted_.serial = session_->info().serial;
    if (wanted_.serial.empty()) wanted_.port = session_->info().port;
    zero_line_->hold(session_->node(), session_->out());
    waits_.clear();
    waits_.push_back({.fd = poke_.fd(), .events = POLLIN, .revents = 0});
    for (const libusb_pollfd& wait : context_.descriptors())
        waits_.push_back({.fd = wait.fd, .events = wait.events, .revents = 0});
    gone_ = halted_ = owed_ = false;
    unheard_ = 0;
    for (auto* list : {&in_, &out_})
        for (const auto& transfer : *list) transfer->errors_in_row = 0;
    orders_ = {};
    ++number_;
    reading_.session = number_;
    readings_.publish(reading_);
    readings_count_.fetch_add(1, std::memory_order_relaxed);
    session_number_.store(number_, std::memory_order_release);
}

/// Ends transfers in flight, sends zero if the device is there, and closes.
void IoThread::close() noexcept {
    ++number_;
    session_number_.store(number_, std::memory_order_release);
    for (auto* list : {&in_, &out_})
        for (const auto& transfer : *list)
            if (transfer->active) libusb_cancel_transfer(transfer->block.get());
    constexpr int patience = 100;  // of 10 ms
    for (int i = 0; i < patience && any_active(); ++i) {
        timeval slice{.tv_sec = 0, .tv_usec = 10'000};
        libusb_handle_events_timeout_completed(context_.get(), &slice, nullptr);
    }
    zero_line_->let_go();
    if (!gone_ && protocol_->takes_efforts()) {
        std::array<std::uint8_t, packet_bytes> packet{};
        const std::size_t length = protocol_->pack({}, packet);
        session_->write_last(std::span(packet).first(length), Session::Milliseconds{50});
    }
    session_.reset();
}

void IoThread::run_at(int priority) const noexcept {
    const sched_param real_time{.sched_priority = std::min(priority, priority_)};
    if (priority_ > 0) pthread_setschedparam(pthread_self(), SCHED_FIFO, &real_time);
}

void IoThread::live() noexcept {
    run_at(priority_);
    while (!awake_.load(std::memory_order_acquire) && !stop_.load(std::memory_order_relaxed))
        wait(session_ ? -1 : search_ms);
    while (!stop_.load(std::memory_order_relaxed)) {
        if (session_) {
            converse();
            close();
            continue;
        }
        run_at(search_priority);
        try {
            open();
            run_at(priority_);
        } catch (const std::exception&) {
            // Missing, not ready, or its rights are not set yet: the cycle sees "unplugged", and the search
            // continues.
            session_.reset();
            wait(search_ms);
        }
    }
    if (session_) close();
}

bool IoThread::any_active() const noexcept {
    const auto active = [](const auto& transfer) { return transfer->active; };
    return std::ranges::any_of(in_, active) || std::ranges::any_of(out_, active);
}

/// A device that sends readings by itself looks healthy, even if it has long accepted no effort.
bool IoThread::deaf(Nanoseconds now) const noexcept {
    if (unheard_ < deaf_orders) return false;
    return std::ranges::any_of(
        out_, [now](const auto& transfer) { return transfer->active && now - transfer->since > deaf_after; });
}

/// Waits until something happens, and then lets libusb handle it.
void IoThread::wait(int timeout_ms) noexcept {
    if (!session_) {  // the list of descriptors belongs to an opened node
        timeval slice{.tv_sec = 0, .tv_usec = timeout_ms * 1000};
        libusb_handle_events_timeout_completed(context_.get(), &slice, nullptr);
        return;
    }
    if (poll(waits_.data(), waits_.size(), timeout_ms) <= 0) return;
    if ((waits_[0].revents & POLLIN) != 0) poke_.take();
    if (std::any_of(waits_.begin() + 1, waits_.end(), [](const pollfd& fd) { return fd.revents != 0; })) {
        timeval at_once{};
        libusb_handle_events_timeout_completed(context_.get(), &at_once, nullptr);
    }
}

void IoThread::converse() noexcept {
    for (const auto& transfer : in_) ask(*transfer);
    last_order_ = monotonic();
    answered_acts_ = zero_line_->acts();
    const int silence_ms = protocol_->takes_efforts() ? static_cast<int>(silence / 1'000'000) : -1;
    while (!gone_ && !stop_.load(std::memory_order_relaxed)) {
        wait(silence_ms);
        if (halted_) clear_halts();
        attend();
    }
}

/// Sends what the cycle or the guardian has requested since the last call.
void IoThread::attend() noexcept {
    const bool fresh = newest_orders_.take(orders_);
    const Nanoseconds now = monotonic();
    deaf_.store(deaf(now), std::memory_order_relaxed);
    const bool silent = !fresh && now - last_order_ >= silence;
    if (silent) orders_ = {};
    if (fresh || silent) last_order_ = now;
    const std::uint64_t acts = zero_line_->acts();
    const bool made_safe = acts != answered_acts_;
    answered_acts_ = acts;
    if (fresh || silent || made_safe || owed_) transmit(fresh);
}

// The race with make_safe in another process, while this one may be stopped at any point:
//
//   guardian: ++acts (rel) ─sb─> sends zero
//   here:     acts (acq) ─sb─> pack ─sb─> submit ─sb─> acts (acq) again: changed? then a zero follows at once
//
// Orders carry the count that the cycle saw when it read their sample; orders with an older count become
// zero. If this process is stopped between the first load and the submission, an old effort goes out after
// the guardian's zero when the process continues. The second load then makes a zero follow it.
//
// An interrupt endpoint takes one packet per frame, so only one is in flight: a second would wait a whole
// frame behind it, and so would every later order. For the same reason an order that finds one in flight is
// not queued: the next cycle's order replaces it. A zero is queued.
void IoThread::transmit(bool fresh) noexcept {
    if (!protocol_->takes_efforts()) return;
    const bool one_a_frame = session_->interrupt();
    const std::span packets(out_.data(), one_a_frame ? 1 : out_.size());
    for (std::size_t i = 0; i < packets.size(); ++i) {
        const auto free =
            std::ranges::find_if(packets, [](const auto& transfer) { return !transfer->active; });
        if (free == packets.end()) {
            owed_ = owed_ || !fresh || !one_a_frame;  // sent when one of them is done
            if (!fresh) return;
            missed_.fetch_add(1, std::memory_order_relaxed);
            unheard_ = std::min(unheard_ + 1, deaf_orders);
            return;
        }
        const std::uint64_t acts = zero_line_->acts();
        Orders now = orders_;
        if (now.session != number_ || now.acts != acts) now.efforts = {};
        Transfer& transfer = **free;
        const std::size_t length = protocol_->pack(now, transfer.bytes);
        submit(transfer, session_->out(), length, on_out);
        if (transfer.active) sent_.fetch_add(1, std::memory_order_relaxed);
        owed_ = !transfer.active || zero_line_->acts() != acts;
        if (!owed_) return;
    }
}

void IoThread::submit(Transfer& transfer, std::uint8_t endpoint, std::size_t length,
                      libusb_transfer_cb_fn done) noexcept {
    const auto fill = session_->interrupt() ? libusb_fill_interrupt_transfer : libusb_fill_bulk_transfer;
    fill(transfer.block.get(), session_->handle(), endpoint, transfer.bytes.data(), static_cast<int>(length),
         done, &transfer, 0);
    const int code = libusb_submit_transfer(transfer.block.get());
    transfer.active = code == 0;
    transfer.since = monotonic();
    if (code == 0) return;
    gone_ = gone_ || code == LIBUSB_ERROR_NO_DEVICE || ++transfer.errors_in_row > most_errors;
    errors_.fetch_add(1, std::memory_order_relaxed);
}

void IoThread::ask(Transfer& transfer) noexcept {
    submit(transfer, session_->in(), packet_bytes, on_in);
}

void IoThread::received(Transfer& transfer) noexcept {
    const auto length = static_cast<std::size_t>(std::max(transfer.block->actual_length, 0));
    const Heard heard = protocol_->hear(std::span(transfer.bytes.data(), length), reading_);
    if (heard.garbage > 0)
        garbage_.fetch_add(static_cast<std::uint64_t>(heard.garbage), std::memory_order_relaxed);
    transfer.errors_in_row = 0;
    if (!heard.reading) return;
    readings_.publish(reading_);
    readings_count_.fetch_add(1, std::memory_order_relaxed);
}

/// A transfer has failed: finds the reason and its consequence.
void IoThread::ended(Transfer& transfer) noexcept {
    switch (transfer.block->status) {
        case LIBUSB_TRANSFER_CANCELLED:
            return;
        case LIBUSB_TRANSFER_NO_DEVICE:
            gone_ = true;
            return;
        case LIBUSB_TRANSFER_STALL:
            halted_ = true;
            break;
        default:
            break;
    }
    errors_.fetch_add(1, std::memory_order_relaxed);
    gone_ = gone_ || ++transfer.errors_in_row > most_errors;
}

void IoThread::clear_halts() noexcept {
    halted_ = false;
    libusb_clear_halt(session_->handle(), session_->in());
    if (protocol_->takes_efforts()) libusb_clear_halt(session_->handle(), session_->out());
    for (const auto& transfer : in_)
        if (!transfer->active && !gone_) ask(*transfer);
}

void IoThread::on_in(libusb_transfer* block) {
    Transfer& transfer = *static_cast<Transfer*>(block->user_data);
    IoThread& self = *transfer.owner;
    transfer.active = false;
    if (block->status == LIBUSB_TRANSFER_COMPLETED)
        self.received(transfer);
    else
        self.ended(transfer);
    const bool closing = (self.number_ & 1U) == 0;
    if (block->status != LIBUSB_TRANSFER_CANCELLED && !self.gone_ && !self.halted_ && !closing)
        self.ask(transfer);
    // libusb may deliver up to 26 transfers before it returns, and orders must not wait for that. Where
    // packets arrive as fast as they are requested (a slow machine, a flooding device) orders would be many
    // packets late. A device that only answers orders would have nothing new meanwhile.
    if (!self.gone_ && !closing) self.attend();
}

void IoThread::on_out(libusb_transfer* block) {
    Transfer& transfer = *static_cast<Transfer*>(block->user_data);
    IoThread& self = *transfer.owner;
    transfer.active = false;
    if (block->status == LIBUSB_TRANSFER_COMPLETED)
        transfer.errors_in_row = self.unheard_ = 0;
    else
        self.ended(transfer);  // the next order or the silence rule sends its content again
}

}  // namespace knurl::drivers::usb
