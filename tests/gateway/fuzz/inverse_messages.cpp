// Any lines as messages of a client of the Inverse Service: each has one answer, which is JSON, and what reaches the hand
// is what a servo takes. Lines that begin with GET or POST are HTTP requests.

#include <cstdint>
#include <string>
#include <string_view>

#include <knurl/reps/check.hpp>

#include "../../fuzz/require.hpp"
#include "../inverse_fakes.hpp"

using namespace inverse_test;
using fuzz::require;

namespace {

void check_line(const std::string& line) {
    require(!line.empty() && line.size() < 700, "what is said is short");
    for (const char c : line) require(c >= ' ' && c <= '~', "what is said is one line of text");
}

void check_answer(FakeSocket& socket) {
    require(socket.sent.size() == 1, "each message has one answer");
    require(socket.sent.front().size() < 100'000, "an answer is short");
    const Json answer = socket.answer();
    require(answer["inverse3"].size() == 1 && answer["wireless_verse_grip"].size() == 1,
            "the answer has the devices");
    require(answer["inverse3"][0]["state"].contains("cursor_position"), "the answer has a state");
}

void check_told(const Told& told) {
    for (const auto& [name, item] : told.items)
        require(!!check_added(item.first, item.second.data(), item.second.size(), {}),
                "the servo takes what the hand is told");
}

void check_http(FakeService& fake, std::string_view line) {
    const auto method_end = line.find(' ');
    const std::string_view method = line.substr(0, method_end);
    line.remove_prefix(method_end + 1);
    const auto target_end = std::min(line.find(' '), line.size());
    const std::string_view target = line.substr(0, target_end);
    const auto query = std::min(target.find('?'), target.size());
    const InverseReply reply =
        fake.service.http({.method = std::string(method),
                           .path = std::string(target.substr(0, query)),
                           .session = std::string(target.substr(std::min(query + 1, target.size()))),
                           .body = std::string(line.substr(std::min(target_end + 1, line.size()))),
                           .role = Role::control});
    const Json body = Json::parse(reply.body);
    require(reply.status == 200 || (body["ok"] == false && !body["error"].get<std::string>().empty()),
            "a refusal says why");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    FakeService fake;
    fake.start();
    check_answer(fake.socket);
    while (!rest.empty()) {
        const auto end = std::min(rest.find('\n'), rest.size());
        const std::string line(
            rest.substr(0, end));  // an exact copy, so that reading past its end is detected
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (line.starts_with("GET ") || line.starts_with("POST ")) {
            check_http(fake, line);
            continue;
        }
        fake.session->text(line);
        check_answer(fake.socket);
        check_told(fake.told);
        fake.now += std::chrono::milliseconds(5);
    }
    for (const std::string& line : fake.log) check_line(line);
    for (const std::string& event : fake.listener.sent)
        check_line(Json::parse(event)["message"].get<std::string>());
    require(fake.socket.closed == 0, "nothing that is wrong ends a connection");
    return 0;
}
