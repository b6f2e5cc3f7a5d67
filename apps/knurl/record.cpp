// knurl record: every report of a device and every input of its servo, into a file.

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <time.h>

#include <knurl/gateway/scene_notes.hpp>
#include <knurl/measure/progress.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/recording/recording.hpp>
#include <knurl/recording/salvage.hpp>
#include <knurl/shm/socket.hpp>
#include <knurl/view/servo_view.hpp>

#include "record_rooms.hpp"
#include "verbs.hpp"

namespace knurl::cli {

using recording::Existing;
using recording::RecordingInfo;
using recording::RecordingWriter;

namespace {

struct RecordArguments {
    std::string servo = "default", device, file, salvage;
    double seconds = 0;  // 0: until interrupted
    bool force = false;
    std::vector<std::string> rooms;
};

constexpr auto servo_answers_within = std::chrono::seconds(2);
constexpr int look_every = 10;                         // ms; the rings hold seconds
constexpr auto flush_every = std::chrono::seconds(1);  // the most that a crash of this program loses
constexpr std::uint64_t cycles_to_a_keyframe = 10;     // when nobody holds the device

std::int64_t clock_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

/// The shared memory of one device of a running servo: its reports and its input log.
class Source {
  public:
    Source(const protocol::ServoAddress& servo, const std::string& wanted)
        : connection_(connect_to_servo(servo)) {
        std::vector<shm::UniqueFd> segments;
        const protocol::Welcome welcome = greet(connection_, servo_answers_within, segments);
        const std::size_t device = choose(welcome, servo.name, wanted);
        reports_ = shm::Segment::open(segments[device].get(), protocol::device_layout().total,
                                      shm::Segment::Access::read_only);
        std::memcpy(&device_, reports_.data() + protocol::device_layout().info, sizeof device_);

        protocol::RecordRequest request;
        request.device = static_cast<std::uint32_t>(device);
        if (!shm::send_message(connection_, std::as_bytes(std::span(&request, 1))))
            throw std::runtime_error("the servo hung up");
        std::vector<shm::UniqueFd> input_log;
        const auto granted = answer<protocol::Recording>(connection_, protocol::MessageType::recording,
                                                         servo_answers_within, input_log);
        if (input_log.size() != 1) throw std::runtime_error("the servo sent no memory to record from");
        input_log_ = shm::Segment::open(input_log.front().get(), servo::input_log_bytes,
                                        shm::Segment::Access::read_only);
        inputs_.emplace(input_log_.data(), granted.from);
        reader_.emplace(reports_.data() + protocol::device_layout().reports, protocol::report_slots,
                        sizeof(Report));
        const servo::InputLogHeader header = inputs_->header();
        if (header.magic != servo::InputLogHeader::magic_word || header.layout != servo::input_log_layout())
            throw std::runtime_error("build mismatch: the servo's input log is of another build; restart it");
    }

    RecordingInfo info() const {
        RecordingInfo info;
        info.version = KNURL_VERSION;
        info.wire = protocol::wire_hash();
        info.input_log_layout = servo::input_log_layout();
        info.figures = inputs_->header().device_figures;
        info.servo = protocol::text_of(device_.servo);
        info.device = protocol::text_of(device_.name);
        info.address = protocol::text_of(device_.address);
        info.profile = protocol::text_of(device_.profile);
        info.joints = device_.joints;
        info.options = inputs_->header().options;
        info.realtime_offset_ns = clock_ns(CLOCK_REALTIME) - clock_ns(CLOCK_MONOTONIC);
        return info;
    }
    struct Sent {
        shm::UniqueFd source;
        std::uint64_t bytes = 0;
    };
    /// The source of a claim's asset, which the servo has announced. None: it could not get it.
    std::optional<Sent> sent(const protocol::AssetDigest& digest) {
        listen();
        const auto found = sent_.find(digest);
        if (found == sent_.end()) return std::nullopt;
        Sent result = std::move(found->second);
        sent_.erase(found);
        return result;
    }
    /// Reads the servo's messages. False: the servo has ended.
    bool listen() {
        for (;;) {
            protocol::RecordedAsset message;
            shm::Received received = shm::receive_message(
                connection_, std::as_writable_bytes(std::span(&message, 1)), shm::Block::no);
            if (received.nothing) return true;
            if (received.closed) return false;
            if (received.bytes != sizeof message || received.fds.size() != 1 ||
                message.header.type != protocol::MessageType::recorded_asset)
                continue;
            if (sent_.size() >= most_unclaimed) sent_.erase(sent_.begin());
            sent_[message.digest] = {.source = std::move(received.fds.front()), .bytes = message.bytes};
        }
    }
    servo::InputLogReader& inputs() { return *inputs_; }
    shm::BroadcastReader& reports() { return *reader_; }
    int socket() const { return connection_.get(); }
    double rate() const { return device_.rate; }

