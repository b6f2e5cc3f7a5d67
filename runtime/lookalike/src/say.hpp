#pragma once
// What a look-alike has to say to whoever started the program: on standard error, each line once.

#include <string>

namespace knurl::lookalike {

/// "knurl as dhd: TEXT", the first time that this text is said in this process.
void say_once(const std::string& text) noexcept;

/// "dhd" or "hd": which library this is.
extern const char* const which;

}  // namespace knurl::lookalike
