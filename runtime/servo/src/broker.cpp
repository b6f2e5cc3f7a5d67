#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/socket.hpp>

#include "broker_impl.hpp"

namespace knurl::servo {

namespace {

constexpr auto collect_interval = std::chrono::milliseconds(10);
constexpr auto ramp_interval = std::chrono::milliseconds(2);
constexpr auto accept_pause = std::chrono::milliseconds(100);  // after the process has run out of descriptors

}  // namespace

void Broker::Impl::watch(int fd, std::uint64_t source) {
    epoll_event event{.events = EPOLLIN, .data = {.u64 = source}};
    if (epoll_ctl(epoll.get(), EPOLL_CTL_ADD, fd, &event) != 0) {
        throw std::runtime_error(fmt::format("knurld: epoll: {}", std::strerror(errno)));
    }
}

void Broker::Impl::update_listening() {
    const bool wanted = half_open < broker_bounds::half_open && SteadyClock::now() >= pause_until;
    if (wanted == listening_now) return;
    if (wanted) {
        watch(options.listener.get(), listening);
    } else {
        epoll_ctl(epoll.get(), EPOLL_CTL_DEL, options.listener.get(), nullptr);
    }
    listening_now = wanted;
}

void Broker::Impl::accept_one() {
    shm::UniqueFd socket;
    try {
        socket = shm::accept_from(options.listener);
    } catch (const std::runtime_error&) {
        pause_until = SteadyClock::now() + accept_pause;  // out of descriptors: wait until a client
                                                          // leaves
        tell_one_why();
        return;
    }
    if (!socket) return;
    Connection connection{.socket = std::move(socket),
                          .since = SteadyClock::now(),
                          .greeted = false,
                          .offering = false,
                          .peer = {},
                          .holdings = {},
                          .recording = {},
                          .watching = {}};
    const std::uint64_t id = next_id++;
    try {
        const auto credentials = shm::credentials_of(connection.socket);
        connection.peer.pid = credentials.pid;
        connection.peer.uid = credentials.uid;
        options.deaths.watch(id, connection.socket.get());
        watch(connection.socket.get(), id);
    } catch (const std::runtime_error&) {
        pause_until = SteadyClock::now() + accept_pause;  // the kernel has no room for another connection
        options.deaths.forget(id, connection.socket.get());
        closer.close(std::move(connection.socket));
        return;
    }
    connections.emplace(id, std::move(connection));
    ++half_open;
}

void Broker::Impl::tell_one_why() {
    spare.reset();
    try {
        if (shm::UniqueFd socket = shm::accept_from(options.listener)) {
            protocol::Refused no_descriptor{.full = 1};
            protocol::put_text(no_descriptor.text,
                               fmt::format("servo \"{}\" has no descriptor left for one more client; end "
                                           "one, or raise its limit "
                                           "(ulimit -n; of the service: LimitNOFILE=)",
                                           options.servo_name));
            shm::send_message(socket, bytes_of(no_descriptor));
            closer.close(std::move(socket));
        }
    } catch (const std::runtime_error&) {  // the system is out of descriptors: the callers wait
    }
    spare = spare_descriptor();
}

shm::UniqueFd Broker::Impl::spare_descriptor() {
    return shm::UniqueFd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

void Broker::Impl::close(std::uint64_t id) {
    const auto found = connections.find(id);
    if (found == connections.end()) return;
    for (Connection::Holding& holding : found->second.holdings) take_back(id, holding);
    const bool built_for = assets.cancel(id, tables);
    if (const auto device = found->second.recording) recordings[*device].end(tables[*device]->device());
    if (const auto device = found->second.watching) scenes[*device].end(tables[*device]->device());
    if (!found->second.greeted) --half_open;
    options.deaths.forget(id, found->second.socket.get());
    // Others hold the socket until the closer has closed it, so it leaves the epoll set now.
    epoll_ctl(epoll.get(), EPOLL_CTL_DEL, found->second.socket.get(), nullptr);
    closer.close(std::move(found->second.socket));
    connections.erase(found);
    if (built_for) tell_builders();  // e.g. the builder of the next asset could not be started
}

void Broker::Impl::begin_to_end(End why) {
    if (ending) {
        if (why == End::asked) ending = End::at_once;
        return;
    }
    ending = why;
    ending_since = SteadyClock::now();
    asked_to_end.assign(tables.size(), false);
}

bool Broker::Impl::at_rest() {
    if (SteadyClock::now() - ending_since > std::chrono::duration<double>(broker_bounds::ramp_down_seconds)) {
        return true;
    }
    bool rest = true;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const HostedDevice& device = tables[i]->device();
        if (!asked_to_end[i]) asked_to_end[i] = device.servo.drop_all();
        const shm::BroadcastReader reports(device.segment.data() + protocol::device_layout().reports,
                                           protocol::report_slots, sizeof(Report));
        Report report;
        const bool known = reports.published() > 0 && reports.at(reports.published() - 1, &report);
        rest = rest && asked_to_end[i] && known && report.state != DeviceState::ramp_up &&
               report.state != DeviceState::active && report.state != DeviceState::ramp_down;
    }
    return rest;
}

void Broker::Impl::drop_silent_callers() {
    if (half_open == 0) return;
    const auto latest = SteadyClock::now() - std::chrono::duration<double>(broker_bounds::hello_seconds);
    std::vector<std::uint64_t> silent;
    for (const auto& [id, connection] : connections) {
        if (!connection.greeted && connection.since < latest) silent.push_back(id);
    }
    for (std::uint64_t id : silent) {
        refuse(connections.at(id),
               RequestRefused(fmt::format("attach: no Hello within {:g} s", broker_bounds::hello_seconds)));
        close(id);
    }
}

void Broker::Impl::answer(std::uint64_t source) {
    switch (source) {
        case listening:
            return accept_one();
        case signalled: {
            signalfd_siginfo signal;
            if (read(options.signals.get(), &signal, sizeof signal) == sizeof signal)
                begin_to_end(End::asked);
            return;
        }
        case built:
            return tell_builders();
        case guardian_gone:
            epoll_ctl(epoll.get(), EPOLL_CTL_DEL, options.guardian_pidfd, nullptr);
            return begin_to_end(End::guardian_died);
        default:
            serve(source);
    }
}

int Broker::Impl::patience_ms(bool collecting) const {
    using std::chrono::milliseconds;
    auto patience = milliseconds(-1);
    const auto at_most = [&](milliseconds t) { patience = patience.count() < 0 ? t : std::min(patience, t); };
    if (ending) at_most(ramp_interval);
    if (collecting) at_most(collect_interval);
    if (half_open > 0 || unmapped > 0 || pause_until > SteadyClock::now()) at_most(accept_pause);
    return static_cast<int>(patience.count());
}

Broker::Broker(BrokerOptions options, std::vector<HostedDevice> devices, shm::Waker& waker)
    : impl_(std::make_unique<Impl>(std::move(options))) {
    for (HostedDevice& device : devices) {
        impl_->tables.push_back(std::make_unique<ClaimTable>(std::move(device), waker, impl_->memory));
    }
    impl_->watch(impl_->options.signals.get(), signalled);
    if (impl_->options.guardian_pidfd >= 0) impl_->watch(impl_->options.guardian_pidfd, guardian_gone);
}

Broker::~Broker() = default;

Broker::End Broker::run() {
    for (;;)
        if (const auto end = turn()) return *end;
}

std::optional<Broker::End> Broker::turn(int most_ms) {
    Impl& self = *impl_;
    bool collecting = false;
    for (const auto& table : self.tables) collecting |= table->collect();
    self.drop_silent_callers();
    self.take_back_unmapped();
    self.update_listening();
    if (self.ending && (*self.ending == End::at_once || self.at_rest())) return *self.ending;

    const int patience = self.patience_ms(collecting);
    std::array<epoll_event, 32> events;
    const int count = epoll_wait(self.epoll.get(), events.data(), static_cast<int>(events.size()),
                                 most_ms >= 0 && (patience < 0 || patience > most_ms) ? most_ms : patience);
    if (count < 0 && errno != EINTR)
        throw std::runtime_error(fmt::format("knurld: epoll_wait: {}", std::strerror(errno)));
    for (int i = 0; i < count; ++i) self.answer(events[static_cast<std::size_t>(i)].data.u64);
    return std::nullopt;
}

}  // namespace knurl::servo
