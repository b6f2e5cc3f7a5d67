#include "peer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <sys/socket.h>

#include <knurl/link/clock.hpp>
#include <knurl/link/local.hpp>
#include <knurl/link/text.hpp>

namespace knurl::bridge {

namespace {

constexpr std::size_t waiting_bytes = 256 * 1024;  // buffered for a peer that reads slowly

DeviceRow row_of(const DeviceDescription& device) {
    DeviceRow row;
    put_text(row.name, device.name);
    put_text(row.address, device.address);
    put_text(row.profile, device.profile);
    put_text(row.serial, device.serial);
    row.rate = device.rate;
    row.workspace_centre = device.workspace_centre;
    row.workspace_radius = device.workspace_radius;
    row.peak_force = device.peak_force;
    row.peak_torque = device.peak_torque;
    row.max_stiffness = device.max_stiffness;
    row.renders_torque = device.renders_torque ? 1 : 0;
    row.senses_orientation = device.senses_orientation ? 1 : 0;
    return row;
}

/// The name that the servo's clients see, at most name_bytes long. Whoever asks for the holder of a device
/// must learn its host, so a long key name is cut, not the address.
std::string name_at(std::string_view name, const sockaddr_storage& from) {
    const std::string at = detail::format("@{}", numeric(from));
    const std::size_t room = protocol::name_bytes - 1 - at.size();
    if (name.size() <= room) return std::string(name) + at;
    return std::string(name.substr(0, room - 1)) + "~" + at;
}

}  // namespace

/// Makes a peer a client of the servo.
class GreetErrand final : public Errand {
  public:
    GreetErrand(std::string servo, std::string name, bool observers_too)
        : servo_(std::move(servo)), name_(std::move(name)), observers_too_(observers_too) {}
    std::shared_ptr<detail::Link> link;
    std::optional<ReportNotifier::Observers> observers;

  private:
    void ask() override {
        if (observers_too_) observers = ReportNotifier::attach(servo_);
        link = detail::connect_local(servo_, name_, servo_answer_time);
    }
    const std::string servo_, name_;
    const bool observers_too_;
};

class AttachErrand final : public Errand {
  public:
    AttachErrand(std::shared_ptr<detail::Link> link, const protocol::ClaimRequest& request)
        : link_(std::move(link)), request_(request) {}
    std::optional<detail::Attachment> attachment;

