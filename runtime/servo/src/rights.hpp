#pragma once
// Which right a process lacks, and which command grants it. The kernel's "Operation not permitted" has
// several causes, and each needs its own remedy.

#include <filesystem>
#include <string>

namespace knurl::servo {

/// What the kernel says about this process and its groups. `root`: "/", or a folder in a test.
class Rights {
  public:
    explicit Rights(std::filesystem::path root = "/") : root_(std::move(root)) {}

    /// A capability counts for priorities and memory only outside a user namespace, even for the namespace's
    /// root.
    bool in_user_namespace() const;
    /// A capability from linux/capability.h: is it effective, and does it count here?
    bool capable(int capability) const;
    /// May SCHED_FIFO run at this priority, by capabilities and limits? The groups' budgets are not included.
    bool may_be_real_time(int priority) const;

    /// Why SCHED_FIFO was refused and what to do: "reason; run: command".
    std::string why_no_priority(int priority) const;
    /// The command that grants the right to lock memory.
    std::string memory_command() const;

    static constexpr int ipc_lock = 14, sys_nice = 23;  // linux/capability.h

  private:
    struct Group {
        std::string name;              // as in /proc/self/cgroup
        std::filesystem::path folder;  // where the kernel shows the group
        std::filesystem::path top;     // of its hierarchy
        bool v1 = false;
    };
    /// The group whose real-time budget counts for this process; empty `name`: none.
    Group budget_group() const;
    long number_in(const std::filesystem::path& file, long otherwise) const;

    std::filesystem::path root_;
};

}  // namespace knurl::servo
