#pragma once
// A log that no caller can fill: a page that is refused tries again at once, and from many addresses.

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <utility>

namespace knurl::gateway {

class LimitedLog {
  public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::chrono::seconds between{1};  // lines of one kind
    static constexpr std::chrono::seconds repeat{60};  // the same refusal of the same host
    static constexpr std::size_t most_hosts = 64;      // remembered

    explicit LimitedLog(std::function<void(const std::string&)> write) : write_(std::move(write)) {}

    /// `kind`: one of a few, fixed texts.
    void say(const std::string& kind, const std::string& line, Time now) {
        if (!write_) return;
        Kind& of = kinds_[kind];
        if (of.said && now - of.when < between) {
            ++of.unsaid;
            return;
        }
        write_(of.unsaid == 0 ? line : line + " (and " + std::to_string(of.unsaid) + " more of this kind)");
        of = {.when = now, .said = true};
    }
    /// Somebody of that host is refused.
    void refused(const std::string& kind, const std::string& host, const std::string& line, Time now) {
        const std::string key = kind + ' ' + host;
        for (const auto& [each, when] : hosts_)
            if (each == key && now - when < repeat) return;
        std::erase_if(hosts_, [&](const auto& each) { return each.first == key; });
        if (hosts_.size() >= most_hosts) hosts_.pop_front();
        hosts_.emplace_back(key, now);
        say(kind, line, now);
    }

  private:
    struct Kind {
        Time when{};
        bool said = false;
        std::size_t unsaid = 0;
    };
    std::function<void(const std::string&)> write_;
    std::map<std::string, Kind> kinds_;
    std::deque<std::pair<std::string, Time>> hosts_;
};

}  // namespace knurl::gateway
