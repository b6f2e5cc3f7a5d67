#include "connection.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <knurl/link/clock.hpp>
#include <knurl/shm/waiter.hpp>

#include "datagram_socket.hpp"
#include "stream.hpp"

namespace knurl::bridge {

namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr std::int64_t tick_ns = 10'000'000;
constexpr std::int64_t quick_ping_ns = 10'000'000, ping_ns = 100'000'000;
constexpr std::int64_t quick_for_ns = 200'000'000;
constexpr std::size_t thread_stack = 256 * 1024;  // explicit: an application may lock all its memory
constexpr std::uint32_t most_devices = protocol::max_devices;

int milliseconds_until(SteadyClock::time_point deadline) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - SteadyClock::now());
    return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 60'000));
}

shm::UniqueFd begin_to_connect(const Endpoint& bridge) {
    shm::UniqueFd fd(::socket(bridge.family(), SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    // What goes wrong now shows again when the connection is asked how it is.
    if (fd && ::connect(fd.get(), bridge.get(), bridge.length) != 0 && errno != EINPROGRESS &&
        errno != ECONNREFUSED)
        throw Error(Error::Kind::no_servo,
                    fmt::format("bridge {}: cannot connect ({}); is the address right?", bridge.text,
                                std::strerror(errno)));
    if (!fd)
        throw Error(Error::Kind::refused,
                    fmt::format("bridge {}: no socket ({})", bridge.text, std::strerror(errno)));
    return fd;
}

std::shared_ptr<const TlsContext> key_of(const std::string& file) {
    if (file.empty()) return nullptr;
    try {
        const std::vector<Key> keys = read_keys(file);
        if (keys.size() != 1)
            throw std::runtime_error(
                fmt::format("{}: holds {} keys; an application uses one: give it a file with just the line "
                            "that is its own",
                            file, keys.size()));
        return TlsContext::client(keys.front());
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::permission, reason.what());
    }
}

DeviceDescription describe(const DeviceRow& row) {
    return {.name = text_of(row.name),
            .address = text_of(row.address),
            .profile = text_of(row.profile),
            .serial = text_of(row.serial),
            .rate = row.rate,
            .workspace_centre = row.workspace_centre,
            .workspace_radius = row.workspace_radius,
            .peak_force = row.peak_force,
            .max_stiffness = row.max_stiffness,
            .renders_torque = row.renders_torque != 0};
}

}  // namespace

Connection::Connection(const Endpoint& bridge, const RemoteOptions& options)
    : bridge_(bridge),
      answer_time_(options.answer_time),
      report_rate_(options.report_rate),
      frames_(begin_to_connect(bridge), false, key_of(options.key_file)),
      frames_lost_in_child_(std::in_place, frames_.fd()),
      stop_(shm::make_event()) {
    const auto deadline = SteadyClock::now() + answer_time_;
    connect(deadline);
    greet(options.client_name, deadline);
    clock_socket_ = datagram_socket();
    try_datagrams(deadline);
    started_ns_ = heard_ns_ = last_tick_ns_ = detail::monotonic_ns();
}

Connection::~Connection() = default;

// ------------------------------------------------------------------------------------------- the handshake

void Connection::broken() const {
    const std::string& reason = frames_.reason();
    if (reason.starts_with("cannot connect"))
        throw Error(
            Error::Kind::no_servo,
            fmt::format("no bridge listens at {} ({}); start one there: `knurl-bridge --listen HOST:PORT`",
                        bridge_.text, reason));
    throw Error(reason.find("key") != std::string::npos ? Error::Kind::permission : Error::Kind::disconnected,
                fmt::format("bridge {}: {}", bridge_.text, reason.empty() ? "it hung up" : reason));
}

void Connection::nonsense() const {
    throw Error(
        Error::Kind::incompatible,
        fmt::format("what answers at {} is no knurl-bridge of this version; build the application and the "
                    "bridge from the same version",
                    bridge_.text));
}

Error Connection::refusal(const Refused& refused) const {
    const auto most = static_cast<std::uint32_t>(Error::Kind::stale_handle);
    return {static_cast<Error::Kind>(std::min(refused.kind, most)), text_of(refused.text),
            static_cast<pid_t>(refused.holder_pid)};
}

void Connection::connect(SteadyClock::time_point deadline) {
    while (frames_.pump() == FrameStream::State::handshaking) {
        pollfd socket{.fd = frames_.fd(),
                      .events = static_cast<short>(POLLIN | (frames_.wants_write() ? POLLOUT : 0)),
                      .revents = 0};
        if (::poll(&socket, 1, milliseconds_until(deadline)) == 0)
            throw Error(
                Error::Kind::no_servo,
                fmt::format("bridge {} does not answer (waited {} ms); is the address right, and does a "
                            "firewall let TCP and UDP through?",
                            bridge_.text, answer_time_.count()));
    }
    if (frames_.state() == FrameStream::State::closed) broken();
}

