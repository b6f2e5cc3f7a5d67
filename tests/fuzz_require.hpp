#pragma once
// What must hold whatever a fuzz target is given. libFuzzer keeps the input of a process that aborts.

#include <cstdio>
#include <cstdlib>

namespace knurl::fuzz {

inline void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "broken: %s\n", what);
    std::abort();
}

}  // namespace knurl::fuzz
