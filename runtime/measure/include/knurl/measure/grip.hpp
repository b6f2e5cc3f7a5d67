#pragma once
// How a person takes a thing and releases it: space, or the device's first button while it is pressed.

#include <cstdint>
#include <optional>

#include <termios.h>
#include <unistd.h>

namespace knurl::measure {

/// Single keys from the terminal, if there is one. The terminal's settings are restored at the end.
class Keys {
  public:
    /// `suspends`: Ctrl-Z suspends, as usual.
    explicit Keys(bool suspends = false) {
        if (::isatty(STDIN_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &before_) != 0) return;
        // The terminal would stop a program in the background.
        if (::tcgetpgrp(STDIN_FILENO) != ::getpgrp()) return;
        termios keys = before_;
        keys.c_lflag &= static_cast<tcflag_t>(~(ICANON | ECHO));
        keys.c_cc[VMIN] = keys.c_cc[VTIME] = 0;
        if (!suspends)
            keys.c_cc[VSUSP] = _POSIX_VDISABLE;  // a suspended program would continue to hold the body
        there_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
    }
    ~Keys() {
        if (there_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    }
    Keys(const Keys&) = delete;
    Keys& operator=(const Keys&) = delete;

    bool there() const { return there_; }
    /// A key that was pressed; 0: none.
    char next() {
        char key = 0;
        return there_ && ::read(STDIN_FILENO, &key, 1) == 1 ? key : '\0';
    }

  private:
    termios before_{};
    bool there_ = false;
};

/// Should something be taken (true) or released (false)? Nothing: neither.
class Grip {
  public:
    /// In every cycle.
    std::optional<bool> button(std::uint32_t buttons) {
        const bool pressed = (buttons & 1) != 0;
        if (pressed == pressed_) return {};
        return pressed_ = pressed;
    }
    static std::optional<bool> key(char key, bool holds) {
        return key == ' ' ? std::optional(!holds) : std::nullopt;
    }

  private:
    bool pressed_ = false;
};

}  // namespace knurl::measure