  private:
    void ask() override { attachment = link_->attach(request_.device, request_); }
    /// The servo sees at once that the peer has gone.
    void interrupt() noexcept override { ::shutdown(link_->hang_up(), SHUT_RDWR); }
    const std::shared_ptr<detail::Link> link_;
    const protocol::ClaimRequest request_;
};

Peer::Peer(shm::UniqueFd socket, const sockaddr_storage& from, std::uint64_t session,
           std::optional<TlsSession> tls, std::int64_t now)
    : frames_(std::move(socket), std::move(tls), {.payload = max_frame_bytes, .outgoing = waiting_bytes}),
      from_(from),
      session_(session),
      name_(numeric(from)),
      heard_ns_(now) {
    frames_.limit_payload(max_greeting_bytes);
}

Peer::~Peer() = default;

bool Peer::fail(std::string why) {
    why_ = std::move(why);
    return false;
}

bool Peer::holds_one_of(std::span<const Key> keys) const noexcept {
    if (!key_) return false;
    const Key* const key = find_key(keys, key_->name);
    return key != nullptr && key->role == key_->role && key->secret == key_->secret;
}

PeerStream* Peer::stream_of(std::uint32_t id) noexcept {
    return id >= 1 && id <= streams_.size() ? streams_[id - 1].get() : nullptr;
}

bool Peer::serve(PeerContext& context, std::int64_t now) {
    frames_.pump();
    while (!awaited_.waits()) {
        const Frame* const frame = frames_.next();
        if (frame == nullptr) break;
        heard_ns_ = now;
        if (!take_frame(*frame, context)) return false;
        if (awaited_.waits()) context.errands.submit(awaited_.errand());
    }
    if (frames_.state() == FrameStream::State::closed)
        return fail(frames_.reason().empty() ? "it hung up" : frames_.reason());
    return true;
}

bool Peer::go_on(PeerContext& context, std::int64_t now) {
    heard_ns_ = now;  // its own patience is as long
    if (!awaited_.go_on()) return false;
    if (awaited_.waits()) context.errands.submit(awaited_.errand());
    return serve(context, now);
}

bool Peer::take_frame(const Frame& frame, PeerContext& context) {
    const auto type = static_cast<FrameType>(frame.type);
    if (!greeted())
        return type == FrameType::hello ? greet(frame.payload, context) : fail("it did not say hello first");
    if (type == FrameType::attach) return attach(frame.payload, context);
    PeerStream* stream = stream_of(frame.stream);
    if (type == FrameType::asset_piece)
        return assets_.piece(frame.payload, why_);  // each piece is
                                                    // acknowledged
    // The stream was released meanwhile, or never existed: ignoring the frame is harmless.
    if (stream == nullptr) return true;
    const char* why = "";
    switch (type) {
        case FrameType::release:
            release(frame.stream, context);
            return true;
        case FrameType::commands:
            return stream->commands(frame.payload, role(), why) || fail(why);
        case FrameType::batch:
            return stream->batch(frame.payload, why) || fail(why);
        case FrameType::asset_offer:
            return assets_.offer(frame.stream, stream->attachment().assets, frame.payload, why_);
        case FrameType::asset_cancel:
            return assets_.cancel(frame.payload, why_);
        case FrameType::asset_forget:
            return assets_.forget(frame.stream, frame.payload, why_);
        default:
            return fail(detail::format("a frame of the unknown type {}", frame.type));
    }
}

// ---------------------------------------------------------------------------------------------- handshake

bool Peer::refuse(const Error& error) noexcept {
    Refused refused;
    refused.kind = static_cast<std::uint32_t>(error.kind);
    refused.holder_pid = static_cast<std::uint32_t>(error.holder);
    put_text(refused.text, error.what());
    return frames_.send(static_cast<std::uint16_t>(FrameType::refused), 0, bytes_of(refused));
}

bool Peer::greet(std::span<const std::byte> payload, PeerContext& context) {
    Hello hello;
    const bool whole = take(payload, hello);
    if (!whole || hello.magic != wire_magic || hello.version != wire_version || hello.layout != wire_hash()) {
        refuse(Error(
            Error::Kind::incompatible,
            "build mismatch: the application and the bridge are not of the same version; rebuild the one and "
            "restart the other"));
        return fail("it is of another version");
    }
    name_ = name_at(protocol::printable(hello.client), from_);
    if (!context.keys.empty()) {
        const Key* key = find_key(context.keys, frames_.peer_identity());
        if (key == nullptr)
            return fail("its key is not in the file");  // cannot happen: TLS has admitted
                                                        // only known keys
        key_ = *key;
        name_ = name_at(key->name, from_);
    }
    if (context.sessions >= max_sessions) {
        refuse(Error(
            Error::Kind::refused,
            detail::format("the bridge has {} sessions, which is all it takes; end one", max_sessions)));
        return fail("there are too many");
    }
    // Nobody may hold more than he leaves free, as at the servo.
    if (key_) {
        const std::size_t held = context.sessions_of(key_->name), left = max_sessions - context.sessions;
        if (held >= left) {
            refuse(Error(Error::Kind::refused,
                         detail::format("key '{}' holds {} sessions of the bridge and leaves {} of {}, and "
                                        "nobody may hold more than that; end one",
                                        key_->name, held, left, max_sessions)));
            return fail("its key has too many sessions");
        }
    }
    auto errand = std::make_shared<GreetErrand>(context.servo, name_, !context.notifier.is_open());
    awaited_.ask(errand, [this, errand = errand.get(), &context] { return welcome(*errand, context); });
    return true;
}

bool Peer::welcome(GreetErrand& errand, PeerContext& context) {
    try {
        errand.require_answer();
        if (!context.notifier.is_open()) {
            if (!errand.observers) throw Error(Error::Kind::no_servo, "its servo has just ended; try again");
            context.notifier.open(std::move(*errand.observers));
        }
    } catch (const Error& error) {
        refuse(Error(error.kind, detail::format("the bridge is there, but {}", error.what())));
        return fail(error.what());
    }
    link_ = std::move(errand.link);
    const std::optional<DirectionKeys> keys = frames_.export_keys(exporter_label);
    outgoing_ = OutgoingDatagrams(session_, keys ? &keys->send : nullptr);
    incoming_ = IncomingDatagrams(session_, keys ? &keys->receive : nullptr);
    frames_.limit_payload(max_frame_bytes);

    const Welcome welcome{.session = session_,
                          .devices = static_cast<std::uint32_t>(link_->devices().size()),
                          .servo_pid = static_cast<std::uint32_t>(link_->servo_pid())};
    std::vector<DeviceRow> rows;
    for (const DeviceDescription& device : link_->devices()) rows.push_back(row_of(device));
    const std::array parts{bytes_of(welcome), std::as_bytes(std::span(rows))};
    return frames_.send(static_cast<std::uint16_t>(FrameType::welcome), 0, parts) || fail("it does not read");
}

std::optional<std::string> Peer::forbidden(const protocol::ClaimRequest& request) const {
    if (request.observe > protocol::observe_only)
        return "a fault is reset on the servo's own host: run `knurl reset` there";
    if (request.observe != 0 || role() == Role::control) return std::nullopt;
    if (role() == Role::observe)
        return detail::format(
            "the key of {} has role observe: it reads reports; to claim a device use one of role render "
            "or control (knurl-bridge keygen --role control)",
            name_);
    if (request.shared == 0)
        return detail::format(
            "the key of {} has role render: it claims devices with ClaimOptions::shared only; to have "
            "one alone use a key of role control (knurl-bridge keygen --role control)",
            name_);
    return std::nullopt;
}

std::size_t Peer::observers(std::uint32_t device) const noexcept {
    return static_cast<std::size_t>(std::count_if(streams_.begin(), streams_.end(), [&](const auto& stream) {
        return stream && stream->device() == device &&
               stream->attachment().terms.capacity.representations == 0;
    }));
}

/// One of a process's observers of a device is the bridge's own (ReportNotifier).
void Peer::require_share(const protocol::ClaimRequest& request, const PeerContext& context) const {
    if (!key_ || request.observe != protocol::observe_only) return;
    const auto [by_key, all] = context.observers_of(key_->name, request.device);
    const std::size_t most = protocol::max_observers_of_process - 1, left = most > all ? most - all : 0;
    if (by_key >= left)
        throw Error(
            Error::Kind::refused,
            detail::format("key '{}' observes this device {} times and leaves {} of the bridge's {}, and "
                           "nobody may hold more than he leaves; end one",
                           key_->name, by_key, left, most));
}

bool Peer::attach(std::span<const std::byte> payload, PeerContext& context) {
    Attach message;
    if (!take(payload, message)) return fail("an attach that is none");
    // The next number, not the lowest: late datagrams to an ended stream must not reach a new one.
    auto free = streams_.end();
    for (std::size_t i = 0; i < streams_.size() && free == streams_.end(); ++i) {
        const auto candidate =
            streams_.begin() + static_cast<std::ptrdiff_t>((next_stream_ + i) % streams_.size());
        if (!*candidate) free = candidate;
    }
    try {
        if (free == streams_.end())
            throw Error(
                Error::Kind::refused,
                detail::format("one connection holds up to {} claims and observers; connect once more",
                               max_streams));
        if (message.request.device >= link_->devices().size())
            throw Error(Error::Kind::no_such_device,
                        detail::format("device {} of {}", message.request.device, link_->devices().size()));
        if (!(message.report_rate >= 0 && message.report_rate <= 1e6))
            throw Error(
                Error::Kind::bad_parameters,
                detail::format("report_rate = {:g} Hz; give 0 (every report) to 1e6", message.report_rate));
        require_share(message.request, context);
        if (const auto reason = forbidden(message.request)) throw Error(Error::Kind::permission, *reason);
        message.request.delay_allowance = delay_allowance;
        const auto id = static_cast<std::uint32_t>(free - streams_.begin() + 1);
        auto errand = std::make_shared<AttachErrand>(link_, message.request);
        awaited_.ask(errand, [this, errand = errand.get(), id, rate = message.report_rate, &context] {
            return attached(*errand, id, rate, context);
        });
        return true;
    } catch (const Error& error) {
        return refuse(error) || fail("it does not read");
    }
}

bool Peer::attached(AttachErrand& errand, std::uint32_t id, double report_rate, PeerContext& context) {
    try {
        errand.require_answer();
        detail::Attachment& attachment = *errand.attachment;
        const Attached attached{.terms = attachment.terms, .device = attachment.device_index, .stream = id};
        next_stream_ = id;  // continue after this one
        streams_[id - 1] = std::make_unique<PeerStream>(id, std::move(attachment), report_rate);
        context.notifier.join(attached.device);
        if (const Report* last = context.notifier.last(attached.device)) streams_[id - 1]->note(*last);
        return frames_.send(static_cast<std::uint16_t>(FrameType::attached), 0, bytes_of(attached)) ||
               fail("it does not read");
    } catch (const Error& error) {
        return refuse(error) || fail("it does not read");
    }
}

void Peer::release(std::uint32_t id, PeerContext& context) noexcept {
    PeerStream* stream = stream_of(id);
    if (stream == nullptr) return;
    context.out.flush();  // queued datagrams point into the stream
    context.notifier.leave(stream->device());
    assets_.drop(id);
    link_->release(stream->attachment());
    streams_[id - 1].reset();
}

void Peer::close(PeerContext& context, Error::Kind kind, const std::string& text) noexcept {
    awaited_.abandon();
    for (std::uint32_t id = 1; id <= streams_.size(); ++id) release(id, context);
    if (frames_.state() == FrameStream::State::open && !text.empty()) refuse(Error(kind, text));
    frames_.close();
}

void Peer::say_gone(const std::string& text) noexcept {
    frames_.send(static_cast<std::uint16_t>(FrameType::gone), 0, std::as_bytes(std::span(text)));
}

std::string Peer::dropped() const {
    if (replayed_ + forged_ == 0) return {};
    return detail::format(
        "; dropped: {} datagrams that had come before or were too old, {} that were not its own", replayed_,
        forged_);
}

// ------------------------------------------------------------------------------------------- the data path

bool Peer::cycle(std::uint32_t device, const Report& report, std::uint64_t unseen, std::int64_t now,
                 PeerContext& context) noexcept {
    for (const auto& stream : streams_) {
        if (!stream || stream->device() != device) continue;
        const char* why = "";
        if (!stream->cycle(report, unseen, now, way(context), why)) {
            why_ = why;
            return false;
        }
    }
    return true;
}

void Peer::datagram(std::span<std::byte> datagram, const PeerAddress& from, std::int64_t now,
                    PeerContext& context) noexcept {
    if (!greeted()) return;
    const IncomingDatagrams::Opened opened = incoming_.open(datagram, windows_);
    if (opened.verdict != IncomingDatagrams::Verdict::good) {
        ++(opened.verdict == IncomingDatagrams::Verdict::foreign ? forged_ : replayed_);
        return;
    }
    heard_ns_ = now;
    longest_.came(datagram.size(), now);
    std::span<const std::byte> body = opened.body;
    if (opened.header.kind == DatagramKind::ping) {
        PingBody ping;
        if (!take(body, ping)) return;
        mtu_.came_through(ping.longest);
        const std::span<std::byte> room = context.out.room();
        const DatagramHeader header{.kind = DatagramKind::pong};
        const PongBody pong{.ping_sent_ns = ping.sent_ns,
                            .received_ns = now,
                            .sent_ns = detail::monotonic_ns(),
                            .longest = longest_.bytes(now)};
        // As long as the ping, so that a narrow path is found in both directions, and no answer is longer
        // than its request. The buffer may hold another peer's bytes, so the padding is cleared.
        const std::size_t least = write(room, header, pong);
        const std::size_t bytes =
            std::clamp(sizeof header + opened.body.size(), least, room.size() - tag_bytes);
        std::memset(room.data() + least, 0, bytes - least);
        if (const std::size_t length = outgoing_.close(room, bytes)) context.out.put(length, from, nullptr);
        return;
    }
    PeerStream* stream = stream_of(opened.header.stream);
    if (stream == nullptr) return;
    HelloBody hello;
    if (opened.header.kind == DatagramKind::batch) {
        stream->batch_piece(opened.header, body);
    } else if (opened.header.kind == DatagramKind::hello && take(body, hello)) {
        stream->bind(from);
        if (hello.received == 0) stream->repeat(way(context));
    }
}

}  // namespace knurl::bridge
