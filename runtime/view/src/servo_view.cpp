#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <grp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <knurl/protocol/text.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/counters.hpp>
#include <knurl/shm/socket.hpp>
#include <knurl/view/servo_view.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::view {

namespace {

std::string name_of(const std::string& socket) {
    return std::filesystem::path(socket).stem().string();
}

/// One row, or none if it is free. The broker writes the identity between two odd-even steps of `sequence`;
/// each word of the servo is consistent by itself.
std::optional<ClientView> read_row(const protocol::ClientRow& row) {
    constexpr int attempts = 100;  // an identity changes only when a client comes or goes
    ClientView view;
    for (int i = 0; i < attempts; ++i) {
        // pairs with the broker's release
        const std::uint64_t before = row.sequence.load(std::memory_order_acquire);
        std::uint64_t name[protocol::name_bytes / 8];
        // Each acquire keeps the second read of `sequence` behind it, so a change by the broker is detected.
        const std::uint64_t pid = row.pid.load(std::memory_order_acquire);
        const std::uint64_t role = row.role.load(std::memory_order_acquire);
        const std::uint64_t shared = row.shared.load(std::memory_order_acquire);
        for (std::size_t word = 0; word < std::size(name); ++word)
            name[word] = row.name[word].load(std::memory_order_acquire);
        if (before % 2 != 0 || row.sequence.load(std::memory_order_relaxed) != before) continue;
        if (before == 0 || pid == 0) return std::nullopt;
        char text[protocol::name_bytes];
        std::memcpy(text, name, sizeof text);
        view.name = protocol::text_of(text);
        view.pid = static_cast<pid_t>(pid);
        view.observer = role == 2;
        view.shared = shared != 0;
        break;
    }
    if (view.pid == 0) return std::nullopt;
    const auto word = [](const std::atomic<std::uint64_t>& value) {
        return value.load(std::memory_order_relaxed);
    };
    view.armed = word(row.armed) != 0;
    view.shed = word(row.shed) != 0;
    view.silent = word(row.silent) != 0;
    const double interval = static_cast<double>(word(row.interval_ns)) * 1e-9;
    view.update_rate = interval > 0 ? 1 / interval : 0;
    view.age = static_cast<double>(word(row.age_ns)) * 1e-9;
    view.gain = static_cast<double>(word(row.gain_ppm)) * 1e-6;
    const auto left = [&](const std::atomic<std::uint64_t>& cut) {
        return 1 - static_cast<double>(word(cut)) * 1e-6;
    };
    view.scales = {left(row.contacts_cut_ppm), left(row.effects_cut_ppm), left(row.damping_cut_ppm)};
    view.commits = word(row.commits);
    view.refused = word(row.refused);
    view.merged = word(row.merged);
    view.missed = word(row.missed);
    for (std::size_t kind = 0; kind < kinds().size(); ++kind) view.present.push_back(word(row.present[kind]));
    return view;
}

DeviceView look_at_device(const std::byte* memory) {
    constexpr auto layout = protocol::device_layout();
    DeviceView view;
    std::memcpy(&view.info, memory + layout.info, sizeof view.info);
    const shm::CountersReader counters(memory + layout.counters, protocol::count_names);
    for (std::size_t i = 0; i < counters.size(); ++i)
        view.counters[std::string(counters.name(i))] = counters.read(i);
    shm::BroadcastReader reports(memory + layout.reports, protocol::report_slots, sizeof(Report));
    Report report;
    if (reports.latest(&report)) view.report = report;
    const auto* rows = reinterpret_cast<const protocol::ClientRow*>(memory + layout.clients);
    for (std::uint32_t i = 0; i < protocol::max_clients; ++i) {
        auto client = read_row(rows[i]);
        if (!client) continue;
        client->row = i;
        view.clients.push_back(std::move(*client));
    }
    return view;
}

}  // namespace

void receive_answer(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time,
                    protocol::MessageType expected, std::span<std::byte> message,
                    std::vector<shm::UniqueFd>& fds) {
    pollfd wait{.fd = connection.get(), .events = POLLIN, .revents = 0};
    if (::poll(&wait, 1, static_cast<int>(answer_time.count())) <= 0)
        throw std::runtime_error("the servo does not answer; is it stopped?");

    alignas(8) std::byte buffer[std::max(sizeof(protocol::Welcome), sizeof(protocol::Refused))];
    auto received = shm::receive_message(connection, buffer);
    if (received.descriptors_lost)
        throw shm::SystemError(
            "the servo answers, but this process has no descriptor left for the memory that it sends; "
            "raise the limit (ulimit -n)",
            EMFILE);
    protocol::MessageHeader header;
    if (received.closed || received.bytes < sizeof header) throw std::runtime_error("the servo hung up");
    std::memcpy(&header, buffer, sizeof header);
    if (header.magic == protocol::attach_magic && header.type == protocol::MessageType::refused &&
        received.bytes == sizeof(protocol::Refused)) {
        protocol::Refused refused;
        std::memcpy(&refused, buffer, sizeof refused);
        throw std::runtime_error(protocol::text_of(refused.text));
    }
    if (header.magic != protocol::attach_magic || header.type != expected || received.bytes != message.size())
        throw std::runtime_error("the program that listens there is no servo of this version of Knurl");
    std::memcpy(message.data(), buffer, message.size());
    fds = std::move(received.fds);
}