  private:
    static std::size_t choose(const protocol::Welcome& welcome, const std::string& servo,
                              const std::string& wanted) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < welcome.devices; ++i)
            names.push_back(protocol::printable(welcome.names[i]));
        return chosen_device(servo, names, wanted);
    }

    static constexpr std::size_t most_unclaimed = 64;  // announced, but not in the input log yet
    shm::UniqueFd connection_;
    std::map<protocol::AssetDigest, Sent> sent_;
    shm::Segment reports_, input_log_;
    protocol::DeviceInfo device_;
    std::optional<shm::BroadcastReader> reader_;
    std::optional<servo::InputLogReader> inputs_;
};

/// SIGINT and SIGTERM end the recording, not the program.
shm::UniqueFd take_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigprocmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is a full disk
    shm::UniqueFd fd(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
    if (!fd) throw std::runtime_error(std::string("signalfd: ") + std::strerror(errno));
    return fd;
}

/// Moves new data into the file, and tracks how much of it can be replayed.
class Recorder {
  public:
    Recorder(Source& source, RecordingWriter& file) : source_(source), file_(file) {}

    void drain() {
        // Reports first: the inputs of all reports there are available already.
        drain_reports(true);
        for (auto next = source_.inputs().next(record_); next != servo::InputLogReader::Next::nothing;
             next = source_.inputs().next(record_)) {
            next == servo::InputLogReader::Next::gap ? gap() : take();
            if (file_.full()) flush();
        }
    }
    void flush() {
        const std::uint64_t exact = std::exchange(unwritten_, 0);
        if (file_.flush()) {
            exact_cycles_ += exact;
            return;
        }
        say_lost();
    }
    /// After the servo's first cycle with the input log. A claim from now on is in a recording that replays;
    /// an earlier claim is not.
    void say_when_begun(const std::string& text) {
        if (inputs_ > 0 && !std::exchange(begun_, true)) fmt::print(stderr, "knurl record: {}\n", text);
    }
    /// Somebody holds the device: said once.
    void say_when_exact() {
        if (!has_to_say() || said_) return;
        said_ = true;
        fmt::print(
            stderr,
            "knurl record: an application holds the device: reports are recorded, exact replay begins when "
            "nobody holds it (start the recording before the application)\n");
    }
    bool has_to_say() const {
        return (inputs_ > 0 && !begun_) ||
               (!said_ && !exact_ && inputs_ >= cycles_to_a_keyframe && first_exact_ == 0);
    }
    bool lost() const { return lost_; }

    /// Progress so far.
    std::string so_far() const {
        return fmt::format("{} cycles, {:.1f} MB", reports_, static_cast<double>(file_.bytes()) * 1e-6);
    }
    /// Also takes the reports of the last inputs, so that all figures count the same cycles.
    void finish() {
        drain();
        drain_reports(true);
        flush();
    }
    std::string summary() const {
        const std::uint64_t missed = source_.reports().missed();
        std::string text = fmt::format("{} cycles in {:.1f} s, {:.1f} MB, {} reports missed", reports_,
                                       static_cast<double>(last_ns_ - first_ns_) * 1e-9,
                                       static_cast<double>(file_.bytes()) * 1e-6, missed);
        if (file_.dropped() > 0) text += fmt::format(", {} messages dropped (disk full)", file_.dropped());
        if (exact_cycles_ == 0)
            text += fmt::format("; does not replay: {}",
                                lost_ ? "the disk was full"
                                : inputs_ < cycles_to_a_keyframe
                                    ? "it ended before there was a moment to begin with"
                                    : "somebody held the device from the first cycle on");
        else
            text += fmt::format("; {} cycles replay exactly, from cycle {} on", exact_cycles_, first_exact_);
        if (file_.missing() > 0)
            text += fmt::format(", {} shape{} that {} felt {} missing", file_.missing(),
                                file_.missing() == 1 ? "" : "s", file_.missing() == 1 ? "was" : "were",
                                file_.missing() == 1 ? "is" : "are");
        if (gaps_ > 0) text += fmt::format(", with {} gap{}", gaps_, gaps_ == 1 ? "" : "s");
        return text;
    }

