// knurl record --room NAME=ADDRESS ...: the reports of devices in several rooms, into one file with one time base: this
// host's CLOCK_REALTIME. A room's clock is its servo's CLOCK_MONOTONIC, which the client library compares with this host's
// (Network::clock_offset). The file states each comparison, so that who reads it knows how sure the times are.

#include "record_rooms.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <poll.h>

#include <knurl/client/client.hpp>
#include <knurl/commandline/command.hpp>
#include <knurl/json/json.hpp>
#include <knurl/measure/progress.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/recording/report_channels.hpp>

namespace knurl::cli {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int drain_every = 10;                          // ms; the rings hold seconds
constexpr auto compare_every = std::chrono::seconds(1);  // clocks
constexpr const char* clocks_topic = "/knurl/clocks";
constexpr std::size_t most_rooms = 64;

template <class Any>
std::int64_t ns_of() {
    return std::chrono::nanoseconds(Any::now().time_since_epoch()).count();
}

/// "left=knurl://lab/left", "left=knurl:lab,left".
struct Said {
    std::string name, address, device;  // no device: the only one, or the one that the address names
};

Said parts_of(const std::string& said, std::set<std::string>& names) {
    const std::size_t equals = said.find('=');
    const auto wrong = [&](const std::string& what) {
        return commandline::UsageError(fmt::format("--room {}: {}", said, what));
    };
    if (equals == std::string::npos || equals + 1 == said.size())
        throw wrong("give NAME=ADDRESS or NAME=ADDRESS,DEVICE, as left=knurl://lab/left");
    const std::size_t comma = said.find(',', equals);
    Said parts{.name = said.substr(0, equals),
               .address = said.substr(equals + 1, comma == std::string::npos ? comma : comma - equals - 1),
               .device = comma == std::string::npos ? "" : said.substr(comma + 1)};
    if (parts.name.empty() || messages::ros_name(parts.name) != parts.name)
        throw wrong("a room's name is of letters, digits and _, since it is in topics");
    if (!names.insert(parts.name).second) throw wrong("another room has that name");
    return parts;
}

/// One device.
class Room {
  public:
    explicit Room(const Said& said) try
        : name_(said.name),
          address_(said.address),
          client_(Client::connect(address_, {.name = "knurl record", .hints = false})),
          observer_(client_.observe(said.device)) {
        compare();
    } catch (const Error& error) {
        throw std::runtime_error(fmt::format("room {}: {}", said.name, error.what()));
    }

    void open(recording::McapWriter& file, const Room* sibling) {
        channels_.emplace(file, name_, 0, sibling == nullptr ? nullptr : &*sibling->channels_);
        const DeviceDescription device = observer_.device();
        recording::McapMetadata about = clock_words();
        about["address"] = address_;
        about["device"] = device.name;
        about["device_address"] = device.address;
        about["profile"] = device.profile;
        about["rate"] = fmt::format("{:g}", device.rate);
        file.add_metadata("knurl room " + name_, about);
    }
    /// Moves what is new into the file.
    void drain(const recording::McapWriter& file, std::int64_t realtime_offset) {
        std::array<HandReport, 256> reports;
        while (!file.full()) {
            const std::size_t got = observer_.drain(reports);
            for (std::size_t i = 0; i < got; ++i) {
                last_ns_ = reports[i].read_ns - offset_ + realtime_offset;
                if (count_++ == 0) first_ns_ = last_ns_;
                channels_->write(reports[i], last_ns_);
            }
            if (got < reports.size()) return;
        }
    }
    /// Compares the clocks. A room that is gone keeps its last comparison.
    void compare() {
        if (!observer_.connected()) return;
        try {
            const Network network = observer_.network();
            offset_ = network.clock_offset.count();
            uncertainty_ = network.clock_uncertainty.count();
            drift_ = network.drift;
            round_trip_ = network.round_trip.count();
        } catch (const Error&) {  // it went at this moment
        }
    }
    std::string clock_message() const {
        Json one = Json::object();
        one["room"] = name_;
        for (const auto& [key, value] : clock_words()) one[key] = Json::parse(value);
        return one.dump();
    }
    /// A line, when it has gone or come back.
    std::string news() {
        const bool there = observer_.connected();
        if (there == std::exchange(was_there_, there)) return {};
        return fmt::format("room {}: its servo is {}", name_, there ? "back" : "gone; waiting for it");
    }
    std::string summary() const {
        return fmt::format("{}: {} reports in {:.1f} s, {} missed; clock within {:.3f} ms", name_, count_,
                           static_cast<double>(last_ns_ - first_ns_) * 1e-9, observer_.missed(),
                           static_cast<double>(uncertainty_) * 1e-6);
    }
    std::uint64_t count() const { return count_; }

