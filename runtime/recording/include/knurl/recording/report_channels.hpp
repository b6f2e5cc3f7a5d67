#pragma once
// The channels that a file has for one device's reports: each report as it is, and 100 times a second in the types of
// ROS 2.

#include <cstdint>
#include <map>
#include <string>

#include <knurl/messages/channels.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/recording/mcap.hpp>

namespace knurl::recording {

class ReportChannels {
  public:
    /// Adds them to `file`, which outlives this. `device`: in topics and frames. `joints`: how many are sensed; 0: not
    /// known, and there is no measured_js. `sibling`: of another device in that file; what is of all devices is its.
    ReportChannels(McapWriter& file, const std::string& device, std::uint32_t joints,
                   const ReportChannels* sibling = nullptr);

    /// `time_ns`: of the report's read, CLOCK_REALTIME of this file.
    void write(const Report& report, std::int64_t time_ns);
    /// The number of a channel that the file has.
    std::uint16_t number(messages::Channel channel) const { return channels_.at(channel); }

  private:
    McapWriter& file_;
    std::string device_;
    std::uint32_t joints_;
    std::map<messages::Channel, std::uint16_t> channels_;
    std::int64_t view_ = -1;  // when the last pose was written, in its intervals
};

}  // namespace knurl::recording
