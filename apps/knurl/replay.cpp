// knurl replay: runs a recording through the same cycle, compared to the last bit.

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/recording/recording.hpp>
#include <knurl/servo/flight_recorder.hpp>
#include <knurl/servo/replay.hpp>

#include "evaluation.hpp"
#include "verbs.hpp"

namespace knurl::cli {

using recording::RecordingInfo;
using recording::RecordingReader;

namespace {

struct ReplayArguments {
    std::string file, csv, scene;
};

/// The first member that differs: its column's name and both values.
std::string difference(const Report& recorded, const Report& replayed) {
    const auto cell = [](std::string_view& row) {
        const std::string_view front = row.substr(0, row.find(','));
        row.remove_prefix(std::min(row.size(), front.size() + 1));
        return std::string(front);
    };
    const std::string one = servo::report_row(recorded), other = servo::report_row(replayed);
    std::string_view names = servo::report_columns, of_one = one, of_other = other;
    while (!names.empty()) {
        const std::string name = cell(names), a = cell(of_one), b = cell(of_other);
        if (a != b) return fmt::format("{} was {}, is {}", name, a, b);
    }
    return "the bits of a NaN or of a zero's sign";
}

/// Opens the recording's device, for its parameters and its mechanism.
std::unique_ptr<drivers::Device> device_of(const RecordingInfo& info) {
    std::unique_ptr<drivers::Device> device;
    try {
        device = drivers::open_device(info.address);
    } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("it was recorded on {}, which is needed for its figures: {}",
                                             info.address, error.what()));
    }
    if (servo::figures_of(*device) != info.figures)
        throw std::runtime_error(
            fmt::format("it was recorded on another device: {} has other figures here; give it back the "
                        "description that it had",
                        info.address));
    return device;
}

class CsvFile {
  public:
    explicit CsvFile(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "we")) {
        if (!file_) fail();
        put(std::string(servo::report_columns) + "\n");
    }
    void put(const std::string& text) {
        if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail();
    }
    void finish() {
        if (std::fflush(file_.get()) != 0) fail();
    }

  private:
    [[noreturn]] void fail() const {
        throw std::runtime_error(path_ + ": cannot be written: " + std::strerror(errno));
    }
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::string path_;
    std::unique_ptr<std::FILE, Close> file_;
};

/// Matches recorded and replayed reports by cycle; either may come first.
class Comparison {
  public:
    static constexpr std::size_t most_waiting = 100'000;

    void recorded(const Report& report) { meet(report, recorded_, replayed_, true); }
    void replayed(const Report& report) { meet(report, replayed_, recorded_, false); }

    std::uint64_t equal() const { return equal_; }
    const std::optional<std::string>& first_difference() const { return difference_; }

  private:
    using Waiting = std::map<std::uint64_t, Report>;
    void meet(const Report& report, Waiting& mine, Waiting& others, bool is_recorded) {
        const auto other = others.find(report.cycle);
        if (other == others.end()) {
            mine.insert_or_assign(report.cycle, report);
            if (mine.size() > most_waiting) mine.erase(mine.begin());
            return;
        }
        const Report& was = is_recorded ? report : other->second;
        const Report& is = is_recorded ? other->second : report;
        if (std::memcmp(&was, &is, sizeof was) == 0)
            ++equal_;
        else if (!difference_)
            difference_ = fmt::format("cycle {}: {}", report.cycle, difference(was, is));
        others.erase(other);
    }

    Waiting recorded_, replayed_;
    std::uint64_t equal_ = 0;
    std::optional<std::string> difference_;
};

/// A run's force in four numbers.
struct ForceStatistics {
    double sum = 0, squares = 0, most = 0;  // N
    std::uint64_t cycles = 0, felt = 0;
    void add(const Vec3& force) {
        const double f = std::sqrt(force.x * force.x + force.y * force.y + force.z * force.z);
        sum += f;
        squares += f * f;
        most = std::max(most, f);
        ++cycles;
        felt += f > 0;
    }
    std::string text() const {
        const double n = std::max(1.0, static_cast<double>(cycles));
        return fmt::format("mean {:.4f} N, rms {:.4f} N, max {:.4f} N, felt in {:.1f} % of {} cycles",
                           sum / n, std::sqrt(squares / n), most, 100 * static_cast<double>(felt) / n,
                           cycles);
    }
};

