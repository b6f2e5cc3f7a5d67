#pragma once
// What a call says when it refuses.

#include <exception>
#include <string>

namespace knurl::test {

/// The message of the error that `act` throws; "accepted" if it throws none.
template <class Error = std::exception, class Act>
std::string refusal_of(Act&& act) {
    try {
        act();
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace knurl::test