const Frame* Connection::await_frame(SteadyClock::time_point deadline) {
    for (;;) {
        if (const Frame* frame = frames_.next()) return frame;
        if (frames_.state() == FrameStream::State::closed) broken();
        pollfd socket{.fd = frames_.fd(),
                      .events = static_cast<short>(POLLIN | (frames_.wants_write() ? POLLOUT : 0)),
                      .revents = 0};
        if (::poll(&socket, 1, milliseconds_until(deadline)) == 0)
            throw Error(Error::Kind::no_servo, fmt::format("bridge {} does not answer (waited {} ms)",
                                                           bridge_.text, answer_time_.count()));
        frames_.pump();
    }
}

void Connection::greet(const std::string& name, SteadyClock::time_point deadline) {
    Hello hello;
    hello.layout = wire_hash();
    put_text(hello.client, name);
    frames_.send(static_cast<std::uint16_t>(FrameType::hello), 0, bytes_of(hello));
    const Frame* frame = await_frame(deadline);
    if (frame->type == static_cast<std::uint16_t>(FrameType::welcome)) return welcome(frame->payload);
    std::span<const std::byte> payload = frame->payload;
    Refused refused;
    if (frame->type != static_cast<std::uint16_t>(FrameType::refused) || !take(payload, refused)) nonsense();
    throw refusal(refused);
}

void Connection::welcome(std::span<const std::byte> payload) {
    Welcome welcome;
    if (!take(payload, welcome) || welcome.devices > most_devices ||
        payload.size() != welcome.devices * sizeof(DeviceRow))
        nonsense();
    for (DeviceRow row; take(payload, row);) devices_.push_back(describe(row));
    servo_pid_ = static_cast<pid_t>(welcome.servo_pid);
    const std::optional<DirectionKeys> keys = frames_.export_keys(exporter_label);
    outbox_ = Outbox(welcome.session, keys ? &keys->send : nullptr);
    inbox_ = Inbox(welcome.session, keys ? &keys->receive : nullptr);
}

shm::UniqueFd Connection::datagram_socket() const {
    shm::UniqueFd fd = make_datagram_socket(bridge_.family());
    if (!fd || ::connect(fd.get(), bridge_.get(), bridge_.length) != 0)
        throw Error(Error::Kind::refused,
                    fmt::format("bridge {}: no socket for datagrams ({}); see the limit of open "
                                "files (ulimit -n)",
                                bridge_.text, std::strerror(errno)));
    return fd;
}

void Connection::try_datagrams(SteadyClock::time_point deadline) {
    constexpr milliseconds patience{50};
    while (!clock_.known()) {
        if (SteadyClock::now() > deadline)
            throw Error(
                Error::Kind::no_servo,
                fmt::format("bridge {} answers by TCP, but no datagram of it comes here; let UDP port {} "
                            "through the firewalls between",
                            bridge_.text,
                            ntohs(reinterpret_cast<const sockaddr_in*>(bridge_.get())->sin_port)));
        ping(detail::monotonic_ns());
        pollfd socket{.fd = clock_socket_.get(), .events = POLLIN, .revents = 0};
        ::poll(&socket, 1, static_cast<int>(patience.count()));
        serve_clock();
    }
}

// --------------------------------------------------------------------------------------------- the thread

