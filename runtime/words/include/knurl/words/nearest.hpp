#pragma once

/// @file
/// "Did you mean ...?": the word that was probably meant by a misspelled one. This module uses no other one.

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::words {

/// How many slips apart: a letter too many, too few, another, or two neighbours swapped (Damerau and
/// Levenshtein, each pair swapped once at most). Upper and lower case are one, as are _ and -.
inline std::size_t slips(std::string_view a, std::string_view b) {
    const auto same = [](char c) {
        if (c == '_') return '-';
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    };
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool equal = same(a[i - 1]) == same(b[j - 1]);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (equal ? 0 : 1)});
            if (i > 1 && j > 1 && same(a[i - 1]) == same(b[j - 2]) && same(a[i - 2]) == same(b[j - 1]))
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

/// The one of `known` that `word` was probably meant to be, the first of those that are as near; empty: none
/// is near. Near is one slip in three letters or fewer, two in up to eight, a third of the letters in more;
/// or it begins so.
template <class Words>
std::string_view nearest(std::string_view word, const Words& known) {
    std::string_view best;
    std::size_t fewest = 1 + (word.size() <= 3 ? 1 : std::max<std::size_t>(2, word.size() / 3));
    for (const auto& each : known) {
        const std::string_view candidate = each;
        const std::size_t found = slips(word, candidate);
        if (found < fewest && found < std::max(word.size(), candidate.size())) {
            best = candidate;
            fewest = found;
        }
    }
    if (!best.empty() || word.size() < 2) return best;
    for (const auto& each : known)
        if (std::string_view(each).starts_with(word)) return each;
    return best;
}

/// "did you mean 'rate'?", or what is to be said where nothing is near.
template <class Words>
std::string did_you_mean(std::string_view word, const Words& known, const std::string& otherwise) {
    const std::string_view meant = nearest(word, known);
    return meant.empty() ? otherwise : "did you mean '" + std::string(meant) + "'?";
}

/// To be added to a sentence: "; did you mean 'rate'?", or nothing.
template <class Words>
std::string meant(std::string_view word, const Words& known) {
    const std::string question = did_you_mean(word, known, "");
    return question.empty() ? question : "; " + question;
}

}  // namespace knurl::words
