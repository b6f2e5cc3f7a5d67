#include "connection.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <string_view>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/link/clock.hpp>
#include <knurl/link/text.hpp>
#include <knurl/link/thread.hpp>

#include "stream.hpp"

namespace knurl::bridge {

namespace {

constexpr std::int64_t flush_tick_ns = 10'000'000;
constexpr std::int64_t quick_ping_ns = 10'000'000, ping_ns = 100'000'000;
constexpr std::int64_t quick_for_ns = 200'000'000;
// Interval of long pings (path_mtu.hpp).
constexpr std::int64_t probe_ns = 500'000'000;
constexpr std::string_view no_sense =
    "its messages are not those of a knurl-bridge of this version; build the application and the bridge from "
    "the same "
    "version";

/// Refuses values with which no claim could compute.
bool sane(const protocol::Claimed& terms) noexcept {
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    const protocol::Frame& frame = terms.frame;
    const Limits& limits = terms.limits;
    return positive(frame.scale) && positive(frame.force_scale) &&
           to_eigen(frame.device_centre).allFinite() && to_eigen(frame.world_centre).allFinite() &&
           positive(limits.period) && positive(limits.metre) && positive(limits.newton) &&
           std::ranges::all_of(
               std::initializer_list<double>{limits.max_stiffness, limits.max_force, limits.max_torque,
                                             limits.max_torsion, limits.damping, limits.mass, limits.lag,
                                             limits.resolution},
               [](double x) { return x >= 0; });
}

}  // namespace

Connection::~Connection() = default;

// --------------------------------------------------------------------------------------------- the thread

void Connection::start() {
    thread_ = detail::start_thread(
        "knurl-bridge", [](void* self) { static_cast<Connection*>(self)->run(); }, this);
    running_ = true;
}

void Connection::stop() {
    if (!running_) return;
    running_ = false;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_.get(), &one, sizeof one);
    ::pthread_join(thread_, nullptr);
    const Lock held = lock();
    streams_ = {};
    if (!dead_) frames_.close();
}

