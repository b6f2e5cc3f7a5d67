#pragma once
// The unit of a mesh file, whose numbers have none.

#include <optional>
#include <string>

namespace knurl::meshfile {

struct Unit {
    std::string name;   // "mm"
    double metres = 1;  // of one unit
    bool guessed = false;
};

/// mm, cm, m, in, um. Throws std::runtime_error with the list.
Unit unit_of(const std::string& name);

/// Guesses the unit for a thing of hand size: of mm, cm and m the one that brings the diagonal nearest to 0.2
/// m, in orders of magnitude.
Unit guessed_unit(double size);

/// A remark on an implausibly large or small thing. None: a plausible size.
std::optional<std::string> odd_size(double metres);

}  // namespace knurl::meshfile
