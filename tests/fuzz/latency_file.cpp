// Any bytes as a file of `knurl latency --json`: refused in one line, or a run that stays the same when it is
// written and read again, and that can be compared.

#include <cstdint>
#include <stdexcept>
#include <string>

#include "latency_compare.hpp"
#include "refusal.hpp"

using namespace knurl;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const cli::LatencyFile file =
            cli::parse_latency_file({reinterpret_cast<const char*>(data), size}, "l.json");
        require(file.setting.is_object(), "there is a setting");
        const std::string text = measure::to_json(file.run);
        require(measure::to_json(measure::from_json(text)) == text, "it reads what it writes");
        const std::string said = cli::to_text(cli::compare_runs(file, file));
        for (const char c : said)
            require(static_cast<unsigned char>(c) >= ' ' || c == '\n', "a comparison is lines of text");
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "l.json: ");
    }
    return 0;
}
