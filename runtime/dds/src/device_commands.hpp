#pragma once
// What is read for one device: its readers, and whose messages they bring to its CommandDesk.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <knurl/dds/command_desk.hpp>
#include <knurl/dds/domain.hpp>
#include <knurl/dds/robot_side.hpp>

namespace knurl::dds {

/// Of one device. Used by one thread.
class DeviceCommands {
  public:
    DeviceCommands(Domain& domain, const RobotOptions& options, const CommandRule& rule, CommandOptions desk);

    /// Wakes a waitset when a message has come.
    void attach(dds_entity_t waitset);
    /// Takes what has come, to the desk.
    void take();
    /// A writer of one of its topics is in the domain.
    bool anybody_there() const;
    /// Tells the desk of peers that have gone.
    void look_for_gone();
    CommandDesk& desk() { return desk_; }

  private:
    struct Input {
        Entity reader;
        Entity condition;
        std::string message;  // "geometry_msgs/msg/WrenchStamped"
        std::function<void(const Input&)> take;
        std::map<dds_instance_handle_t, Peer> peers;  // by writer
    };
    void add(Domain& domain, const std::string& topic, const char* message,
             const dds_topic_descriptor_t& type, std::function<void(const Origin&, const void*)> handle);
    Origin origin(Input& input, const dds_sample_info_t& info);

    Domain& domain_;
    CommandDesk desk_;
    std::vector<std::unique_ptr<Input>> inputs_;
};

}  // namespace knurl::dds
