#pragma once
// What is written of one device: its topics, how often each is due, and the messages.

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <knurl/dds/domain.hpp>
#include <knurl/dds/robot_side.hpp>
#include <knurl/protocol/report.hpp>

#include "ros_messages.h"

namespace knurl::dds {

/// Of one device. Used by one thread.
class DeviceTopics {
  public:
    using Time = std::chrono::steady_clock::time_point;

    /// `joints`: how many it senses.
    DeviceTopics(Domain& domain, const RobotOptions& options, const std::string& device,
                 std::uint32_t joints);

    /// Somebody reads one of them. Looked up at most ten times a second.
    bool wanted(Time now);
    /// When the next one is due that somebody reads; far away: none is.
    Time next_due() const;
    /// Of those that are read, most messages a second.
    double highest_rate() const;
    /// Writes what is due, from this report. `state`: CRTK's word.
    void write(Time now, const Report& report, const std::string& state);

  private:
    struct Topic {
        void (DeviceTopics::*write)(const Entity& writer, const Report& report) = nullptr;
        Entity writer;
        std::chrono::nanoseconds interval{};
        double rate = 0;
        Time due{};
        bool read = false;
    };
    void add(Domain& domain, const RobotOptions& options, const std::string& name, const char* message,
             const dds_topic_descriptor_t& type, void (DeviceTopics::*write)(const Entity&, const Report&),
             bool of_device = true);
    std_msgs_msg_dds__Header_ header();

    void pose(const Entity& writer, const Report& report);
    void setpoint(const Entity& writer, const Report& report);
    void twist(const Entity& writer, const Report& report);
    void wrench(const Entity& writer, const Report& report);
    void joints(const Entity& writer, const Report& report);
    void joy(const Entity& writer, const Report& report);
    void state(const Entity& writer, const Report& report);
    void transform(const Entity& writer, const Report& report);

    const std::string base_, tip_;
    const std::uint32_t joints_;
    std::vector<std::string> joint_names_;
    std::vector<Topic> topics_;
    Time looked_{};
    std::int64_t stamp_ns_ = 0;
    std::string state_;
};

}  // namespace knurl::dds
