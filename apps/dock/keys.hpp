#pragma once
// Single keys from the terminal, if there is one; as it was when this object goes.

#include <termios.h>
#include <unistd.h>

namespace dock {

class Keys {
  public:
    Keys() {
        if (::isatty(STDIN_FILENO) == 0 || ::tcgetattr(STDIN_FILENO, &before_) != 0) return;
        // A program in the background would be stopped by the terminal.
        if (::tcgetpgrp(STDIN_FILENO) != ::getpgrp()) return;
        termios keys = before_;
        keys.c_lflag &= static_cast<tcflag_t>(~(ICANON | ECHO));
        keys.c_cc[VMIN] = keys.c_cc[VTIME] = 0;
        there_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
    }
    ~Keys() {
        if (there_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    }
    Keys(const Keys&) = delete;
    Keys& operator=(const Keys&) = delete;

    bool there() const { return there_; }
    /// One that was pressed; 0: none.
    char next() {
        char key = 0;
        return there_ && ::read(STDIN_FILENO, &key, 1) == 1 ? key : '\0';
    }

  private:
    termios before_{};
    bool there_ = false;
};

}  // namespace dock