/// Evaluates the recorded motion with another scene.
class Again {
  public:
    Again(const std::string& path, double rate)
        : path_(path), scene_(scenefile::read_scene(path)), rate_(rate) {}

    void add(const Report& report) {
        if (report.state == DeviceState::disconnected || (!rows_.empty() && report.cycle <= last_)) return;
        if (rows_.empty()) first_ = report.cycle;
        last_ = report.cycle;
        rows_.push_back({.t = static_cast<double>(last_ - first_) / rate_,
                         .position = to_eigen(report.position),
                         .orientation = to_eigen(report.orientation)});
        recorded_.add(report.scene_force);
    }
    void say() {
        if (rows_.empty()) throw std::runtime_error("no report says where the hand was: nothing to feel");
        const Evaluation evaluation = evaluate(scene_, drivers::Motion(std::move(rows_), true),
                                               {.rate = rate_, .device = "", .motion_file = ""});
        ForceStatistics other;
        for (const EvaluatedCycle& cycle : evaluation.cycles) other.add(cycle.force);
        fmt::print("recorded: {}\n{}: {}\n", recorded_.text(), path_, other.text());
        for (const std::string& remark : evaluation.remarks) fmt::print(stderr, "knurl replay: {}\n", remark);
    }

  private:
    std::string path_;
    scenefile::SceneFile scene_;
    double rate_;
    std::vector<drivers::MotionRow> rows_;
    std::uint64_t first_ = 0, last_ = 0;
    ForceStatistics recorded_;
};

/// Replays through the servo's cycle, as far as possible.
class Replaying {
  public:
    Replaying(RecordingReader& recording, const std::string& path) : path_(path) {
        try {
            recording.require_this_build();
            device_ = device_of(recording.info());
            again_.emplace(*device_, recording.info().options,
                           [this, &recording](const protocol::AssetDigest& digest) {
                               try {
                                   source_ = recording.asset(digest);
                               } catch (const std::runtime_error& error) {
                                   throw servo::InputLogError(error.what());
                               }
                               return std::span<const std::byte>(source_);
                           });
        } catch (const std::runtime_error& error) {
            why_not_ = error.what();
        }
    }

    void take(const RecordingReader& recording, RecordingReader::Item item) {
        if (item == RecordingReader::Item::report) comparison_.recorded(recording.report);
        if (item == RecordingReader::Item::gap) {
            ++gaps_;
            if (again_) again_->gap();
        }
        if (item == RecordingReader::Item::input) {
            ++inputs_;
            begins_ = begins_ || recording.input.type == servo::InputType::keyframe;
        }
        if (item == RecordingReader::Item::input && again_) try {
                if (const Report* report = again_->feed(recording.input)) comparison_.replayed(*report);
            } catch (const servo::InputLogError& error) {
                why_not_ = path_ + ": " + error.what();
                again_.reset();
            }
    }
    bool possible() const { return again_.has_value(); }
    /// Empty: it was replayed. Else the reason why not.
    std::string why_not(const std::optional<std::uint64_t>& cut_off_at) const {
        if (!why_not_.empty() || comparison_.equal() > 0 || comparison_.first_difference()) return why_not_;
        if (cut_off_at)
            return fmt::format("nothing to replay: {}: the recording is cut off behind {} whole bytes, {}",
                               path_, *cut_off_at,
                               begins_       ? "before a cycle of it was complete"
                               : inputs_ > 0 ? "and in those somebody held the device"
                                             : "before the first input");
        if (inputs_ == 0) return "nothing to replay: " + path_ + " has no inputs of the servo";
        if (begins_) return "nothing to replay: " + path_ + " ends before a cycle of it was complete";
        return "nothing to replay: an application held the device from the first cycle on; start the "
               "recording before the application";
    }
    std::string outcome() const {
        std::string text = fmt::format("{} cycles replayed, equal to the last bit", comparison_.equal());
        if (gaps_ > 0) text += fmt::format("; {} gap{} in the recording", gaps_, gaps_ == 1 ? "" : "s");
        return text;
    }
    const std::optional<std::string>& first_difference() const { return comparison_.first_difference(); }

