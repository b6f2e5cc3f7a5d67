#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/meshfile/unit.hpp>

namespace knurl::meshfile {

namespace {

struct Known {
    const char* name;
    double metres;
};
constexpr std::array known{Known{"mm", 1e-3}, Known{"cm", 1e-2}, Known{"m", 1}, Known{"in", 0.0254},
                           Known{"um", 1e-6}};
constexpr double in_the_hand = 0.2;  // m
constexpr double large = 5, small = 1e-3;

}  // namespace

Unit unit_of(const std::string& name) {
    for (const Known& one : known)
        if (name == one.name) return {.name = name, .metres = one.metres};
    throw std::runtime_error(fmt::format("unit \"{}\" is not known; give one of mm, cm, m, in, um", name));
}

Unit guessed_unit(double size) {
    Unit best{.name = "m", .metres = 1, .guessed = true};
    double off = INFINITY;
    for (const Known& one : {known[0], known[1], known[2]}) {
        const double here = std::abs(std::log(size * one.metres / in_the_hand));
        if (!(here < off)) continue;
        off = here;
        best.name = one.name;
        best.metres = one.metres;
    }
    return best;
}

std::optional<std::string> odd_size(double metres) {
    if (metres > large) return fmt::format("it is {:.3g} m large: is the unit right? (--unit)", metres);
    if (metres < small)
        return fmt::format("it is {:.3g} um small: is the unit right? (--unit)", metres * 1e6);
    return std::nullopt;
}

}  // namespace knurl::meshfile
