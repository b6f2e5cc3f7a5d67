#pragma once
// One connection to the simulation channel of the Inverse Service. Private to this module.

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "inverse_items.hpp"
#include "inverse_service.hpp"

namespace knurl::gateway {

class InverseSession final : public SocketHandler {
  public:
    InverseSession(std::shared_ptr<InverseService> service, Socket& socket);
    ~InverseSession() override;

    void text(std::string_view message) override;
    void binary(std::span<const std::byte> message) override;
    void tick(TimePoint now) override;

    /// The devices as this session sees them.
    std::vector<InverseLook> looks() const;
    const std::string& permutation() const { return permutation_; }
    /// False: it names no axes.
    bool set_permutation(const std::string& permutation);

  private:
    /// What this session has with one device.
    struct Hold {
        InverseTransform transform;
        std::string mode = "idle";  // as the client commanded last
        TimePoint mode_at{};
        std::map<std::string, InverseItem> items;
        std::unique_ptr<PeerCommands> hand;  // once something was commanded
    };

    void read(const Json& message);
    void read_session(const Json& session);
    void read_basis(const Json& basis);
    void read_device(const Json& entry);
    void read_grip(const Json& entry);
    void read_commands(const InverseDevice& device, const Json& commands);
    void read_command(const InverseDevice& device, const std::string& command, const Json& stated);
    void push(const InverseDevice& device, const Json& stated);
    void pull(const InverseDevice& device, const Json& stated);
    void read_transform(const InverseDevice& device, const Json& stated);
    void read_items(const InverseDevice& device, const Json& stated);
    void add(const InverseDevice& device, const Json& stated);
    void set(const InverseDevice& device, const Json& stated);
    void remove(const InverseDevice& device, const Json& stated);
    /// Null: this peer may not move it, which has been said.
    PeerCommands* hand(const InverseDevice& device);
    void answer(bool full);
    void hear();

    /// Says what is wrong: in the answer, on the events channel, in the log. The same text not twice in ten seconds, and
    /// few a second: a client that is wrong is wrong two hundred times a second.
    void complain(const std::string& name, const std::string& text, const std::string& level = "warning",
                  const std::string& device = {});
    void refuse_unless_empty(const std::string& text, const InverseDevice& device);
    void unknown(const std::string& key);

    const std::shared_ptr<InverseService> service_;
    Socket& socket_;
    std::uint64_t number_ = 0;
    std::string permutation_ = "XYZ";
    Axes axes_ = frames::haply;
    std::map<std::string, Hold> holds_;  // by id
    bool full_wanted_ = false;
    std::map<std::string, std::uint64_t> unknown_;  // keys: how often
    std::map<std::string, TimePoint> complained_;   // texts: when
    TimePoint second_{};
    int this_second_ = 0;
    std::uint64_t held_back_ = 0;
    std::vector<std::string> to_say_;  // in the next answer
};

class InverseListener final : public SocketHandler {
  public:
    InverseListener(std::shared_ptr<InverseService> service, Socket& socket);
    ~InverseListener() override;
    void text(std::string_view) override {}
    void binary(std::span<const std::byte>) override {}
    void tick(TimePoint) override { service_->look(); }

  private:
    const std::shared_ptr<InverseService> service_;
    Socket& socket_;
};

}  // namespace knurl::gateway
