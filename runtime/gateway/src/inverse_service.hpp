#pragma once
// The state that all connections of one Inverse Service share. Private to this module.

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <knurl/gateway/frames.hpp>
#include <knurl/gateway/inverse.hpp>
#include <knurl/json/json.hpp>

namespace knurl::gateway {

using TimePoint = std::chrono::steady_clock::time_point;
class InverseSession;

/// What the events channel carries.
struct InverseEvent {
    std::string name;
    std::string category;
    std::string level;
    Json data = Json::object();
    std::string message;
};

/// Where the device's space lies in an application's: application = position + rotation (scale * device).
struct InverseTransform {
    Vec3 position;
    Quat rotation;
    Vec3 scale{1, 1, 1};

    bool is_identity() const { return *this == InverseTransform{}; }
    Vec3 point(const Vec3& device) const;
    Vec3 point_back(const Vec3& application) const;
    /// A velocity.
    Vec3 rate(const Vec3& device) const;
    /// A force: it has the size that the hand feels.
    Vec3 force(const Vec3& device) const;
    Vec3 force_back(const Vec3& application) const;
    friend bool operator==(const InverseTransform&, const InverseTransform&) = default;
};

class InverseService {
  public:
    explicit InverseService(InverseOptions options);

    const InverseOptions& options() const { return options_; }
    TimePoint now() const { return options_.clock(); }
    /// Looks at the devices, and tells of those that came, went, or are in fault.
    void look();
    std::span<const InverseDevice> devices() const { return source_->devices(); }
    const std::string& trouble() const { return source_->trouble(); }
    /// Null: there is none of that id.
    const InverseDevice* find(std::string_view id) const;
    bool claimable(const InverseDevice& device) const;
    std::unique_ptr<PeerCommands> make_hand(const InverseDevice& device, const std::string& peer,
                                            Role role) const;

    std::string handedness(const std::string& id) const;
    void set_handedness(const std::string& id, const std::string& hand) { handedness_[id] = hand; }

    /// To all who listen, and to the log.
    void publish(const InverseEvent& event);
    void listen(Socket& socket) { listeners_.insert(&socket); }
    void stop_listening(Socket& socket) { listeners_.erase(&socket); }

    std::uint64_t begin_session(InverseSession& session);
    void end_session(std::uint64_t number) { sessions_.erase(number); }
    const std::map<std::uint64_t, InverseSession*>& sessions() const { return sessions_; }

    InverseReply http(const InverseRequest& request);

  private:
    void tell_of_connection(const InverseDevice& device, const Json& data);
    void tell_of_faults(const InverseDevice& device, Json data);
    std::string device_list(const std::string& session);
    /// `given`: what a POST states; none: a GET.
    Json config(const std::string& what, const std::vector<const InverseDevice*>& of,
                const std::string& session, const std::optional<Json>& given);
    Json handedness_config(const std::vector<const InverseDevice*>& of, const std::optional<Json>& given);
    Json basis_config(const std::string& session, const std::optional<Json>& given);

    InverseOptions options_;
    std::unique_ptr<InverseSource> source_;
    std::map<std::string, std::string> handedness_;  // by id
    std::map<std::string, bool> was_connected_;
    std::map<std::string, std::uint32_t> was_fault_;
    std::set<Socket*> listeners_;
    std::map<std::uint64_t, InverseSession*> sessions_;
    std::uint64_t last_session_ = 0;
};

/// As make_inverse, with source and make_hand given.
Inverse serve_inverse(InverseOptions options);

// What the messages are made of (inverse_text.cpp).

/// One device as one session sees it.
struct InverseLook {
    const InverseDevice& device;
    Axes axes = frames::haply;  // from the device's frame to the client's, but for the transform
    std::string permutation = "XYZ";
    InverseTransform transform{};
    std::string handedness = "right";
    std::string control_mode = "idle";
    bool claimable = true;
    PeerStatus peer{};
    std::chrono::nanoseconds lapse{};
};

/// Appends the arrays of the devices: "inverse3": [...], "verse_grip": [], "wireless_verse_grip": [...].
void write_devices(std::string& out, const std::vector<InverseLook>& looks, bool full);
/// A number as JSON has it.
void write_number(std::string& out, double value);

}  // namespace knurl::gateway
