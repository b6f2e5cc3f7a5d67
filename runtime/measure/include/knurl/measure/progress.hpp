#pragma once
// How far long work is, for whoever waits at a terminal.

#include <chrono>
#include <string>

namespace knurl::measure {

/// One line of standard error, written over itself at most ten times a second, and gone with this object. Where
/// standard error is no terminal nothing is written.
class Progress {
  public:
    /// `who`: "knurl record".
    explicit Progress(std::string who);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// "12 of 60 s", ...; what comes too soon after the last one is left out.
    void show(const std::string& text);
    /// The terminal is free for other lines until the next show().
    void clear();

  private:
    std::string who_;
    bool terminal_;
    std::size_t shown_ = 0;  // columns
    std::chrono::steady_clock::time_point next_{};
};

/// "12 of 60 s", or of an end that nobody knows "12 s".
std::string seconds_of(double done, double all);

}  // namespace knurl::measure
