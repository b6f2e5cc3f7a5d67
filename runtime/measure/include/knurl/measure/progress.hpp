#pragma once
// The progress of long work, for a person at a terminal.

#include <chrono>
#include <string>

namespace knurl::measure {

/// One line of standard error, overwritten at most ten times a second, and removed at the end. Without a
/// terminal nothing is written.
class Progress {
  public:
    /// `who`: "knurl record".
    explicit Progress(std::string who);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// "12 of 60 s", ...; skipped if the last one was too recent.
    void show(const std::string& text);
    /// The terminal is free for other lines until the next show().
    void clear();

  private:
    std::string who_;
    bool terminal_;
    std::size_t shown_ = 0;  // columns
    std::chrono::steady_clock::time_point next_{};
};

/// "12 of 60 s", or "12 s" without a known end.
std::string seconds_of(double done, double all);

}  // namespace knurl::measure
