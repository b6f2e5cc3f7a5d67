#pragma once

/// @file
/// A servo's devices as topics of ROS 2, by CRTK's names. What is written is read from the servo's reports by an observer;
/// what is read goes through a CommandDesk to claims. Neither is in the servo's cycle, and a topic that nobody reads costs
/// nothing.

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <knurl/dds/command_desk.hpp>
#include <knurl/dds/domain.hpp>
#include <knurl/dds/registry.hpp>

namespace knurl::dds {

/// Whether and how one device may be commanded.
struct CommandRule {
    /// Its name.
    std::string device{};
    /// CommandOptions::from.
    std::vector<std::string> from{};
    /// CommandOptions::deadline and lifespan.
    std::chrono::nanoseconds deadline = std::chrono::milliseconds(20),
                             lifespan = std::chrono::milliseconds(50);
    /// CommandOptions::enabled.
    bool enabled = true;
    /// Kinds of representations that are read; empty: all but those made of a mesh.
    std::vector<std::string> representations{};
};

/// What the robot side shows.
struct RobotOptions {
    /// As Client::connect takes it: of this host.
    std::string servo = "knurl:default";
    /// Before all names of topics: "lab"; empty: none.
    std::string name_space{};
    /// Topic, without the namespace ("right/measured_cp") -> the name that it has instead ("/fd/ee_pose").
    std::map<std::string, std::string> remap{};
    /// Topic of a device ("measured_cp") -> most messages a second. What is not named has its default.
    std::map<std::string, double> rates{};
    /// Who may command what; a device that is not named is only shown.
    std::vector<CommandRule> commands{};
};

/// Most messages a second of a device's topics where nothing else is said.
const std::map<std::string, double>& default_rates();

/// "right/measured_cp" -> "rt/lab/right/measured_cp".
std::string dds_topic(const RobotOptions& options, const std::string& topic);

/// The robot side of one servo. It waits for the servo, and for it to come back.
class RobotSide {
  public:
    /// Starts its threads. `domain` outlives it.
    RobotSide(Domain& domain, RobotOptions options);
    /// Ends them; claims are released.
    ~RobotSide();
    RobotSide(const RobotSide&) = delete;
    RobotSide& operator=(const RobotSide&) = delete;

    /// What is to be announced of the servo now; `state` is "gone" while it is not there. Call it from one thread.
    void describe(ServoEntry& servo);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::dds
