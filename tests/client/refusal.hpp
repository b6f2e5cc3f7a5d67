#pragma once
// An error as its reader sees it: one line, with the words that help.

#include <string>

#include <gtest/gtest.h>

#include <knurl/client/client.hpp>

namespace client_test {

/// The text with which `call` is refused. Fails the test if it is not.
template <class Call>
knurl::Error refusal(Call call) {
    try {
        call();
    } catch (const knurl::Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
        return error;
    }
    ADD_FAILURE() << "it was not refused";
    return knurl::Error(knurl::Error::Kind::refused, "");
}

inline void says(const std::string& text, const std::string& words) {
    EXPECT_NE(text.find(words), std::string::npos) << "\"" << text << "\" does not say \"" << words << "\"";
}

}  // namespace client_test
