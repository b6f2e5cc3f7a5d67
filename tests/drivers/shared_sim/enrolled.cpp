// Linked as an object file: a program (a knurld for the chaos runner) has the driver without a call.
#include "shared_sim.hpp"

namespace {
[[maybe_unused]] const bool enrolled = (knurl::drivers::shared_sim::enrol(), true);
}