void Connection::run() noexcept {
    std::int64_t next_tick = detail::monotonic_ns() + flush_tick_ns, due = next_tick;
    for (;;) {
        bool writing = false, dead = false;
        {
            const Lock held = lock();
            writing = frames_.wants_write();
            dead = dead_;
        }
        pollfd sources[] = {{.fd = stop_.get(), .events = POLLIN, .revents = 0},
                            {.fd = frames_.fd(),
                             .events = static_cast<short>(POLLIN | (writing ? POLLOUT : 0)),
                             .revents = 0},
                            {.fd = clock_socket_.get(), .events = POLLIN, .revents = 0}};
        const std::int64_t left = std::max<std::int64_t>(0, due - detail::monotonic_ns());
        // An ended connection is always readable: then only the end of this thread is awaited.
        ::poll(sources, dead ? 1 : 3, dead ? -1 : static_cast<int>((left + 999'999) / 1'000'000));
        if (sources[0].revents != 0) return;
        const Lock held = lock();
        if (dead_) continue;
        serve_frames();
        serve_clock();
        const std::int64_t now = detail::monotonic_ns();
        if (now >= next_tick) {
            next_tick = now + flush_tick_ns;
            tick(now);
        }
        // A batch sent while this thread sleeps is due after the tick that ends the sleep.
        static_assert(flush_tick_ns <= resend_ns);
        due = next_tick;
        for (const auto& stream : streams_)
            if (stream) due = std::min(due, stream->resend(now));
    }
}

void Connection::tick(std::int64_t now) noexcept {
    for (const auto& stream : streams_)
        if (stream) stream->tick(now);
    assets_.go_on();  // pieces for which there was no room before
    if (now >= next_ping_ns_) {
        ping(now);
        if (now >= next_probe_ns_) {
            ping(now, datagram_bytes);
            if (now - started_ns_ >= quick_for_ns) next_probe_ns_ = now + probe_ns;
        }
    }
    // If this process was stopped, it has heard nothing meanwhile.
    if (now - last_tick_ns_ > dead_after_ns / 2) heard_ns_ = now;
    last_tick_ns_ = now;
    if (now - heard_ns_ > dead_after_ns)
        die("nothing was heard of it for 2 s; is the network up, and knurl-bridge still running?");
}

void Connection::ping(std::int64_t now, std::size_t length) noexcept {
    alignas(8) std::array<std::byte, datagram_bytes> room{};
    const DatagramHeader header{.kind = DatagramKind::ping};
    const PingBody body{.sent_ns = now, .longest = longest_.bytes(now)};
    const std::size_t tag = outgoing_.overhead() - sizeof header;
    post(clock_socket_.get(), room, std::max(write(room, header, body), length - std::min(length, tag)));
    next_ping_ns_ = now + (now - started_ns_ < quick_for_ns ? quick_ping_ns : ping_ns);
}

void Connection::serve_clock() noexcept {
    const std::size_t count = receive_batch_.receive(clock_socket_.get());
    const std::int64_t now = detail::monotonic_ns();
    for (std::size_t i = 0; i < count; ++i) {
        const IncomingDatagrams::Opened opened = open(receive_batch_.datagram(i));
        if (opened.verdict != IncomingDatagrams::Verdict::good || opened.header.kind != DatagramKind::pong)
            continue;
        std::span<const std::byte> body = opened.body;
        PongBody pong;
        if (!take(body, pong)) continue;
        clock_.add(pong.ping_sent_ns, pong.received_ns, pong.sent_ns, now);
        mtu_.came_through(pong.longest);
    }
}

void Connection::serve_frames() noexcept {
    frames_.pump();
    while (const Frame* frame = frames_.next()) {
        heard_ns_ = detail::monotonic_ns();
        take_frame(*frame);
    }
    if (frames_.state() == FrameStream::State::closed) die();
}

void Connection::take_frame(const Frame& frame) noexcept {
    std::span<const std::byte> payload = frame.payload;
    switch (static_cast<FrameType>(frame.type)) {
        case FrameType::attached: {
            Attached attached;
            if (!take(payload, attached) || !asked_ || answer_) return die(no_sense);
            answer_ = Answer{.attached = attached, .refused = {}};
            answered_.notify_all();
            return;
        }
        case FrameType::refused: {
            Refused refused;
            if (!take(payload, refused)) return die(no_sense);
            // Not an answer, but the bridge's reason for closing.
            if (!asked_ || answer_) return die(text_of(refused.text));
            answer_ = Answer{.attached = {}, .refused = refused};
            answered_.notify_all();
            return;
        }
        case FrameType::replies:
            if (Stream* stream = stream_of(frame.stream)) stream->take_replies(payload);
            return;
        case FrameType::feedback:
            if (Stream* stream = stream_of(frame.stream)) stream->take_feedback(payload);
            return;
        case FrameType::asset_taken:
            return assets_.taken(payload) ? void() : die(no_sense);
        case FrameType::asset_ready:
            return assets_.ready(payload) ? void() : die(no_sense);
        case FrameType::asset_refused:
            return assets_.refused(payload) ? void() : die(no_sense);
        case FrameType::gone:
            return die({reinterpret_cast<const char*>(payload.data()), payload.size()});
        default:
            return die(no_sense);
    }
}

/// Wakes the watcher of hang_up() and all who wait for the bridge.
void Connection::die(std::string_view why) noexcept {
    if (dead_) return;
    dead_ = true;
    why.copy(why_, std::min(why.size(), sizeof why_ - 1));
    ::shutdown(frames_.fd(), SHUT_RDWR);
    answered_.notify_all();
    for (const auto& stream : streams_)
        if (stream) stream->wake();
    assets_.wake();
}

std::string Connection::why_it_ended() {
    const Lock held = lock();
    return last_words();
}

/// The caller may be here before this connection's thread has read them.
std::string Connection::last_words() {
    if (!dead_) serve_frames();
    if (why_[0] != '\0') return detail::format("bridge {}: {}", bridge_.text, protocol::printable(why_));
    const std::string& reason = frames_.reason();
    return detail::format("bridge {}: {}; start it again there", bridge_.text,
                          reason.empty() ? "it hung up" : reason);
}

Stream* Connection::stream_of(std::uint32_t id) noexcept {
    return id >= 1 && id <= streams_.size() ? streams_[id - 1].get() : nullptr;
}

// ------------------------------------------------------------------------------------------------ streams

Connection::Joined Connection::attach(std::uint32_t device, const protocol::ClaimRequest& request) {
    Attach message{.request = request, .report_rate = report_rate_};
    message.request.device = device;
    Lock held = lock();
    answer_.reset();
    const std::span<const std::byte> part = bytes_of(message);
    if (!send(FrameType::attach, 0, {&part, 1})) throw Error(Error::Kind::disconnected, last_words());
    asked_ = true;
    answered_.wait_for(held, answer_time_, [this] { return dead_ || answer_.has_value(); });
    asked_ = false;
    if (!answer_) {
        const bool gone = dead_;
        die();  // a late answer must never count as the next request's
        throw Error(gone ? Error::Kind::disconnected : Error::Kind::no_servo,
                    gone ? last_words()
                         : detail::format("bridge {} does not answer (waited {} ms)", bridge_.text,
                                          answer_time_.count()));
    }
    if (answer_->refused) throw refusal(*answer_->refused);
    const Attached attached = *answer_->attached;
    const protocol::ClaimCapacity& asked = request.capacity;
    if (attached.stream < 1 || attached.stream > max_streams || stream_of(attached.stream) != nullptr ||
        attached.device != device || attached.terms.capacity.representations != asked.representations ||
        attached.terms.capacity.batch_bytes != asked.batch_bytes || !sane(attached.terms)) {
        die();
        nonsense();
    }
    std::shared_ptr<Stream> stream;
    try {
        stream = std::make_shared<Stream>(shared_from_this(), attached);
    } catch (...) {
        give_back(attached.stream);
        throw;
    }
    streams_[attached.stream - 1] = stream;
    stream->tick(detail::monotonic_ns());  // says hello: reports arrive from now on
    return {.stream = std::move(stream), .terms = attached.terms};
}

void Connection::release(std::uint32_t id) noexcept {
    const Lock held = lock();
    if (stream_of(id) == nullptr) return;
    streams_[id - 1]->wake();
    streams_[id - 1].reset();
    give_back(id);
    assets_.give_up(id);
}

/// A claim that cannot be released ends with the connection.
void Connection::give_back(std::uint32_t id) noexcept {
    const Nothing nothing;
    const std::span<const std::byte> part = bytes_of(nothing);
    if (!dead_ && !send(FrameType::release, id, {&part, 1})) die();
}

// ------------------------------------------------------------------------------------------------- assets

std::shared_ptr<Connection::Parcel> Connection::offer_asset(std::uint32_t stream, std::uint32_t number,
                                                            const shm::UniqueFd& source,
                                                            std::uint64_t bytes) {
    const Lock held = lock();
    if (dead_) throw Error(Error::Kind::disconnected, last_words());
    return assets_.offer(stream, number, source, bytes);
}

std::optional<protocol::AssetReady> Connection::asset_answer(Parcel& parcel) {
    const Lock held = lock();
    parcel.heard = parcel.ready.has_value();
    if (parcel.refused) throw refusal(*parcel.refused);
    if (parcel.ready) return parcel.ready;
    if (dead_) throw Error(Error::Kind::disconnected, last_words());
    return std::nullopt;
}

void Connection::forget_asset(std::uint32_t stream, std::uint32_t number) {
    const Lock held = lock();
    const AssetForget message{.number = number};
    const std::span<const std::byte> part = bytes_of(message);
    if (!send(FrameType::asset_forget, stream, {&part, 1}))
        throw Error(Error::Kind::disconnected, last_words());
}

void Connection::withdraw_asset(const Parcel& parcel) noexcept {
    const Lock held = lock();
    if (!dead_ && !assets_.withdraw(parcel)) die();
}

bool Connection::send(FrameType type, std::uint32_t stream,
                      std::span<const std::span<const std::byte>> parts) noexcept {
    return !dead_ &&
           frames_.send(static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(stream), parts);
}

bool Connection::post(int socket, std::span<std::byte> room, std::size_t bytes) noexcept {
    const std::size_t length = outgoing_.close(room, bytes);
    if (length == 0) return false;
    // A datagram lost here counts as lost on the way, unless it is too long.
    if (::send(socket, room.data(), length, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 || errno != EMSGSIZE)
        return true;
    mtu_.refused();
    return false;
}

IncomingDatagrams::Opened Connection::open(std::span<std::byte> datagram) noexcept {
    const IncomingDatagrams::Opened opened = incoming_.open(datagram, windows_);
    if (opened.verdict != IncomingDatagrams::Verdict::good) return opened;
    heard_ns_ = detail::monotonic_ns();
    longest_.came(datagram.size(), heard_ns_);
    return opened;
}

}  // namespace knurl::bridge
