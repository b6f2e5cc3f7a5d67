#include "client_state.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <knurl/bridge/remote.hpp>
#include <knurl/client/error.hpp>
#include <knurl/link/local.hpp>
#include <knurl/link/text.hpp>
#include <knurl/link/thread.hpp>
#include <knurl/protocol/servo_address.hpp>

#include "address.hpp"
#include "hint.hpp"
#include "reader.hpp"

namespace knurl::detail {

namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds answer_time{2000};  // the broker, or the bridge, is given this long
constexpr milliseconds first_try{10};      // between attempts to reach a servo that starts
constexpr milliseconds last_try{160};      // between attempts at a full servo, since each costs it work
constexpr milliseconds short_retry{20};    // right after a hang-up, so that the client is back within 500 ms
constexpr milliseconds long_retry{250};
constexpr milliseconds retry_shortly_for{30'000};

/// The servo is starting, or it is full and another client may leave.
bool may_pass(const Error& error) {
    return error.kind == Error::Kind::no_servo || error.kind == Error::Kind::disconnected ||
           error.kind == Error::Kind::refused;
}

/// Names the running servos if the requested one does not run.
std::string instead_of(const std::string& servo, const Error& error) {
    if (error.kind != Error::Kind::no_servo || protocol::running_servos().empty()) return {};
    return "; " + protocol::instead_of_servo(protocol::servo_address(servo).name);
}

}  // namespace

ClientState::ClientState(const std::string& address, const ConnectOptions& options)
    : registry_(registry_part(address)),
      bridge_(registry_ ? std::vector<bridge::Endpoint>{} : bridge_endpoints(address)),
      servo_(registry_         ? registry_->servo
             : bridge_.empty() ? servo_name(address)
                               : bridge_.front().text),
      options_(options),
      hints_(hints_wanted(options.hints)),
      stop_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (!stop_)
        throw Error(Error::Kind::exhausted,
                    "this process has no descriptor left to connect with; raise the limit (ulimit -n)");
    const auto deadline = Clock::now() + options_.wait;
    for (milliseconds pause = first_try; !link_;) {
        try {
            link_ = open_link();
        } catch (const Error& error) {
            if (!may_pass(error)) throw;
            const auto left = std::chrono::floor<milliseconds>(deadline - Clock::now());
            if (left < first_try)
                throw Error(error.kind,
                            detail::format(
                                "{} (waited {} ms{})", error.what(), options_.wait.count(),
                                bridge_.empty() && !registry_ ? instead_of(servo_, error) : std::string()));
            std::this_thread::sleep_for(std::min(pause, left));
            if (error.kind == Error::Kind::refused) pause = std::min(2 * pause, last_try);
        }
    }
    watcher_ = start_thread(
        "knurl-watcher", [](void* self) { static_cast<ClientState*>(self)->watch(); }, this);
}

std::unique_ptr<Link> ClientState::open_link() const {
    if (!registry_) return open_link(servo_, bridge_);
    // A servo that came back may have another address.
    const std::string address = where_registry_says(*registry_);
    const std::vector<bridge::Endpoint> bridge = bridge_endpoints(address);
    return open_link(bridge.empty() ? servo_name(address) : bridge.front().text, bridge);
}

std::unique_ptr<Link> ClientState::open_link(const std::string& servo,
                                             const std::vector<bridge::Endpoint>& bridge) const {
    const std::string name = options_.name.empty() ? program_invocation_short_name : options_.name;
    if (bridge.empty()) return connect_local(servo, name, answer_time);
    const char* key = std::getenv("KNURL_KEY");
    return bridge::connect_remote(
        bridge, {.client_name = name,
                 .answer_time = answer_time,
                 .report_rate = options_.report_rate,
                 .key_file = options_.key_file.empty() && key != nullptr ? key : options_.key_file});
}

void ClientState::throw_disconnected() const {
    throw Error(Error::Kind::disconnected,
                detail::format("{} ({})", lost_,
                               options_.reattach ? "it is tried again and again" : "then connect again"));
}

std::vector<DeviceDescription> ClientState::devices() {
    require_own(made_in_);
    const Lock lock(mutex_);
    if (!link_) throw_disconnected();
    return link_->devices();
}

pid_t ClientState::servo_pid() {
    require_own(made_in_);
    const Lock lock(mutex_);
    return link_ ? link_->servo_pid() : 0;
}

bool ClientState::connected() {
    require_own(made_in_);
    const Lock lock(mutex_);
    return link_ != nullptr;
}

