#pragma once
// The parts of the reference's pages.

#include <string>
#include <string_view>
#include <vector>

namespace knurl::reference {

/// A table of Markdown. Each row has as many cells as there are columns.
std::string table(const std::vector<std::string_view>& columns,
                  const std::vector<std::vector<std::string>>& rows);

/// docs/reference/representations.md: every kind with each of its fields.
std::string representations();
/// The keys that AddOptions and ProbePlacement have in a scene file, with range and default.
std::vector<std::vector<std::string>> probe_keys();

}  // namespace knurl::reference
