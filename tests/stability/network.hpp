#pragma once
// The network between the servo and a remote application, in virtual time: the network profiles of
// tests/bridge/proxy and the bridge's rule (the newest wins; unacknowledged data is sent again every 10 ms).

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "network_profile.hpp"

namespace stability {

inline constexpr double resend = 10e-3;  // s

/// One direction of numbered messages; the newest one that has arrived counts.
template <class Thing>
class Newest {
  public:
    /// Sends it now. `again`: sent again until it arrives; else it is lost when its datagram is.
    void send(const knurl::bridge::proxy::NetworkProfile& profile, std::uint64_t seed,
              knurl::bridge::proxy::Way way, double now, const Thing& thing, bool again) {
        constexpr int most_tries = 100;
        for (int i = 0; i < (again ? most_tries : 1); ++i) {
            const auto fate = fate_of(profile, seed, way, 0, sent_++, now + i * resend);
            for (int copy = 0; copy < fate.copies; ++copy)
                under_way_.push_back({number_, now + i * resend + fate.delays[copy], thing});
            if (fate.copies > 0) break;
        }
        ++number_;
    }
    /// True: `newest()` is newer than before.
    bool arrive(double now) {
        bool news = false;
        std::erase_if(under_way_, [&](const Flying& flying) {
            if (flying.due > now + 1e-9) return false;
            if (!newest_ || flying.number > newest_number_) {
                newest_ = flying.thing;
                newest_number_ = flying.number;
                news = true;
            }
            return true;
        });
        return news;
    }
    const std::optional<Thing>& newest() const { return newest_; }

  private:
    struct Flying {
        std::uint64_t number;
        double due;
        Thing thing;
    };
    std::vector<Flying> under_way_;
    std::optional<Thing> newest_;
    std::uint64_t number_ = 0, newest_number_ = 0, sent_ = 0;
};

}  // namespace stability
