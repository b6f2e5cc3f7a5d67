#pragma once

/// @file
/// One process's place in a DDS domain: which network it uses, whom it finds, and the endpoints that it makes there.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/dds/entity.hpp>

namespace knurl::dds {

/// Where a domain reaches.
struct DomainOptions {
    /// Number of the domain, 0 to 232.
    std::uint32_t id = 0;
    /// An address or a name of a network interface of this host; empty: loopback, so that no other host is reached.
    std::string interface {};
    /// Addresses of hosts that are asked directly, where multicast does not reach.
    std::vector<std::string> peers{};
    /// How long others keep this process after it was heard last. A link that was down for longer is found anew.
    std::chrono::milliseconds lease{5000};
    /// How often it says that it is there.
    std::chrono::milliseconds announce{1000};
    /// For tests: of a thousand packets, this many are not sent.
    unsigned lose = 0;
    /// Takes one line.
    std::function<void(const std::string&)> log = [](const std::string&) {};
};

/// $ROS_DOMAIN_ID; 0 where it is not set. Throws std::runtime_error: it is no number of a domain.
std::uint32_t domain_of_environment();
/// The configuration that Cyclone is given: nothing of the environment counts.
std::string cyclone_configuration(const DomainOptions& options);

/// How an endpoint carries what it carries.
struct EndpointOptions {
    /// "geometry_msgs/msg/PoseStamped": its hash goes into USER_DATA. Empty: it is no topic of ROS.
    std::string_view message{};
    /// Nothing is lost that the reader can take; keep last 1 bounds what is kept for a slow one.
    bool reliable = true;
    /// Who comes later gets the last sample.
    bool transient_local = false;
    /// Samples kept of each instance.
    std::int32_t depth = 1;
    /// A writer that is silent for so long is dead; 0: as long as its process's lease.
    std::chrono::nanoseconds liveliness{0};
};

/// A participant.
class Domain {
  public:
    /// Throws std::runtime_error, one line: no such interface, too many processes on this host, ...
    explicit Domain(DomainOptions options);
    ~Domain();
    Domain(const Domain&) = delete;
    Domain& operator=(const Domain&) = delete;

    /// The participant.
    dds_entity_t participant() const;
    /// As they were given.
    const DomainOptions& options() const;
    /// A line for the log, from any thread; a line that was said before is not said again for a minute.
    void say(const std::string& line) const;

    /// A writer of this topic. ROS's topic "/right/measured_cp" is "rt/right/measured_cp".
    Entity writer(const std::string& topic, const dds_topic_descriptor_t& type,
                  const EndpointOptions& options);
    /// A reader of it.
    Entity reader(const std::string& topic, const dds_topic_descriptor_t& type,
                  const EndpointOptions& options);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Who has written a sample, as it says of itself: a name is no proof.
struct Peer {
    /// Of its participant; empty: not known any more.
    std::string id{};
    /// "planner@lab-pc pid 4711"; what it does not say is left out.
    std::string text{};
    /// "lab-pc"; empty: it does not say.
    std::string host{};
    /// Its type's hash differs from ours: one line; empty: it does not.
    std::string wrong_type{};
};

/// The peer whose writer has this handle (dds_sample_info_t::publication_handle).
Peer peer_of(dds_entity_t reader, dds_instance_handle_t writer, std::string_view message);

}  // namespace knurl::dds