  private:
    void drain_reports(bool flushing) {
        // While an asset is written nothing else is. What does not fit into a chunk stays in the ring, which
        // counts its losses.
        constexpr std::uint64_t most_waiting = 50'000;
        Report report;
        for (std::uint32_t n = 0;
             n < protocol::report_slots && (flushing || file_.pending() < most_waiting) &&
             source_.reports().next(&report);
             ++n) {
            file_.report(report);
            ++reports_;
            first_ns_ = reports_ == 1 ? report.read_ns : first_ns_;
            if (reports_ == 1) {
                first_report_ = report.cycle;
                for (const std::uint64_t cycle : std::exchange(early_, {})) count_exact(cycle);
            }
            last_ns_ = report.read_ns;
            if (flushing && file_.full()) flush();
        }
    }
    void say_lost() {
        exact_ = false;
        if (std::exchange(lost_, true)) return;
        fmt::print(stderr, "knurl record: {}; dropping what does not fit\n", file_.problem());
    }
    /// An application's asset, placed before the input that refers to it.
    void take_asset() {
        protocol::AssetDigest digest;
        constexpr std::size_t at = 2 * sizeof(std::uint64_t);
        if (record_.bytes.size() != at + sizeof digest) return;
        std::memcpy(digest.data(), record_.bytes.data() + at, sizeof digest);
        const auto sent = source_.sent(digest);
        if (file_.has(digest) || (sent && keep(digest, *sent))) return;
        file_.missing(digest);
        gap();  // replay is impossible from here to the next keyframe
    }
    bool keep(const protocol::AssetDigest& digest, const Source::Sent& sent) {
        try {
            const shm::Segment memory = shm::Segment::open_sealed(sent.source.get(), sent.bytes);
            if (file_.asset(digest, {memory.data(), memory.size()}, [this] { drain_reports(false); }))
                return true;
            say_lost();
        } catch (const std::runtime_error& error) {
            fmt::print(stderr, "knurl record: {}\n", error.what());
        }
        return false;
    }
    void gap() {
        file_.gap();
        ++gaps_;
        exact_ = false;
    }
    void count_exact(std::uint64_t cycle) {
        if (cycle < first_report_) return;
        ++unwritten_;
        if (first_exact_ == 0) first_exact_ = cycle;
    }
    void take() {
        if (record_.type == servo::InputType::keyframe) exact_ = true;
        if (record_.type == servo::InputType::cycle) {
            ++inputs_;
            std::uint64_t cycle = 0;
            std::memcpy(&cycle, record_.bytes.data(), sizeof cycle);
            // Cycles before the first report have nothing for comparison and do not count.
            if (exact_ && reports_ > 0)
                count_exact(cycle);
            else if (exact_)
                early_.push_back(cycle);
        }
        if (record_.type == servo::InputType::asset) take_asset();
        file_.input(record_);
    }

    Source& source_;
    RecordingWriter& file_;
    servo::InputRecord record_;
    std::uint64_t reports_ = 0, inputs_ = 0, gaps_ = 0, exact_cycles_ = 0, first_exact_ = 0;
    std::uint64_t unwritten_ = 0;       // exact cycles since the last flush
    std::uint64_t first_report_ = 0;    // its cycle
    std::vector<std::uint64_t> early_;  // exact cycles, while there is no report yet
    std::int64_t first_ns_ = 0, last_ns_ = 0;
    bool exact_ = false, begun_ = false, said_ = false, lost_ = false;
};

/// What is in the scenes, for who opens the file.
void write_scenes(gateway::SceneNotes& scenes, RecordingWriter& file) {
    using Form = gateway::SceneNote::Form;
    using Scene = RecordingWriter::Scene;
    for (const gateway::SceneNote& note : scenes.look(std::chrono::steady_clock::now()))
        file.scene(note.form == Form::page   ? Scene::page
                   : note.form == Form::mesh ? Scene::mesh
                                             : Scene::markers,
                   note.read_ns, std::as_bytes(std::span(note.bytes)));
}

