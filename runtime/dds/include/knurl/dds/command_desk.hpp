#pragma once

/// @file
/// What peers of a domain may command of one device, and when: of each peer a PeerHand (its claim, which fades when the
/// peer stops), one commander of forces at a time, and a line for each thing that is refused. It knows neither DDS nor a
/// servo and asks no clock but the ones that it is given, so that tests play all of them.

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/gateway/peer_hand.hpp>
#include <knurl/protocol/report.hpp>

namespace knurl::dds {

/// Who has written a message, and when by its own clock.
struct Origin {
    /// Of its participant.
    std::string id{};
    /// For people: "planner@lab-pc pid 4711".
    std::string text{};
    /// Its host, as it says; empty: it does not.
    std::string host{};
    /// CLOCK_REALTIME of its host when it wrote (ns).
    std::int64_t written_ns = 0;
};

/// The head of a message.
struct Head {
    /// Frame of what it states; empty: the default one.
    std::string frame{};
    /// CLOCK_REALTIME of its host when what it states was so (ns); 0: it does not say.
    std::int64_t stamp_ns = 0;
};

/// How commands are taken.
struct CommandOptions {
    /// As Client::connect takes it, and the name of the device.
    std::string servo{}, device{};
    /// Names of its frames.
    std::string base_frame{}, tip_frame{};
    /// A command that is not renewed for so long ends, by a ramp.
    std::chrono::nanoseconds deadline = std::chrono::milliseconds(20);
    /// A message that took longer is too old to be felt.
    std::chrono::nanoseconds lifespan = std::chrono::milliseconds(50);
    /// Who has commanded a force or a place keeps the device for so long after it, against others.
    std::chrono::nanoseconds hold_on = std::chrono::milliseconds(500);
    /// Names of hosts whose processes may command; empty: all that reach the domain. A peer states its name itself.
    std::vector<std::string> from{};
    /// False: commands count only after state_command "enable".
    bool enabled = true;
    /// Makes a claim for a peer.
    std::function<std::unique_ptr<gateway::PeerCommands>(gateway::PeerOptions)> make_hand{};
    /// Takes one line.
    std::function<void(const std::string&)> log = [](const std::string&) {};
    /// What time it is.
    std::function<std::chrono::steady_clock::time_point()> clock = std::chrono::steady_clock::now;
    /// CLOCK_REALTIME (ns).
    std::function<std::int64_t()> wall_clock{};
};

/// The commands of one device. All calls come from one thread.
class CommandDesk {
  public:
    /// Most peers that command a device at a time.
    static constexpr std::size_t most_peers = 16;

    /// Claims nothing yet.
    explicit CommandDesk(CommandOptions options);
    ~CommandDesk();

    /// The newest report: where the hand is, what state the device has.
    void look(const Report& report);
    /// Nobody commands, and no report is known until the next look().
    void look_away();
    /// servo_cf; `body`: in the frame of the tip.
    void force(const Origin& from, const Head& head, Vec3 force, Vec3 torque, bool body);
    /// servo_cp.
    void place(const Origin& from, const Head& head, const Vec3& position);
    /// state_command.
    void word(const Origin& from, std::string_view word);
    /// hold: a spring holds the hand where it is until this peer commands something else, or is gone.
    void hold(const Origin& from);
    /// free: no command of this peer is left; its representations stay.
    void free(const Origin& from);
    /// A representation of the peer's under a name of its own, as complete parameters.
    void put(const Origin& from, const Head& head, const std::string& id, std::uint32_t probe, Kind kind,
             const std::vector<std::byte>& params);
    /// Removes one; an empty id: all of the peer's.
    void remove(const Origin& from, const std::string& id);
    /// A message of this peer cannot be read.
    void refuse(const Origin& from, const std::string& why);
    /// The peer is not in the domain any more: what it held fades.
    void gone(const std::string& id);
    /// Peers that hold something here.
    std::vector<std::string> peers() const;
    /// Keeps alive what is meant to stay; says what happened. Call it every 10 ms or so.
    void tick();

    /// CRTK's word for the state: DISABLED, ENABLED, PAUSED, FAULT.
    std::string_view state() const;

  private:
    struct Hand;
    struct Lag;

    bool admit(const Origin& from, const Head& head, std::string_view what);
    bool may_command(const Origin& from, std::string_view what);
    bool fresh(const Origin& from, const Head& head, std::string_view what);
    bool in_frame(const Origin& from, const Head& head, const std::string& frame, std::string_view what);
    bool take_lead(const Origin& from, std::string_view what);
    Hand* hand_of(const Origin& from);
    void say(const std::string& line);

    CommandOptions options_;
    std::map<std::string, Hand> hands_;
    std::map<std::string, Lag> lags_;
    std::string leader_, leader_text_;
    std::chrono::steady_clock::time_point led_at_{};
    bool enabled_;
    bool paused_ = false;
    std::optional<Report> report_;
    std::map<std::string, std::chrono::steady_clock::time_point> said_;
};

}  // namespace knurl::dds
