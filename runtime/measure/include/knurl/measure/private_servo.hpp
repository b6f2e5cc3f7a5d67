#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace knurl::measure {

/// A knurld for this process, in a separate directory, so that it meets no other servo. It ends with this
/// object, or with this process.
class PrivateServo {
  public:
    /// Starts the knurld beside this program (else the PATH's) with these arguments. Sets KNURL_RUNTIME_DIR
    /// and KNURL_STATE_DIR for this process too. Throws std::runtime_error.
    explicit PrivateServo(const std::vector<std::string>& arguments);
    ~PrivateServo();
    PrivateServo(const PrivateServo&) = delete;
    PrivateServo& operator=(const PrivateServo&) = delete;

    const std::string& address() const { return address_; }  // for Client::connect
    pid_t pid() const { return pid_; }
    /// Its output so far (a servo that cannot start gives the reason).
    std::string said() const;
    /// Throws std::runtime_error with its output if it has ended.
    void require_running();

  private:
    std::string directory_;
    std::string address_;
    pid_t pid_ = -1;
};

}  // namespace knurl::measure
