#pragma once
// Which right a process lacks, and which command gives it: the kernel's "Operation not permitted" has several
// reasons, and what mends one is useless against the others.

#include <filesystem>
#include <string>

namespace knurl::servo {

/// What the kernel says of this process and the groups that it is in. `root`: "/", or a folder in a test.
class Rights {
  public:
    explicit Rights(std::filesystem::path root = "/") : root_(std::move(root)) {}

    /// A capability counts for priorities and memory only outside of a user namespace, whose root it is.
    bool in_user_namespace() const;
    /// One of linux/capability.h, effective and counting.
    bool capable(int capability) const;
    /// SCHED_FIFO at this priority, as far as capabilities and limits go; the groups come on top.
    bool may_be_real_time(int priority) const;

    /// Why SCHED_FIFO was refused and what to do: "reason; run: command".
    std::string why_no_priority(int priority) const;
    /// Of memory that cannot be locked: what gives the right, as a command.
    std::string memory_command() const;

    static constexpr int ipc_lock = 14, sys_nice = 23;  // linux/capability.h

  private:
    struct Group {
        std::string name;              // as /proc/self/cgroup has it
        std::filesystem::path folder;  // where the kernel shows it
        std::filesystem::path top;     // of its hierarchy
        bool v1 = false;
    };
    /// The group whose budget of real time counts for this process; `name` is empty: there is none.
    Group budget_group() const;
    long number_in(const std::filesystem::path& file, long otherwise) const;

    std::filesystem::path root_;
};

}  // namespace knurl::servo
