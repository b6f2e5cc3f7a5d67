#pragma once
// The terminal of a verb that shows something live.

#include <csignal>
#include <cstddef>
#include <optional>
#include <string>

#include <knurl/measure/grip.hpp>

namespace knurl::cli {

// Around what is wrong, which a terminal that has colours shows in red.
inline constexpr char wrong_begins = '\1', wrong_ends = '\2';
inline std::string wrong(const std::string& text) {
    return wrong_begins + text + wrong_ends;
}
/// The marks as escape sequences, or left out.
std::string shown(const std::string& text, bool colours);

/// `text` as it fits a terminal: a line that is too wide goes on in the next ones, indented by four more,
/// broken where it has two spaces or more; what still is too wide is cut off; of lines that find no room the
/// last one says how many.
std::string fitted(const std::string& text, std::size_t columns, std::size_t rows);

/// While this lives, interrupts end waits instead of the program. On a terminal it has a page of its own, of
/// the size that the terminal has at the moment, and what was there before comes back afterwards (also when
/// it is suspended); elsewhere the text goes out as it is.
class Terminal {
  public:
    /// `page`: make one, if standard output is a terminal that can.
    explicit Terminal(bool page);
    ~Terminal();
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    /// Replaces what is there; elsewhere, follows it.
    void show(const std::string& text);
    /// False: somebody asked the program to end meanwhile, by a signal or the key q.
    bool wait(double seconds);

  private:
    void enter();
    void leave();
    void draw() const;

    bool page_, colours_;
    std::string shown_;
    sigset_t signals_, before_;
    std::optional<measure::Keys> keys_;  // while there is a page
};

}  // namespace knurl::cli