std::string ClientState::resolve(const std::string& said) {
    const std::string device = said.empty() && registry_ ? registry_->device : said;
    const std::vector<DeviceDescription> all = devices();
    std::vector<std::string> names;
    for (const DeviceDescription& each : all) {
        if (each.name == device) return device;
        names.push_back(each.name);
    }
    if (device.empty() && names.size() == 1) return names.front();
    throw Error(Error::Kind::no_such_device,
                names.empty()    ? detail::format("servo '{}' has no device; start it with --device", servo_)
                : device.empty() ? detail::format("servo '{}' has {} devices; say which one: {}", servo_,
                                                  names.size(), fmt::join(names, ", "))
                                 : detail::format("servo '{}' has no device '{}'; {}", servo_, device,
                                                  protocol::instead_of_device(device, names)));
}

void ClientState::join(Reader& reader) {
    require_own(made_in_);
    const Lock lock(mutex_);
    if (!link_) throw_disconnected();
    attach_one(reader);
    readers_.push_back(&reader);
}

void ClientState::attach_one(Reader& reader) {
    const auto& devices = link_->devices();
    const auto device = std::find_if(devices.begin(), devices.end(), [&](const DeviceDescription& each) {
        return each.name == reader.device_name();
    });
    if (device == devices.end())
        throw Error(Error::Kind::no_such_device,
                    detail::format("servo '{}' has no device '{}' any more", servo_, reader.device_name()));
    Attachment attachment =
        link_->attach(static_cast<std::uint32_t>(device - devices.begin()), reader.request());
    try {
        reader.attach(attachment);
    } catch (...) {
        link_->release(attachment);
        throw;
    }
}

void ClientState::leave(Reader& reader) {
    const Lock lock(mutex_);
    if (std::erase(readers_, &reader) == 0) return;
    const std::optional<Attachment> old = reader.detach();
    if (old && link_) link_->release(*old);
}

void ClientState::close() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_.get(), &one, sizeof one);
    ::pthread_join(watcher_, nullptr);
}

bool ClientState::stopping() const noexcept {
    pollfd asked{.fd = stop_.get(), .events = POLLIN, .revents = 0};
    return ::poll(&asked, 1, 0) > 0;
}

bool ClientState::sleep_on(int descriptor, milliseconds timeout) {
    pollfd events[] = {{.fd = stop_.get(), .events = POLLIN, .revents = 0},
                       {.fd = descriptor, .events = POLLRDHUP, .revents = 0}};
    ::poll(events, 2, static_cast<int>(timeout.count()));
    return events[0].revents == 0;
}

void ClientState::watch() {
    constexpr milliseconds forever{-1};
    // Only this thread replaces link_, so it may read it here without the lock.
    while (sleep_on(link_->hang_up(), forever)) {
        lose_link();
        if (!options_.reattach) return;
        const auto lost_at = Clock::now();
        const auto attached = [this] {
            return link_ &&
                   std::all_of(readers_.begin(), readers_.end(), [](Reader* r) { return r->connected(); });
        };
        for (;;) {
            reattach();
            const int hang_up = link_ ? link_->hang_up() : -1;
            {
                const Lock lock(mutex_);
                if (attached()) break;
            }
            const bool recently = Clock::now() - lost_at < retry_shortly_for;
            if (!sleep_on(hang_up, recently && !hopeless_ ? short_retry : long_retry)) return;
        }
    }
}

void ClientState::lose_link() {
    const std::string why = link_->why_it_ended();
    const Lock lock(mutex_);
    link_.reset();
    hopeless_ = false;
    note_loss(why);  // before any caller can find the servo gone
    for (Reader* reader : readers_) {
        reader->detach();
        if (!options_.reattach) reader->give_up(why + " (then connect again)");
    }
}

/// With the lock held: the message of every call that needs the servo until it is back.
void ClientState::note_loss(const std::string& why) {
    lost_ = why;
    for (Reader* reader : readers_) reader->note_loss(why);
}

void ClientState::reattach() {
    std::unique_ptr<Link> fresh;
    try {
        // Without the lock: where nobody answers, opening takes seconds.
        if (!link_) fresh = open_link();
    } catch (const Error& error) {
        const Lock lock(mutex_);
        // A person must act there first; fast attempts would fill the other side's log.
        hopeless_ = error.kind == Error::Kind::permission || error.kind == Error::Kind::incompatible;
        // "Nobody listens" says less than the reason of the loss.
        if (hopeless_) note_loss(error.what());
        return;
    } catch (const std::exception&) {
        return;  // not there yet
    }
    const Lock lock(mutex_);
    if (fresh) link_ = std::move(fresh);
    for (Reader* reader : readers_) {
        if (reader->connected()) continue;
        try {
            attach_one(*reader);
        } catch (const Error& error) {
            // Another client was faster to claim, or the device is missing: the next round tries again.
            reader->note_loss(error.what());
            if (error.kind != Error::Kind::disconnected) continue;
            link_.reset();
            for (Reader* lost : readers_) lost->detach();
            return;
        }
    }
}

}  // namespace knurl::detail
