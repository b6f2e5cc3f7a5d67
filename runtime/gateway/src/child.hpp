#pragma once
// A program that runs beside this one: `knurl record`, `knurl doctor`. Nothing here waits for it.

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/shm/fd.hpp>

namespace knurl::gateway {

class Child {
  public:
    /// Starts `words` (the program first), with no input. Its output and errors are kept, up to 256 kB. Throws
    /// std::runtime_error.
    explicit Child(const std::vector<std::string>& words);
    /// Interrupts it, and waits for its end, at most a second.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Reads what it has said. Returns its exit code once it has ended (128 + n: by signal n).
    std::optional<int> look();
    /// Ends it as Ctrl-C would.
    void interrupt() noexcept;
    const std::string& said() const { return said_; }

  private:
    pid_t pid_ = -1;
    shm::UniqueFd out_;
    std::string said_;
    std::optional<int> code_;
};

}  // namespace knurl::gateway
