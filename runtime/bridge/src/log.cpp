#include "log.hpp"

#include <algorithm>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/link/text.hpp>

namespace knurl::bridge {

bool Log::say(const std::string& line, Allowance& allowance, std::int64_t now_ns) {
    if (const std::int64_t second = now_ns / 1'000'000'000; second != allowance.second)
        allowance = {.second = second, .used = 0};
    if (allowance.used >= lines_per_second ||
        (left_out_ > 0 && !write_(detail::format("({} lines were left out)", left_out_)))) {
        ++left_out_;
        return false;
    }
    left_out_ = 0;
    ++allowance.used;
    if (write_(line)) return true;
    ++left_out_;
    return false;
}

void Log::event(const std::string& line, std::int64_t now_ns) {
    say(line, events_, now_ns);
}

void Log::catch_up(const sockaddr_storage& host, const RefusedHost* except, std::int64_t now_ns) {
    for (RefusedHost& each : refused_) {
        if (&each == except || each.unsaid == 0 || !same_host(each.host, host)) continue;
        if (say(detail::format("{}: not let in, {} times more until now: {}", numeric(each.host), each.unsaid,
                               each.why),
                refusals_, now_ns))
            each.unsaid = 0;
    }
}

void Log::refused(const sockaddr_storage& host, const std::string& who, const std::string& why,
                  std::int64_t now_ns) {
    const auto known = std::find_if(refused_.begin(), refused_.end(), [&](const RefusedHost& each) {
        return each.why == why && same_host(each.host, host);
    });
    if (known != refused_.end() && now_ns - known->said_ns < repeat_ns) {
        ++known->unsaid;
        return;
    }
    RefusedHost& place = known != refused_.end()
                             ? *known
                             : *std::min_element(refused_.begin(), refused_.end(),
                                                 [](const RefusedHost& a, const RefusedHost& b) {
                                                     return a.said_ns < b.said_ns;
                                                 });
    catch_up(host, &place, now_ns);
    const std::uint64_t unsaid = known != refused_.end() ? known->unsaid : 0;
    if (!say(detail::format(
                 "{}: not let in: {}{}", who, why,
                 unsaid > 0 ? detail::format(" ({} times more since that was last said)", unsaid) : ""),
             refusals_, now_ns))
        return;
    if (known == refused_.end()) left_out_ += place.unsaid;  // no later line would report it
    place = {.host = host, .why = why, .said_ns = now_ns, .unsaid = 0};
}

void Log::admitted(const sockaddr_storage& host, const std::string& line, std::int64_t now_ns) {
    catch_up(host, nullptr, now_ns);
    say(line, events_, now_ns);
}

}  // namespace knurl::bridge
