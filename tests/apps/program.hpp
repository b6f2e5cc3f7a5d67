#pragma once
// Runs the programs as a person does, and checks their output.

#include <csignal>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/shm/fd.hpp>

#include "../eventually.hpp"
#include "../rights.hpp"
#include "../temp_folder.hpp"

namespace knurl::test {

struct Outcome {
    int code = 0;  // exit code; 128 + signal if it was killed
    std::string out, err;
};

/// Runs a program to its end.
Outcome run(const std::vector<std::string>& words);
/// Where `knurl` and `knurld` are.
std::string knurl_program();
std::string knurld_program();
/// `knurl WORDS...`
Outcome knurl(std::vector<std::string> words);

/// A program that runs beside the test. SIGTERM ends it with this object at the latest.
class Background {
  public:
    explicit Background(const std::vector<std::string>& words);
    ~Background() { end(SIGTERM); }
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    pid_t pid() const { return pid_; }
    /// Waits until it has printed this, on either stream. False: it has ended, or not within half a minute.
    bool says(const std::string& text);
    /// Its whole output, up to its end.
    const std::string& said() const { return said_; }
    /// Sends the signal and waits for its end: the exit code, 128 + signal if it was killed.
    int end(int signal);

  private:
    bool read_some(int timeout_ms);

    pid_t pid_ = -1;
    shm::UniqueFd output_;
    std::string said_;
};

/// A knurld in KNURL_RUNTIME_DIR. After construction it listens, or the test has failed.
class Servo : public Background {
  public:
    explicit Servo(const std::vector<std::string>& words);
};

/// A program on a terminal. SIGKILL ends it with this object at the latest.
class OnTerminal {
  public:
    explicit OnTerminal(const std::vector<std::string>& words, unsigned short columns = 100,
                        unsigned short rows = 30);
    ~OnTerminal();
    OnTerminal(const OnTerminal&) = delete;
    OnTerminal& operator=(const OnTerminal&) = delete;

    pid_t pid() const { return pid_; }
    void type(char key);
    bool shows(const std::string& text);
    bool shows_one_of(const std::vector<std::string>& texts);
    /// Reads its output up to its end; returns its exit code.
    int end();
    std::string shown;

  private:
    bool read();

    pid_t pid_ = -1;
    shm::UniqueFd terminal_;
};

using Folder = TempFolder;

/// Can this process start another one without the right to real-time priority?
Missing missing_loss_of_rights();
/// `knurl WORDS...` of a copy in `folder`, with knurld beside it: without real-time priority, 64 KiB to lock;
/// as user nobody, if this user may become that.
Outcome knurl_without_rights(const Folder& folder, std::vector<std::string> words);

/// A directory for sockets and saved state, to which KNURL_RUNTIME_DIR and KNURL_STATE_DIR point.
class Home : public Folder {
  public:
    Home();
};

std::string text_of_file(const std::string& path);
/// The number before `what` in a text; -1: it does not occur.
int number_before(const std::string& text, const std::string& what);

}  // namespace knurl::test