  private:
    recording::McapMetadata clock_words() const {
        return {{"clock_offset_ns", std::to_string(offset_)},
                {"clock_uncertainty_ns", std::to_string(uncertainty_)},
                {"clock_drift", fmt::format("{:.9g}", drift_)},
                {"round_trip_ns", std::to_string(round_trip_)}};
    }

    std::string name_, address_;
    Client client_;
    Observer observer_;
    std::optional<recording::ReportChannels> channels_;
    std::int64_t offset_ = 0, uncertainty_ = 0, round_trip_ = 0;  // ns
    double drift_ = 0;
    std::uint64_t count_ = 0;
    std::int64_t first_ns_ = 0, last_ns_ = 0;
    bool was_there_ = true;
};

/// The file, and what goes into it.
class Rooms {
  public:
    explicit Rooms(const RoomsArguments& arguments) {
        if (arguments.rooms.size() > most_rooms)
            throw commandline::UsageError(fmt::format("--room: {} at most", most_rooms));
        std::set<std::string> names;
        std::vector<Said> said;
        for (const std::string& one : arguments.rooms) said.push_back(parts_of(one, names));
        // All of them are reached before there is a file.
        for (const Said& one : said) rooms_.push_back(std::make_unique<Room>(one));
        file_.emplace(arguments.file, std::string("Knurl ") + KNURL_VERSION, arguments.existing);
        for (const auto& room : rooms_)
            room->open(*file_, room == rooms_.front() ? nullptr : &*rooms_.front());
        clocks_ = file_->add_channel(clocks_topic, "json", nullptr);
        file_->add_metadata("knurl rooms", {{"version", KNURL_VERSION},
                                            {"rooms", fmt::format("{}", rooms_.size())},
                                            {"time_base", "CLOCK_REALTIME of the host that recorded"}});
        compare();
    }

    /// False: the disk is full; said once.
    bool drain() {
        // A clock that is set while it records would tear the rooms apart: one offset for all of them, from the beginning.
        for (const auto& room : rooms_) {
            room->drain(*file_, realtime_offset_);
            if (file_->full() && !flush()) return false;
        }
        return true;
    }
    void compare() {
        for (const auto& room : rooms_) {
            room->compare();
            const std::string message = room->clock_message();
            file_->message(clocks_, ns_of<Clock>() + realtime_offset_, std::as_bytes(std::span(message)), {});
        }
    }
    bool flush() { return file_->flush(); }
    bool finish() { return drain() && file_->flush() && file_->finish(); }
    const std::string& problem() const { return file_->problem(); }

    std::vector<std::string> news() {
        std::vector<std::string> lines;
        for (const auto& room : rooms_)
            if (std::string line = room->news(); !line.empty()) lines.push_back(std::move(line));
        return lines;
    }
    std::string so_far() const {
        std::uint64_t count = 0;
        for (const auto& room : rooms_) count += room->count();
        return fmt::format("{} reports of {} rooms, {:.1f} MB", count, rooms_.size(),
                           static_cast<double>(file_->bytes()) * 1e-6);
    }
    std::string summary() const {
        std::string text;
        for (const auto& room : rooms_) text += "\n  " + room->summary();
        return text;
    }

  private:
    std::vector<std::unique_ptr<Room>> rooms_;
    std::optional<recording::McapWriter> file_;
    std::uint16_t clocks_ = 0;
    const std::int64_t realtime_offset_ = ns_of<std::chrono::system_clock>() - ns_of<Clock>();
};

}  // namespace

int record_rooms(const RoomsArguments& arguments, int signals) {
    Rooms rooms(arguments);
    measure::Progress progress("knurl record");
    fmt::print(stderr, "knurl record: recording {} rooms into {}\n", arguments.rooms.size(), arguments.file);
    const auto begin = Clock::now();
    auto compared = begin;
    const auto over = [&](Clock::time_point now) {
        return arguments.seconds > 0 &&
               std::chrono::duration<double>(now - begin).count() >= arguments.seconds;
    };
    bool whole = true;
    pollfd wait{.fd = signals, .events = POLLIN, .revents = 0};
    for (auto now = begin; whole && wait.revents == 0 && !over(now); now = Clock::now()) {
        ::poll(&wait, 1, drain_every);
        whole = rooms.drain();
        for (const std::string& line : rooms.news()) {
            progress.clear();
            fmt::print(stderr, "knurl record: {}\n", line);
        }
        progress.show(fmt::format(
            "{}, {}",
            measure::seconds_of(std::chrono::duration<double>(now - begin).count(), arguments.seconds),
            rooms.so_far()));
        if (now - compared < compare_every) continue;
        compared = now;
        rooms.compare();
        whole = whole && rooms.flush();
    }
    whole = whole && rooms.finish();
    progress.clear();
    fmt::print("{}: {}{}\n", arguments.file, rooms.so_far(), rooms.summary());
    if (!whole) fmt::print(stderr, "knurl record: {}; what is in the file can be read\n", rooms.problem());
    return whole ? 0 : 1;
}

}  // namespace knurl::cli
