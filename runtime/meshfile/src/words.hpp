#pragma once
// Lines, words and numbers of a text, independent of locale and line ends.

#include <optional>
#include <string>
#include <string_view>

namespace knurl::meshfile {

class Lines {
  public:
    explicit Lines(std::string_view text) : rest_(text) {
        if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
    }

    /// The next line without its end (LF, CR LF or CR); false: there is none.
    bool next(std::string_view& line);
    std::size_t number() const { return number_; }  // of that line, from 1
    std::string_view rest() const { return rest_; }

  private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// Takes the next word from a line; empty: there is none.
std::string_view next_word(std::string_view& line);
/// None: no number, or out of double's range.
std::optional<double> number_of(std::string_view word);
std::optional<long long> integer_of(std::string_view word);
/// `word` in quotes, shortened and without unprintable characters.
std::string in_quotes(std::string_view word);
/// Why a word is no number, and what to do: `"1,5" is not a number; write ...`.
std::string no_number(std::string_view word);
std::string lower(std::string_view word);
bool same_word(std::string_view word, std::string_view lower_case);

}  // namespace knurl::meshfile
