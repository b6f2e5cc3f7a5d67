#pragma once
// What must hold for every input of a fuzz target. If it does not, the process aborts, and its caller keeps
// the input.

#include <cstdio>
#include <cstdlib>

namespace knurl::fuzz {

// (Clang 14 has no std::source_location.)
inline void require(bool holds, const char* what = "", const char* file = __builtin_FILE(),
                    int line = __builtin_LINE()) {
    if (holds) return;
    std::fprintf(stderr, "%s:%d: broken: %s\n", file, line, what);
    std::abort();
}

}  // namespace knurl::fuzz
