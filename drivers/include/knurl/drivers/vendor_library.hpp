#pragma once

/// @file
/// A maker's library that the user has installed: where it may be, and whether this program can load it. Nothing here
/// loads it: knurl-device does.

#include <string>
#include <vector>

namespace knurl::drivers {

/// A maker's library.
struct VendorLibrary {
    /// Scheme of the driver that needs it: "dhd".
    std::string scheme;
    /// Whose it is: "Force Dimension SDK".
    std::string product;
    /// Variable of the environment that names a file or folder of the user's own: "KNURL_LIBDHD".
    std::string variable;
    /// File names, the preferred one first: "libdhd.so.3".
    std::vector<std::string> names;
    /// Folders in which its maker's installer puts it; a star stands for part of a name.
    std::vector<std::string> folders;
    /// What to do where it is missing.
    std::string remedy;
};

/// The libraries that drivers of this build can use.
const std::vector<VendorLibrary>& vendor_libraries();
/// The library of one scheme; nullptr: that driver needs none.
const VendorLibrary* vendor_library(const std::string& scheme);

/// A file that may be the library.
struct FoundLibrary {
    /// Its path.
    std::string path;
    /// Why it cannot be loaded; empty: nothing is known against it.
    std::string problem;
};

/// Looks where `library` may be: the variable alone if it is set, else LD_LIBRARY_PATH, the system's folders, the
/// maker's. The first usable file is the first; unusable ones come after it. Throws std::runtime_error if the variable
/// names nothing.
std::vector<FoundLibrary> find_library(const VendorLibrary& library);

/// Why this process could not load such a file: not there, no rights, no library, of another kind of machine. Empty:
/// nothing is known against it.
std::string why_not_loadable(const std::string& path);

}  // namespace knurl::drivers