void Connection::start() {
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, thread_stack);
    // The application's signals are the application's threads' business.
    sigset_t all, before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = ::pthread_create(
        &thread_, &attributes,
        [](void* self) -> void* {
            static_cast<Connection*>(self)->run();
            return nullptr;
        },
        this);
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    ::pthread_attr_destroy(&attributes);
    if (error != 0)
        throw Error(Error::Kind::refused,
                    "no thread for the connection; see the limit of processes (ulimit -u)");
    ::pthread_setname_np(thread_, "knurl-bridge");
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
    std::int64_t next_tick = detail::monotonic_ns() + tick_ns;
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
        const std::int64_t left = std::max<std::int64_t>(0, next_tick - detail::monotonic_ns());
        // A connection that has ended is always readable: only the end of this thread is waited for.
        ::poll(sources, dead ? 1 : 3, dead ? -1 : static_cast<int>((left + 999'999) / 1'000'000));
        if (sources[0].revents != 0) return;
        const Lock held = lock();
        if (dead_) continue;
        serve_frames();
        serve_clock();
        const std::int64_t now = detail::monotonic_ns();
        if (now < next_tick) continue;
        next_tick = now + tick_ns;
        tick(now);
    }
}

void Connection::tick(std::int64_t now) noexcept {
    for (const auto& stream : streams_)
        if (stream) stream->tick(now);
    if (now >= next_ping_ns_) ping(now);
    // Whoever stood still himself has heard nothing meanwhile.
    if (now - last_tick_ns_ > dead_after_ns / 2) heard_ns_ = now;
    last_tick_ns_ = now;
    if (now - heard_ns_ > dead_after_ns) die();
}

void Connection::ping(std::int64_t now) noexcept {
    alignas(8) std::array<std::byte, 128> room;
    const DatagramHeader header{.kind = DatagramKind::ping};
    const PingBody body{.sent_ns = now};
    std::memcpy(room.data(), &header, sizeof header);
    std::memcpy(room.data() + sizeof header, &body, sizeof body);
    post(clock_socket_.get(), room, sizeof header + sizeof body);
    next_ping_ns_ = now + (now - started_ns_ < quick_for_ns ? quick_ping_ns : ping_ns);
}

void Connection::serve_clock() noexcept {
    const std::size_t count = mailbag_.receive(clock_socket_.get());
    const std::int64_t now = detail::monotonic_ns();
    for (std::size_t i = 0; i < count; ++i) {
        const Inbox::Opened opened = open(mailbag_.datagram(i));
        if (opened.verdict != Inbox::Verdict::good || opened.header.kind != DatagramKind::pong) continue;
        std::span<const std::byte> body = opened.body;
        PongBody pong;
        if (take(body, pong)) clock_.add(pong.ping_sent_ns, pong.received_ns, pong.sent_ns, now);
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
            if (take(payload, attached)) answer_ = Answer{.attached = attached, .refused = {}};
            answered_.notify_all();
            return;
        }
        case FrameType::refused: {
            Refused refused;
            if (take(payload, refused)) answer_ = Answer{.attached = {}, .refused = refused};
            answered_.notify_all();
            return;
        }
        case FrameType::replies:
            if (Stream* stream = stream_of(frame.stream)) stream->take_replies(payload);
            return;
        case FrameType::feedback:
            if (Stream* stream = stream_of(frame.stream)) stream->take_feedback(payload);
            return;
        case FrameType::gone:
            return die();
        default:
            return;  // of no use here
    }
}

/// The watcher of hang_up() sees it, and whoever waits for something of the bridge.
void Connection::die() noexcept {
    if (dead_) return;
    dead_ = true;
    ::shutdown(frames_.fd(), SHUT_RDWR);
    answered_.notify_all();
    for (const auto& stream : streams_)
        if (stream) stream->wake();
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
    if (dead_ || !send(FrameType::attach, 0, {&part, 1}))
        throw Error(Error::Kind::disconnected,
                    fmt::format("bridge {} has gone while it was asked", bridge_.text));
    answered_.wait_for(held, answer_time_, [this] { return dead_ || answer_.has_value(); });
    if (!answer_) {
        const bool gone = dead_;
        die();  // a late answer must never be taken for the next request's
        throw Error(gone ? Error::Kind::disconnected : Error::Kind::no_servo,
                    gone ? fmt::format("bridge {} has gone while it was asked", bridge_.text)
                         : fmt::format("bridge {} does not answer (waited {} ms)", bridge_.text,
                                       answer_time_.count()));
    }
    if (answer_->refused) throw refusal(*answer_->refused);
    const Attached attached = *answer_->attached;
    const protocol::ClaimCapacity& asked = request.capacity;
    if (attached.stream < 1 || attached.stream > max_streams || stream_of(attached.stream) != nullptr ||
        attached.terms.capacity.representations > asked.representations ||
        attached.terms.capacity.batch_bytes > asked.batch_bytes) {
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
    stream->tick(detail::monotonic_ns());  // says hello: reports come from here on
    return {.stream = std::move(stream), .terms = attached.terms};
}

void Connection::release(std::uint32_t id) noexcept {
    const Lock held = lock();
    if (stream_of(id) == nullptr) return;
    streams_[id - 1]->wake();
    streams_[id - 1].reset();
    give_back(id);
}

/// A claim that cannot be given back ends with the connection.
void Connection::give_back(std::uint32_t id) noexcept {
    const Nothing nothing;
    const std::span<const std::byte> part = bytes_of(nothing);
    if (!dead_ && !send(FrameType::release, id, {&part, 1})) die();
}

bool Connection::send(FrameType type, std::uint32_t stream,
                      std::span<const std::span<const std::byte>> parts) noexcept {
    return !dead_ &&
           frames_.send(static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(stream), parts);
}

bool Connection::post(int socket, std::span<std::byte> room, std::size_t bytes) noexcept {
    const std::size_t length = outbox_.close(room, bytes);
    if (length == 0) return false;
    // Lost here or lost on the way is the same, but for one thing.
    return ::send(socket, room.data(), length, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 || errno != EMSGSIZE;
}

Inbox::Opened Connection::open(std::span<std::byte> datagram) noexcept {
    const Inbox::Opened opened = inbox_.open(datagram, windows_);
    if (opened.verdict == Inbox::Verdict::good) heard_ns_ = detail::monotonic_ns();
    return opened;
}

}  // namespace knurl::bridge
