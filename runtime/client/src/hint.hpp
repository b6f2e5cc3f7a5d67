#pragma once
// Hints to a program that uses the library in an unintended way: one line each, once.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace knurl::detail {

inline bool hints_wanted(bool option) {
    const char* environment = std::getenv("KNURL_HINTS");
    return option && (environment == nullptr || std::string_view(environment) != "0");
}

inline void hint(const std::string& device, const std::string& what) {
    std::fprintf(stderr, "knurl: device '%s': %s (KNURL_HINTS=0: not told)\n", device.c_str(), what.c_str());
}

/// A condition that must last for a while; servo time, ns.
class Lasting {
  public:
    /// True: the condition has lasted for `limit`, and this was not reported before.
    bool now(bool is_so, std::int64_t time, std::int64_t limit) noexcept {
        if (!is_so) since_ = 0;
        if (!is_so || said_) return false;
        if (since_ == 0) since_ = time;
        said_ = time - since_ >= limit;
        return said_;
    }
    bool said() const noexcept { return said_; }
    void restart() noexcept { since_ = 0; }

  private:
    std::int64_t since_ = 0;
    bool said_ = false;
};

}  // namespace knurl::detail
