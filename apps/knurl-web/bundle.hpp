#pragma once
// The page's files, which are a part of the program.

#include <string_view>
#include <vector>

#include <knurl/gateway/server.hpp>

namespace knurl::web {

struct BundledFile {
    std::string_view path;  // "/app.js"
    std::string_view content;
};

/// As they are in apps/knurl-web/bundle. Made by CMake.
std::vector<BundledFile> bundled_files();

/// The same with their types, names of their content, and compressed. Made once; lives as long as the program.
const std::vector<gateway::StaticFile>& page_files();

}  // namespace knurl::web
