#pragma once

/// @file
/// TOML as Knurl reads it: the one place that calls toml++. A source that includes this links toml++.
///
/// toml++ 3.3 asserts, or goes on into undefined behaviour, on a table header that begins with no name
/// (`[[` and a NUL, `[=]`), on `}` where an array wants a value, on a date whose time begins with no digit, and
/// on characters beyond ASCII outside quotes and comments, or in what it does not take for quotes (`1"x"`,
/// `1["x"`). So what no TOML may contain is refused here, before toml++ reads it.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <toml++/toml.h>

#include <knurl/words/printable.hpp>

namespace knurl::words {

/// Text that is no TOML: one line, "file:line:column: what; what to do".
class TomlError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The first place at which a text is certainly no TOML.
struct TomlFault {
    /// From 1.
    std::size_t line = 1;
    /// In characters, from 1, as toml++ counts.
    std::size_t column = 1;
    /// What is wrong, and what to do.
    std::string what;
};

/// Goes once through a text, as far as is needed to know what is in quotes, in a comment, and a table header.
class TomlScan {
  public:
    /// `text` outlives it.
    explicit TomlScan(std::string_view text) : text_(text) {
        constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
        if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
    }

    /// None: toml++ may read it. (It may still be no TOML.)
    std::optional<TomlFault> fault() {
        while (!ended()) token();
        return fault_;
    }

  private:
    bool ended() const { return fault_ || at_ == text_.size(); }
    bool sees(std::string_view word) const { return text_.substr(at_).starts_with(word); }
    char front() const { return text_[at_]; }
    std::uint8_t byte(std::size_t i) const { return static_cast<std::uint8_t>(text_[at_ + i]); }

    static std::string hexadecimal(unsigned value, int digits) {
        char text[16];
        std::snprintf(text, sizeof text, "%0*X", digits, value);
        return text;
    }
    void fail(std::string what) { fault_ = {.line = line_, .column = column_, .what = std::move(what)}; }

    /// Bytes of the character here; 0: they are no UTF-8 (Unicode 15, table 3-7).
    std::size_t length() const {
        const std::uint8_t lead = byte(0);
        if (lead < 0x80) return 1;
        const std::size_t bytes = lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
        if (bytes == 0 || text_.size() - at_ < bytes) return 0;
        const std::uint8_t least = lead == 0xE0   ? 0xA0
                                   : lead == 0xF0 ? 0x90
                                                  : 0x80,
                           most = lead == 0xED   ? 0x9F
                                  : lead == 0xF4 ? 0x8F
                                                 : 0xBF;
        if (byte(1) < least || byte(1) > most) return 0;
        for (std::size_t i = 2; i < bytes; ++i)
            if ((byte(i) & 0xC0) != 0x80) return 0;
        return bytes;
    }

    /// Passes one character. What may stand nowhere is a fault.
    void pass() {
        const std::size_t bytes = length();
        const std::uint8_t code = byte(0);
        if (bytes == 0)
            return fail("the byte 0x" + hexadecimal(code, 2) + " here is no UTF-8; save the file as UTF-8");
        if ((code < ' ' && code != '\t' && code != '\n' && code != '\r') || code == 0x7F)
            return fail("the control character U+" + hexadecimal(code, 4) +
                        " may not stand in TOML; delete it, or write it in a string as the escape \\u" +
                        hexadecimal(code, 4));
        at_ += bytes;
        ++column_;
        if (code != '\n') return;
        ++line_;
        column_ = 1;
    }
    void pass(std::size_t characters) {
        for (; characters > 0 && !ended(); --characters) pass();
    }

    void token() {
        const bool first = std::exchange(begins_line_, false);
        const char before = std::exchange(before_, front());
        switch (front()) {
            case '\n':
                begins_line_ = open_.empty();
                if (begins_line_) value_ = false;
                return pass();
            case ' ':
            case '\t':
            case '\r':
                begins_line_ = first;
                return pass();
            case '#':
                while (!ended() && front() != '\n') pass();
                return;
            case '"':
            case '\'':
                return may_begin(before) ? quoted() : within_a_word();
            case '[':
                if (first) return header();
                return may_begin(before) ? open() : within_a_word();
            case '{':
                return may_begin(before) ? open() : within_a_word();
            case '=':
                value_ = true;
                return pass();
            case ',':
                if (open_.ends_with('{')) value_ = false;
                return pass();
            case ']':
            case '}':
                return close();
            default:
                return bare();
        }
    }

    /// An array or an inline table; or a table header, which is not counted as open.
    void close() {
        if (!open_.empty()) {
            const bool array = open_.back() == '[';
            if (array != (front() == ']'))
                return fail(array ? "'}' stands in an array, which ] closes; write ]"
                                  : "']' stands in an inline table, which } closes; write }");
            open_.pop_back();
            value_ = true;
        }
        pass();
    }

