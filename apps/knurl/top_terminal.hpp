#pragma once
// The terminal for a verb with live output.

#include <csignal>
#include <cstddef>
#include <optional>
#include <string>

#include <knurl/measure/grip.hpp>

namespace knurl::cli {

// Around faulty values, which a colour terminal shows in red.
inline constexpr char wrong_begins = '\1', wrong_ends = '\2';
inline std::string wrong(const std::string& text) {
    return wrong_begins + text + wrong_ends;
}
/// The marks as escape sequences, or removed.
std::string shown(const std::string& text, bool colours);

/// `text` fitted to a terminal. A line that is too wide continues in the next ones, indented by four more,
/// broken at two spaces or more; the rest is cut off. If lines do not fit, the last one states their number.
std::string fitted(const std::string& text, std::size_t columns, std::size_t rows);

/// While this lives, interrupts end waits instead of the program. On a terminal it uses a separate page of
/// the present size, and restores the old content afterwards (also when suspended). Elsewhere the text is
/// written as it is.
class Terminal {
  public:
    /// `page`: create one, if standard output is a terminal that supports it.
    explicit Terminal(bool page);
    ~Terminal();
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    /// Replaces the old text; elsewhere, follows it.
    void show(const std::string& text);
    /// False: a signal or the key q asked the program to end.
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
