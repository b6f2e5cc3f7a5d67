#pragma once
// What stands around an Inverse Service in tests: a socket of vectors, devices that a test sets, a hand that writes down
// what it is told, and a clock that stands still.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <knurl/gateway/inverse.hpp>
#include <knurl/json/json.hpp>

#include "inverse_service.hpp"

namespace inverse_test {

using namespace knurl;
using namespace knurl::gateway;

class FakeSocket final : public Socket {
  public:
    void send_text(std::string text) override { sent.push_back(std::move(text)); }
    void send_binary(std::vector<std::byte>) override { ++binaries; }
    bool idle() const override { return true; }
    void close(std::uint16_t, std::string) override { ++closed; }
    Role role() const override { return as; }
    const std::string& peer() const override { return name; }

    /// The newest message; and no more than one since the call before.
    Json answer() {
        if (sent.size() != 1)
            throw std::runtime_error(std::to_string(sent.size()) + " messages were sent, not one");
        const std::string text = std::exchange(sent, {}).front();
        return Json::parse(text);
    }

    std::vector<std::string> sent;
    int binaries = 0, closed = 0;
    Role as = Role::control;
    std::string name = "127.0.0.1:40312";
};

class FakeSource final : public InverseSource {
  public:
    void look(std::chrono::steady_clock::time_point) override { ++looks; }
    std::span<const InverseDevice> devices() const override { return list; }
    const std::string& trouble() const override { return why; }

    std::vector<InverseDevice> list;
    std::string why;
    int looks = 0;
};

inline InverseDevice device(const std::string& name, const std::string& id) {
    InverseDevice made;
    made.info.name = name;
    made.info.address = "sim:premium15";
    made.info.profile = "premium15";
    made.info.rate = 1000;
    made.info.max_stiffness = 2000;
    made.id = id;
    made.grip_id = "F" + id.substr(1);
    made.connected = true;
    Report report;
    report.position = {0.2, 0.1, 0.05};  // towards the user, right, up
    report.velocity = {1, 2, 3};
    report.sent_force = {4, 5, 6};
    report.orientation = {0.5, 0.5, 0.5, 0.5};
    report.joints = {1, 2, 3};
    report.buttons = 0b1010;
    report.state = DeviceState::active;
    report.cycle = 77;
    made.report = report;
    return made;
}

/// What a hand was told. It outlives the hand.
struct Told {
    std::vector<Vec3> pushes, targets;
    std::map<std::string, std::pair<Kind, std::vector<std::byte>>> items;
    std::vector<Said> to_say;
    std::string refuse;
    PeerStatus status;
    int sent = 0;
    bool alive = false;
    PeerOptions options;
};

class FakeHand final : public PeerCommands {
  public:
    explicit FakeHand(Told& told) : told_(told) { told_.alive = true; }
    ~FakeHand() override { told_.alive = false; }
    std::string push(const Vec3& force, const Vec3&, std::string_view field) override {
        if (!told_.refuse.empty()) return std::string(field) + told_.refuse;
        told_.pushes.push_back(force);
        return {};
    }
    std::string pull(const Vec3& target, std::string_view) override {
        told_.targets.push_back(target);
        return {};
    }
    std::string add(const std::string& name, Kind kind, const std::vector<std::byte>& params,
                    const AddOptions&) override {
        told_.items[name] = {kind, params};
        return {};
    }
    std::string set(const std::string& name, const std::vector<std::byte>& params) override {
        told_.items.at(name).second = params;
        return {};
    }
    std::string remove(const std::string& name) override {
        told_.items.erase(name);
        return {};
    }
    void clear() override { told_.items.clear(); }
    void sent() override { ++told_.sent; }
    PeerStatus status() const override { return told_.status; }
    std::vector<Said> said() override { return std::exchange(told_.to_say, {}); }

  private:
    Told& told_;
};

/// The service with one device, "right", of id 049D, and nothing real.
struct FakeService {
    FakeService() {
        InverseOptions options;
        auto owned = std::make_unique<FakeSource>();
        source = owned.get();
        source->list = {device("right", "049D")};
        options.source = std::move(owned);
        options.version = "1.2.3";
        options.clock = [this] { return now; };
        options.log = [this](const std::string& line) { log.push_back(line); };
        options.make_hand = [this](PeerOptions peer) {
            told.options = std::move(peer);
            return std::make_unique<FakeHand>(told);
        };
        adjust = std::move(options);
    }
    /// After what the test changes in `adjust`.
    void start() {
        service = serve_inverse(std::move(adjust));
        events = service.events(listener, "");
        session = service.simulation(socket, "");
    }

    InverseOptions adjust;
    FakeSource* source = nullptr;
    Told told;
    std::chrono::steady_clock::time_point now{std::chrono::hours(1)};
    std::vector<std::string> log;
    FakeSocket socket, listener;
    Inverse service;
    std::unique_ptr<SocketHandler> events, session;
};

}  // namespace inverse_test
