#include "call.hpp"

#include <algorithm>
#include <array>

namespace knurl::capi {

namespace {

struct Line {
    const void* handle = nullptr;
    std::string text;
};

// A program asks for the line of what has just failed. A thread that uses more handles than this between a
// failure and its question gets an empty line.
struct Lines {
    std::array<Line, 8> of;
    std::size_t newest = 0;
    std::int32_t holder = 0;
};

Lines& lines() {
    thread_local Lines all;
    return all;
}

constexpr int codes[] = {KNURL_NO_SERVO,     KNURL_PERMISSION,     KNURL_INCOMPATIBLE, KNURL_NO_SUCH_DEVICE,
                         KNURL_DEVICE_HELD,  KNURL_BAD_PARAMETERS, KNURL_CHANNEL_FULL, KNURL_REFUSED,
                         KNURL_DISCONNECTED, KNURL_AFTER_FORK,     KNURL_STALE,        KNURL_EXHAUSTED};

}  // namespace

int failed(int code, const void* handle, const char* text, std::int32_t holder) noexcept {
    try {
        Lines& all = lines();
        auto found = std::ranges::find(all.of, handle, &Line::handle);
        if (found == all.of.end())
            found = all.of.begin() + static_cast<std::ptrdiff_t>((all.newest + 1) % all.of.size());
        *found = {.handle = handle, .text = text};
        // One line, also where it repeats a text of the caller's that is none.
        std::ranges::replace_if(
            found->text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
        all.newest = static_cast<std::size_t>(found - all.of.begin());
        all.holder = holder;
    } catch (const std::exception&) {  // no memory for the line: the code alone
    }
    return code;
}

const char* last_line() noexcept {
    const Lines& all = lines();
    return all.of[all.newest].text.c_str();
}

const char* line_of(const void* handle) noexcept {
    const Lines& all = lines();
    const auto found = std::ranges::find(all.of, handle, &Line::handle);
    return found == all.of.end() ? "" : found->text.c_str();
}

std::int32_t last_holder() noexcept {
    return lines().holder;
}

int code_of(Error::Kind kind) noexcept {
    const auto number = static_cast<std::size_t>(kind);
    return number < std::size(codes) ? codes[number] : KNURL_UNKNOWN;
}

void require_pointer(const void* pointer, const char* what) {
    if (pointer == nullptr)
        throw Failed(KNURL_BAD_ARGUMENT, std::string(what) + " is NULL; give its address");
}

void require_size(std::uint64_t size, std::size_t least, const char* what) {
    // No struct of this library will ever be so long; a size that was not set is often so. All of them have
    // the alignment of a double.
    constexpr std::uint64_t longest = 1 << 16;
    if (size < least || size > longest || size % alignof(double) != 0)
        throw Failed(KNURL_BAD_ARGUMENT, std::string(what) + ": its size is " + std::to_string(size) +
                                             "; set it to sizeof, " + std::to_string(least) + " or more");
}

void require_size(const void* given, std::size_t least, std::size_t known, const char* what) {
    std::uint64_t size = 0;
    std::memcpy(&size, given, sizeof size);
    require_size(size, least, what);
    const auto* bytes = static_cast<const std::byte*>(given);
    if (size > known &&
        std::any_of(bytes + known, bytes + size, [](std::byte byte) { return byte != std::byte{0}; }))
        throw Failed(KNURL_BAD_ARGUMENT, std::string(what) + ": this library (" + version +
                                             ") knows its first " + std::to_string(known) +
                                             " bytes, and others are set; install a newer libknurl");
}

knurl_add_options default_add_options() {
    const AddOptions usual;
    return {.size = sizeof(knurl_add_options),
            .probe = usual.probe,
            .on_silence = static_cast<std::uint32_t>(usual.on_silence),
            .silence_time = usual.silence_time,
            .feedback = usual.feedback,
            .reserved = 0};
}

AddOptions add_options_of(const knurl_add_options* options) {
    const knurl_add_options defaults = default_add_options();
    const knurl_add_options given = read_struct(options, defaults, "knurl_add_options");
    return {.probe = given.probe,
            .on_silence = static_cast<OnSilence>(given.on_silence),
            .silence_time = given.silence_time,
            .feedback = given.feedback};
}

const Layout& layout_of(std::uint32_t kind) {
    if (kind >= layouts().size())
        throw Failed(KNURL_BAD_ARGUMENT, "kind " + std::to_string(kind) + " is not known to this library (" +
                                             version + "), which has " + std::to_string(layouts().size()) +
                                             " kinds");
    return layouts()[kind];
}

Parameters::Parameters(std::uint32_t kind, const void* given) : size_(layout_of(kind).defaults.size()) {
    const Layout& layout = layout_of(kind);
    const std::string what = "parameters of a " + std::string(kinds()[kind].name);
    require_pointer(given, what.c_str());
    require_size(given, layout.first_size, layout.size, what.c_str());
    layout.read(given, {at_, size_});
}

}  // namespace knurl::capi
