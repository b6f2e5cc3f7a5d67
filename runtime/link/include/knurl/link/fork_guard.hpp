#pragma once

/// @file
/// A forked child has copies of the library's descriptors and memory. If it kept the socket open, the servo
/// would not see the parent die; if it used a ring, two producers would share one index. So at fork the
/// child's copies of the sockets are replaced by /dev/null, and everything made before the fork is inert in
/// it.

#include <cstdint>
#include <memory>
#include <utility>

namespace knurl::detail {

/// Goes up in the child of every fork: whoever remembers another number was made by an ancestor.
std::uint64_t fork_generation() noexcept;

/// While it lives, a fork's child loses `fd`.
class LostInChild {
  public:
    explicit LostInChild(int fd);
    ~LostInChild();
    LostInChild(const LostInChild&) = delete;
    LostInChild& operator=(const LostInChild&) = delete;

  private:
    int fd_;
    std::uint64_t made_in_ = fork_generation();
};

/// Throws Error::after_fork if the object that remembers `made_in` belongs to an ancestor of this process.
void require_own(std::uint64_t made_in);

/// A shared object that is destroyed only by the process that made it: a child leaves it as it is, since its
/// mutexes may be locked by threads that the child does not have. `close()` runs first.
template <class T, class... Args>
std::shared_ptr<T> make_own(Args&&... args) {
    return std::shared_ptr<T>(new T(std::forward<Args>(args)...), [made_in = fork_generation()](T* object) {
        if (fork_generation() != made_in) return;
        object->close();
        delete object;
    });
}

}  // namespace knurl::detail