protocol::Welcome greet(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time,
                        std::vector<shm::UniqueFd>& segments) {
    protocol::Hello hello;
    hello.layout = protocol::wire_hash();
    protocol::put_text(hello.client, "knurl");
    if (!shm::send_message(connection, std::as_bytes(std::span(&hello, 1)))) {
        throw std::runtime_error("the servo hung up");
    }
    const auto welcome =
        answer<protocol::Welcome>(connection, protocol::MessageType::welcome, answer_time, segments);
    if (welcome.devices != segments.size() || welcome.devices > protocol::max_devices) {
        throw std::runtime_error("the servo sent no memory for its devices");
    }
    return welcome;
}

std::size_t chosen_device(const std::string& servo, const std::vector<std::string>& names,
                          const std::string& wanted) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (wanted.empty() ? names.size() == 1 : names[i] == wanted) return i;
    throw std::runtime_error(wanted.empty() ? fmt::format("servo '{}' has {} devices; say which one: {}",
                                                          servo, names.size(), fmt::join(names, ", "))
                                            : fmt::format("servo '{}' has no device '{}'; {}", servo,
                                                          words::printable(wanted),
                                                          protocol::instead_of_device(wanted, names)));
}

shm::UniqueFd connect_to_servo(const protocol::ServoAddress& servo) {
    try {
        return shm::connect_to(servo.socket);
    } catch (const std::runtime_error& error) {
        const std::vector<std::string> running = protocol::running_servos();
        if (std::find(running.begin(), running.end(), servo.name) != running.end()) throw;
        throw std::runtime_error(std::string(error.what()) + "; " + protocol::instead_of_servo(servo.name));
    }
}

ServoWatch::ServoWatch(const std::string& socket, std::chrono::milliseconds answer_time) : socket_(socket) {
    attach(shm::connect_to(socket), answer_time);
}

ServoWatch::ServoWatch(const protocol::ServoAddress& servo) : socket_(servo.socket) {
    attach(connect_to_servo(servo), std::chrono::seconds(2));
}

void ServoWatch::attach(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time) {
    std::vector<shm::UniqueFd> descriptors;
    const auto welcome = greet(connection, answer_time, descriptors);
    pid_ = static_cast<pid_t>(welcome.servo_pid);
    for (const auto& descriptor : descriptors) {
        segments_.push_back(shm::Segment::open(descriptor.get(), protocol::device_layout().total,
                                               shm::Segment::Access::read_only));
        reports_.emplace_back(segments_.back().data() + protocol::device_layout().reports,
                              protocol::report_slots, sizeof(Report));
    }
}

ServoView ServoWatch::look() const {
    ServoView view{.name = name_of(socket_),
                   .socket = socket_,
                   .problem = {},
                   .dead = false,
                   .unseen = false,
                   .pid = pid_,
                   .devices = {}};
    for (const auto& segment : segments_) view.devices.push_back(look_at_device(segment.data()));
    return view;
}

std::vector<std::vector<Report>> ServoWatch::new_reports() {
    std::vector<std::vector<Report>> all;
    for (shm::BroadcastReader& reader : reports_) {
        std::vector<Report>& reports = all.emplace_back();
        Report report;
        while (reports.size() < protocol::report_slots && reader.next(&report)) reports.push_back(report);
    }
    return all;
}

std::vector<Report> ServoWatch::history(std::size_t device) const {
    const shm::BroadcastReader reader(segments_[device].data() + protocol::device_layout().reports,
                                      protocol::report_slots, sizeof(Report), 0);
    const std::uint64_t end = reader.published(), held = protocol::report_slots - 1;
    std::vector<Report> all;
    Report report;
    for (std::uint64_t n = end > held ? end - held : 0; n < end; ++n) {
        // The servo overwrites the oldest meanwhile.
        if (reader.at(n, &report)) all.push_back(report);
    }
    return all;
}

namespace {

ServoView not_seen(const std::string& socket, const std::string& why) {
    return {.name = name_of(socket),
            .socket = socket,
            .problem = why,
            .dead = false,
            .unseen = false,
            .pid = 0,
            .devices = {}};
}

/// What to do about another user's folder.
std::string who_may_look(const std::string& directory) {
    struct stat status {};
    const ::group* owners = ::stat(directory.c_str(), &status) == 0 ? ::getgrgid(status.st_gid) : nullptr;
    if (owners == nullptr || status.st_gid == 0 || (status.st_mode & S_IXGRP) == 0)
        return "run this as the folder's owner";
    return fmt::format("join its group (sudo usermod --append --groups {} $USER, then log in again)",
                       owners->gr_name);
}

}  // namespace

std::vector<ServoView> look_at_all() {
    std::vector<ServoView> views;
    for (const std::string& directory : protocol::servo_directories()) {
        std::error_code none;
        for (auto file = std::filesystem::directory_iterator(directory, none);
             !none && file != std::filesystem::directory_iterator(); file.increment(none)) {
            if (file->path().extension() != ".sock") continue;
            const std::string socket = file->path().string();
            try {
                views.push_back(ServoWatch(socket).look());
            } catch (const shm::SystemError& error) {
                views.push_back(not_seen(socket, error.what()));
                views.back().dead = error.error == ECONNREFUSED;
                views.back().unseen = error.error != ECONNREFUSED && error.error != ENOENT;
            } catch (const std::runtime_error& error) {
                views.push_back(not_seen(socket, error.what()));
            }
        }
        if (none && none != std::errc::no_such_file_or_directory && none != std::errc::not_a_directory) {
            // A user without access to the service's folder still sees servos in other folders.
            const std::string remedy =
                none == std::errc::permission_denied
                    ? who_may_look(directory)
                    : "this process has no descriptor left: raise its limit (ulimit -n)";
            views.push_back(
                not_seen(directory, directory + " cannot be looked into: " + none.message() + "; " + remedy));
            views.back().name = "?";
            views.back().unseen = true;
        }
    }
    std::sort(views.begin(), views.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return views;
}

}  // namespace knurl::view
