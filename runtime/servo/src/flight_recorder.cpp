#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/flight_recorder.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::servo {

const std::string_view report_columns =
    "cycle,deadline_ns,read_ns,write_ns,q0,q1,q2,q3,q4,q5,q6,q7,x,y,z,qw,qx,qy,qz,vx,vy,vz,slow_vx,slow_vy,"
    "slow_vz,"
    "wx,wy,wz,scene_fx,scene_fy,scene_fz,scene_tx,scene_ty,scene_tz,sent_fx,sent_fy,sent_fz,sent_tx,sent_ty,"
    "sent_tz,"
    "contact_x,contact_y,contact_z,state,faults,buttons,flags,late_count,presses,"
    "touches";

namespace {

std::string utc_now() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    std::tm utc{};
    gmtime_r(&now.tv_sec, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y%m%dT%H%M%S", &utc);
    return fmt::format("{}.{:03}Z", text, now.tv_nsec / 1'000'000);  // milliseconds keep two deaths in one
                                                                     // second apart
}

/// Writes all of `text` at the file's position. False: there is no room for all of it.
bool write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t n = ::write(file, text.data(), text.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        text.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

/// Writes the header and the rows; on a full disk as many of the newest rows as there is room for. False: not
/// even one.
bool write_newest(int file, const std::string& header, std::span<const std::string> rows) {
    std::string text = header;
    for (const std::string& row : rows) text += row;
    if (write_all(file, text)) return true;

    const off_t fits = ::lseek(file, 0, SEEK_CUR);
    const std::string note = "# the disk was full: only the newest reports are here\n";
    // Others write to the disk as well: with less room than before, try half of it.
    for (std::size_t room = fits > 0 ? static_cast<std::size_t>(fits) : 0; room > 0; room /= 2) {
        const std::size_t head = note.size() + header.size();
        std::size_t kept = 0;
        for (std::size_t bytes = head; kept < rows.size(); ++kept) {
            bytes += rows[rows.size() - 1 - kept].size();
            if (bytes > room) break;
        }
        if (kept == 0) break;
        text = note + header;
        for (const std::string& row : rows.last(kept)) text += row;
        if (::ftruncate(file, 0) == 0 && ::lseek(file, 0, SEEK_SET) == 0 && write_all(file, text))
            return true;
    }
    errno = ENOSPC;
    return false;
}

}  // namespace

std::string report_row(const Report& r) {
    fmt::memory_buffer line;
    const auto out = std::back_inserter(line);
    fmt::format_to(out, "{},{},{},{}", r.cycle, r.deadline_ns, r.read_ns, r.write_ns);
    const auto number = [&](double value) { fmt::format_to(out, ",{:.17g}", value); };
    const auto vector = [&](const Vec3& v) {
        number(v.x);
        number(v.y);
        number(v.z);
    };
    for (double joint : r.joints) number(joint);
    vector(r.position);
    number(r.orientation.w);
    number(r.orientation.x);
    number(r.orientation.y);
    number(r.orientation.z);
    for (const Vec3& v : {r.velocity, r.slow_velocity, r.angular_velocity, r.scene_force, r.scene_torque,
                          r.sent_force, r.sent_torque, r.contact_point}) {
        vector(v);
    }
    fmt::format_to(out, ",{},{},{},{},{},{},{}\n", static_cast<std::uint32_t>(r.state), r.faults, r.buttons,
                   r.flags, r.late_count, r.presses, r.touches);
    return fmt::to_string(line);
}

std::string write_flight_record(const std::string& directory, const std::byte* device_segment,
                                const std::string& cause) {
    constexpr protocol::DeviceLayout layout = protocol::device_layout();
    protocol::DeviceInfo info;  // written once, before any other process had the memory
    std::memcpy(&info, device_segment + layout.info, sizeof info);
    const shm::BroadcastReader reports(device_segment + layout.reports, protocol::report_slots,
                                       sizeof(Report), 0);

    const std::string path =
        fmt::format("{}/flight-{}-{}-{}.csv", directory, info.servo, info.name, utc_now());
    const std::string unfinished = path + ".part";
    const auto failed = [&](const std::string& what) {
        return std::runtime_error(fmt::format(
            "its last reports could not be saved: {}: {}; make room there, or name another folder "
            "(KNURL_STATE_DIR)",
            what, std::strerror(errno)));
    };

    std::error_code ignored;  // an error shows in the open below
    std::filesystem::create_directories(directory, ignored);
    const shm::UniqueFd file(
        ::open(unfinished.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0640));
    if (!file) throw failed(unfinished);

    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "# Knurl flight recorder: the last reports of a servo that died\n");
    fmt::format_to(out, "# build: {} layout {:016x}\n", KNURL_VERSION, info.layout_hash);
    fmt::format_to(out, "# cause: {}\n", cause);
    fmt::format_to(out, "# servo: {} pid {}\n", info.servo, info.servo_pid);
    fmt::format_to(out, "# device: {} {} {} Hz\n", info.name, info.address, info.rate);
    fmt::format_to(out, "# units: s, m, rad, N, N m; *_ns CLOCK_MONOTONIC; device frame\n");
    fmt::format_to(out, "{}\n", report_columns);

    const std::uint64_t end = reports.published();
    const std::uint64_t readable = protocol::report_slots - 1;
    std::vector<std::string> rows;
    for (std::uint64_t n = end > readable ? end - readable : 0; n < end; ++n) {
        Report report;
        if (reports.at(n, &report)) rows.push_back(report_row(report));
    }
    const bool written = write_newest(file.get(), fmt::to_string(text), rows);
    if (!written || std::rename(unfinished.c_str(), path.c_str()) != 0) {
        const auto error = failed(unfinished);
        std::remove(unfinished.c_str());
        throw error;
    }
    return path;
}

}  // namespace knurl::servo
