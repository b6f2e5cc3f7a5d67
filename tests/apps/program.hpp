#pragma once
// Runs the programs as a person does, and looks at what they say.

#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace knurl::test {

struct Outcome {
    int code = 0;  // exit code; 128 + signal if it was killed
    std::string out, err;
};

/// Runs a program to its end.
Outcome run(const std::vector<std::string>& words);
/// Where `knurl` is.
std::string knurl_program();
/// `knurl WORDS...`
Outcome knurl(std::vector<std::string> words);

/// A knurld, where KNURL_RUNTIME_DIR says. Ends with this object.
class Servo {
  public:
    /// Returns when it listens; fails the test if it does not.
    explicit Servo(const std::vector<std::string>& words);
    ~Servo();
    Servo(const Servo&) = delete;
    Servo& operator=(const Servo&) = delete;

    pid_t pid() const { return pid_; }
    /// SIGKILL: it leaves its socket behind.
    void kill();

  private:
    pid_t pid_;
};

/// Until `condition` holds; fails the test after 10 s.
void eventually(const std::function<bool()>& condition, const char* what);

/// A directory that goes away with this object.
class Folder {
  public:
    Folder();
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::string path(const std::string& name) const { return path_ + "/" + name; }
    /// Writes the file and returns its path.
    std::string file(const std::string& name, const std::string& text) const;

  private:
    std::string path_;
};

/// A directory for sockets and saved state, to which KNURL_RUNTIME_DIR and KNURL_STATE_DIR point.
class Home : public Folder {
  public:
    Home();
};

std::string text_of_file(const std::string& path);

}  // namespace knurl::test
