#include "say.hpp"

#include <cstdio>
#include <mutex>
#include <set>

namespace knurl::lookalike {

void say_once(const std::string& text) noexcept try {
    // Never destroyed: a thread of the program may still call while the process ends.
    static auto& mutex = *new std::mutex;
    static auto& said = *new std::set<std::string>;
    constexpr std::size_t most = 1000;  // lines; an error that holds a number must not fill the memory
    const std::lock_guard lock(mutex);
    if (said.size() < most && said.insert(text).second)
        std::fprintf(stderr, "knurl as %s: %s\n", which, text.c_str());
} catch (...) {
    // No memory for a line: the code that the function returns says it as well.
}

}  // namespace knurl::lookalike