int record(const RecordArguments& arguments) {
    const Existing existing = arguments.force ? Existing::replaced : Existing::kept;
    if (!arguments.salvage.empty()) {
        fmt::print("{}\n", recording::salvage(arguments.salvage, arguments.file, existing));
        return 0;
    }
    using Clock = std::chrono::steady_clock;
    const shm::UniqueFd signals = take_signals();
    if (!arguments.rooms.empty())
        return record_rooms({.rooms = arguments.rooms,
                             .file = arguments.file,
                             .seconds = arguments.seconds,
                             .existing = existing},
                            signals.get());
    const protocol::ServoAddress servo = servo_said(arguments.servo);
    Source source(servo, arguments.device);
    const RecordingInfo info = source.info();
    RecordingWriter file(arguments.file, info, existing);
    Recorder recorder(source, file);
    gateway::SceneNotes scenes(arguments.servo, info.device, info.realtime_offset_ns);

    const auto begin = Clock::now();
    auto flushed = begin;
    std::string ended;
    measure::Progress progress("knurl record");
    for (bool on = true; on;) {
        std::array<pollfd, 2> wait{{{.fd = source.socket(), .events = POLLIN, .revents = 0},
                                    {.fd = signals.get(), .events = POLLIN, .revents = 0}}};
        ::poll(wait.data(), wait.size(), look_every);
        const auto now = Clock::now();
        const bool there = wait[0].revents == 0 || source.listen();
        if (!there) ended = "; the servo has ended";
        on = there && wait[1].revents == 0 &&
             (arguments.seconds == 0 ||
              std::chrono::duration<double>(now - begin).count() < arguments.seconds);
        recorder.drain();
        if (!recorder.lost()) write_scenes(scenes, file);  // a disk that is full has room for reports at most
        if (recorder.has_to_say()) progress.clear();
        recorder.say_when_begun(fmt::format("recording device '{}' of servo '{}' into {}", info.device,
                                            servo.name, arguments.file));
        recorder.say_when_exact();
        progress.show(fmt::format(
            "{}, {}",
            measure::seconds_of(std::chrono::duration<double>(now - begin).count(), arguments.seconds),
            recorder.so_far()));
        if (now - flushed < flush_every) continue;
        recorder.flush();
        flushed = now;
    }
    recorder.finish();
    progress.clear();
    const bool whole = file.finish();
    fmt::print("{}: {}{}\n", arguments.file, recorder.summary(), ended);
    if (!whole)
        fmt::print(stderr, "knurl record: {}; the file has no index, what is in it can be read\n",
                   file.problem());
    return whole && !recorder.lost() ? 0 : 1;
}

}  // namespace

void add_record(commandline::Command& program) {
    auto& verb = program.verb("record", "Every report and every input of a device's servo, into a file");
    auto arguments = std::make_shared<RecordArguments>();
    verb.option("file", arguments->file, "the recording, for knurl replay, Foxglove, PlotJuggler")
        .required()
        .type_name("FILE.mcap");
    verb.servo(arguments->servo, "its name").shows_default();
    verb.option("--device", arguments->device, "of that servo; only if it has several").type_name("NAME");
    verb.option("--for", arguments->seconds, "end after this time; default: when interrupted")
        .type_name("SECONDS")
        .positive();
    verb.option(
            "--room", arguments->rooms,
            "in place of --servo: devices of several servos, on this host and others, into one file with one "
            "time base; may be repeated. Reports alone, which do not replay")
        .type_name("NAME=ADDRESS[,DEVICE]");
    verb.flag("--force", arguments->force, "replace a file that is there");
    verb.option("--salvage", arguments->salvage,
                "no servo: what the guardian saved when one died (its file, or the directory: the newest)")
        .type_name("PATH");
    verb.footer(
        "Ctrl-C or the end of the servo completes the file. Replay is exact to the last bit from the first "
        "moment at which\nnobody holds the device, so start the recording before the application. The servo "
        "does not wait for the disk:\nwhat a slow or full disk does not take is dropped and counted. Less "
        "than 1 GB an hour at 1 kHz, and "
        "once\n"
        "each mesh that an application sends.");
    verb.action([arguments] { return record(*arguments); });
}

}  // namespace knurl::cli
