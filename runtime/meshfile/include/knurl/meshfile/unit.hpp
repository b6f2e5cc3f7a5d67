#pragma once
// A mesh file says numbers, not metres.

#include <optional>
#include <string>

namespace knurl::meshfile {

struct Unit {
    std::string name;   // "mm"
    double metres = 1;  // of one
    bool guessed = false;
};

/// mm, cm, m, in, um. Throws std::runtime_error with the list.
Unit unit_of(const std::string& name);

/// The one that makes the thing nearest to what a hand can hold: of mm, cm and m that which makes its
/// diagonal nearest to 0.2 m, in orders of magnitude.
Unit guessed_unit(double size);

/// What to tell of a thing that is surely not meant to be so large, or so small. None: it is a sensible size.
std::optional<std::string> odd_size(double metres);

}  // namespace knurl::meshfile