    void open() {
        open_ += front();
        value_ = false;
        pass();
    }

    void within_a_word() {
        std::string what(1, front());
        what += " stands within a word; put all of the word in quotes";
        fail(std::move(what));
    }

    /// A key or a value may begin behind that character.
    bool may_begin(char before) const {
        if (before == '.') return !value_ && !open_.ends_with('[');  // a key of several parts
        return before == 0 || std::string_view(" \t\r\n=,[{").find(before) != std::string_view::npos;
    }

    /// The characters from here on, by their kinds: 0 is any digit.
    bool has_form(std::string_view form) const {
        if (text_.size() - at_ < form.size()) return false;
        for (std::size_t i = 0; i < form.size(); ++i) {
            const bool digit = text_[at_ + i] >= '0' && text_[at_ + i] <= '9';
            if (form[i] == '0' ? !digit : form[i] != text_[at_ + i]) return false;
        }
        return true;
    }

    /// A date and a T, behind which no digit stands. (As a key it may be.)
    bool has_wrong_time() const {
        constexpr std::size_t date = 10;
        if (!value_ && !open_.ends_with('[')) return false;
        if (!has_form("0000-00-00T") && !has_form("0000-00-00t")) return false;
        if (text_.size() - at_ == date + 1) return false;
        const char next = text_[at_ + date + 1];
        return next < '0' || next > '9';
    }

    void bare() {
        if (has_wrong_time()) {
            pass(11);
            return fail("a time should begin here, behind its date; write 07:32:00");
        }
        if (byte(0) < 0x80) return pass();
        if (length() == 0) return pass();  // says so
        fail("the character U+" + hexadecimal(code_point(), 4) +
             " stands outside quotes and comments, where only ASCII may; put the word in quotes (' or \")");
    }

    /// Of the character here, which has several bytes.
    unsigned code_point() const {
        const std::size_t bytes = length();
        unsigned code = byte(0) & (0x7Fu >> bytes);
        for (std::size_t i = 1; i < bytes; ++i) code = code << 6 | (byte(i) & 0x3Fu);
        return code;
    }

    void quoted() {
        const char quote = front();
        const std::string three(3, quote);
        const bool lines = sees(three);
        pass(lines ? 3 : 1);
        while (!ended()) {
            if (front() == '\\' && quote == '"') {
                pass();
                if (lines || (!ended() && front() != '\n')) pass(1);
            } else if (!lines && front() == '\n') {
                return;  // not ended: toml++ says so
            } else if (lines ? sees(three) : front() == quote) {
                // Two quotes of a text of several lines may precede the three that end it.
                for (int most = lines ? 5 : 1; most > 0 && !ended() && front() == quote; --most) pass();
                return;
            } else {
                pass();
            }
        }
    }

    void blanks() {
        while (!ended() && (front() == ' ' || front() == '\t')) pass();
    }

    /// `[` or `[[`, up to the first letter of a name. "]" is left to toml++, which refuses it well.
    void header() {
        pass();
        const bool more = sees("[");
        if (more) pass();
        blanks();
        if (ended() || sees("]") || (!more && sees("[")) || byte(0) >= 0x80) return;
        const char c = front();
        if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
            std::string_view("_-\"'").find(c) != std::string_view::npos)
            return;
        const bool line_ends = c == '\n' || c == '\r';
        if ((static_cast<unsigned char>(c) < ' ' || c == 0x7F) && !line_ends) return pass();  // says so
        fail((line_ends ? std::string("the line ends") : "'" + std::string(1, c) + "' stands") +
             " where the name of a table should begin; write [name] or [[name]]");
    }

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1, column_ = 1;
    std::string open_;         // arrays and inline tables
    bool begins_line_ = true;  // outside those: a [ here begins a table header
    bool value_ = false;       // behind a = : what is here is no key, unless in an inline table
    char before_ = 0;          // the character, or the quote, before this one
    std::optional<TomlFault> fault_;
};

/// None: toml++ may read it. (It may still be no TOML.)
inline std::optional<TomlFault> toml_fault(std::string_view text) {
    return TomlScan(text).fault();
}

/// Reads TOML. Throws TomlError; `path` is what it names.
inline toml::table parse_toml(std::string_view text, const std::string& path) {
    const auto error = [&path](std::size_t line, std::size_t column, const std::string& what) {
        return TomlError(path + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + what);
    };
    if (const auto fault = toml_fault(text)) throw error(fault->line, fault->column, fault->what);
    try {
        return toml::parse(text, path);
    } catch (const toml::parse_error& refused) {
        constexpr std::size_t longest = 300;
        std::string what(refused.description());
        std::replace(what.begin(), what.end(), '\n', ' ');  // the message quotes the file, with line ends
        throw error(refused.source().begin.line, refused.source().begin.column, printable(what, longest));
    }
}

}  // namespace knurl::words