  private:
    std::string path_;
    std::unique_ptr<drivers::Device> device_;
    std::optional<servo::Replay> again_;
    std::vector<std::byte> source_;
    Comparison comparison_;
    std::uint64_t gaps_ = 0, inputs_ = 0;
    bool begins_ = false;  // there was a cycle from which to start
    std::string why_not_;
};

/// What is made of the recorded reports besides the replay.
struct Uses {
    std::optional<CsvFile> csv;
    std::optional<Again> other;  // with another scene

    bool any() const { return csv || other; }
    void add(const Report& report) {
        if (csv) csv->put(servo::report_row(report));
        if (other) other->add(report);
    }
};

/// Reads the recording to its end and returns the number of its reports. `required`: throws as soon as it
/// cannot be replayed.
std::uint64_t read_all(RecordingReader& recording, Replaying& replaying, Uses& uses, bool required) {
    const auto check = [&] {
        if (required && !replaying.possible()) throw std::runtime_error(replaying.why_not({}));
    };
    std::uint64_t reports = 0;
    check();
    for (auto item = recording.next(); item != RecordingReader::Item::end; item = recording.next()) {
        replaying.take(recording, item);
        check();
        if (item != RecordingReader::Item::report) continue;
        ++reports;
        uses.add(recording.report);
    }
    return reports;
}

int replay(const ReplayArguments& arguments) {
    RecordingReader recording(arguments.file);
    Uses uses;
    auto& [csv, other] = uses;
    if (!arguments.csv.empty()) csv.emplace(arguments.csv);
    if (!arguments.scene.empty()) other.emplace(arguments.scene, recording.info().options.rate);
    Replaying replaying(recording, arguments.file);
    // A recording that cannot be replayed can still be exported and evaluated.
    const bool required = !uses.any();
    const std::uint64_t reports = read_all(recording, replaying, uses, required);
    if (csv) csv->finish();
    // If nothing can be replayed the reason mentions it.
    if (const auto at = recording.cut_off_at(); at && !(required && !replaying.why_not(at).empty()))
        fmt::print(stderr, "knurl replay: {}: cut off; its first {} bytes are whole, and are used\n",
                   arguments.file, *at);

    const std::string why_not = replaying.why_not(recording.cut_off_at());
    if (required && !why_not.empty()) throw std::runtime_error(why_not);
    if (!why_not.empty() && !replaying.first_difference()) fmt::print(stderr, "knurl replay: {}\n", why_not);
    fmt::print("{}: {} reports{}{}\n", arguments.file, reports, csv ? " written to " + arguments.csv : "",
               why_not.empty() ? "; " + replaying.outcome() : "");
    if (other) other->say();
    if (replaying.first_difference())
        throw std::runtime_error("the replay differs first in " + *replaying.first_difference());
    return 0;
}

}  // namespace

void add_replay(commandline::Command& program) {
    auto& verb =
        program.verb("replay", "A recording once more through the servo's cycle, compared bit by bit");
    auto arguments = std::make_shared<ReplayArguments>();
    verb.option("file", arguments->file, "what knurl record made").required().type_name("FILE.mcap");
    verb.option("--scene", arguments->scene, "feel the recorded motion with this scene too; forces of both")
        .type_name("S.toml");
    verb.option("--csv", arguments->csv, "the recorded reports, a line each").type_name("OUT.csv");
    verb.footer(
        "Needs the build that recorded, and a description of the device with the same figures. Ends with 0 "
        "if every\n"
        "cycle that can be replayed gives the recorded report to the last bit, else says where it first "
        "differs.");
    verb.action([arguments] { return replay(*arguments); });
}

}  // namespace knurl::cli
