#pragma once
// A socket made of vectors: what a protocol has sent, and what it was told.

#include <optional>
#include <string>
#include <vector>

#include <knurl/gateway/socket.hpp>
#include <knurl/json/json.hpp>

namespace knurl::gateway::testing {

class TestSocket final : public Socket {
  public:
    explicit TestSocket(Role role = Role::control) : role_(role) {}

    void send_text(std::string text) override { texts.push_back(std::move(text)); }
    void send_binary(std::vector<std::byte> bytes) override { binaries.push_back(std::move(bytes)); }
    bool idle() const override { return reads; }
    void close(std::uint16_t code, std::string) override { closed = code; }
    Role role() const override { return role_; }
    const std::string& peer() const override { return peer_; }
    std::string session() const override { return "session"; }

    /// The newest text of that op; none: there was none.
    std::optional<Json> last(std::string_view op) const {
        for (auto text = texts.rbegin(); text != texts.rend(); ++text) {
            Json json = Json::parse(*text);
            if (json.value("op", Json("")).get<std::string>() == op) return json;
        }
        return std::nullopt;
    }

    std::vector<std::string> texts;
    std::vector<std::vector<std::byte>> binaries;
    std::optional<std::uint16_t> closed;
    bool reads = true;

  private:
    Role role_;
    std::string peer_ = "127.0.0.1:1";
};

}  // namespace knurl::gateway::testing
