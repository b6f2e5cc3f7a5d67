#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace knurl::measure {

/// A knurld of this process's own, in a directory of its own, so that it meets no other. It ends with this
/// object, or with this process.
class PrivateServo {
  public:
    /// Starts the knurld that lies beside this program (else the PATH's) with these arguments.
    /// KNURL_RUNTIME_DIR and KNURL_STATE_DIR are set for this process too. Throws std::runtime_error.
    explicit PrivateServo(const std::vector<std::string>& arguments);
    ~PrivateServo();
    PrivateServo(const PrivateServo&) = delete;
    PrivateServo& operator=(const PrivateServo&) = delete;

    const std::string& address() const { return address_; }  // for Client::connect
    pid_t pid() const { return pid_; }
    /// What it has said so far (a servo that cannot start says why).
    std::string said() const;
    /// Throws std::runtime_error with what it said if it has ended.
    void require_running();

  private:
    std::string directory_;
    std::string address_;
    pid_t pid_ = -1;
};

}  // namespace knurl::measure
