#pragma once

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace examples {

/// When the example ends: --seconds N after its start, 5 without.
inline std::chrono::steady_clock::time_point end_of(int argc, char** argv) {
    double seconds = 5;
    if (argc > 1) {
        char* rest = nullptr;
        const bool known = argc == 3 && std::string(argv[1]) == "--seconds";
        seconds = known ? std::strtod(argv[2], &rest) : 0;
        if (!known || rest == argv[2] || *rest != '\0' || !(seconds > 0 && seconds < 1e6))
            throw std::runtime_error(std::string("usage: ") + argv[0] + " [--seconds N]");
    }
    return std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                  std::chrono::duration<double>(seconds));
}

}  // namespace examples
