#pragma once

/// @file
/// knurl::Error, which every call of the library may throw.

#include <knurl/link/error.hpp>
