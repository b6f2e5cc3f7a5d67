#pragma once
// One page of knurl-web, and what all pages share. Private to this module.

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <knurl/gateway/live_page.hpp>
#include <knurl/json/json.hpp>

#include "child.hpp"
#include "hand_pipe.hpp"
#include "playground.hpp"

namespace knurl::gateway {

class LiveSocket;

/// A recording of one device, in a process of its own: it goes on when the page that began it has gone.
struct Recorder {
    std::string path;
    std::unique_ptr<Child> child;
};

struct LivePage::Impl {
    Impl(const LiveView& seen, LivePageOptions stated) : view(seen), options(std::move(stated)) {}

    const LiveView& view;
    LivePageOptions options;
    std::set<LiveSocket*> sockets;
    std::uint64_t opened = 0;  // pages so far: their numbers

    // Of this tick, made once for all pages.
    std::string frame, status;
    std::vector<std::vector<std::byte>> samples;  // by device
    std::uint64_t ticks = 0, statuses = 0;
    std::optional<std::chrono::steady_clock::time_point> status_made;

    std::uint64_t epoch = 0;
    bool connected = false;
    std::uint64_t servo_changes = 0;
    std::vector<HandPipe> pipes;  // by device
    std::string servo;            // message

    std::map<std::size_t, Recorder> recorders;  // by device
    std::optional<Child> doctor;
    std::string verdict;  // JSON of the last one

    void look_at_servo();
    void look_at_children();
    void tell_all(std::string_view level, const std::string& text);
    const SeenDevice& device(std::size_t i) const {
        if (!view.connected()) throw std::runtime_error(view.trouble());
        if (i >= view.devices().size())
            throw std::runtime_error(fmt::format("device {} of {}; count from 0", i, view.devices().size()));
        return view.devices()[i];
    }
    std::string record(std::size_t i, const std::string& file);
    void stop(std::size_t i);
};

class LiveSocket final : public SocketHandler {
  public:
    LiveSocket(LivePage::Impl& page, Socket& socket);
    ~LiveSocket() override;
    LiveSocket(const LiveSocket&) = delete;
    LiveSocket& operator=(const LiveSocket&) = delete;

    void text(std::string_view message) override;
    void binary(std::span<const std::byte>) override {
        note("warning", "messages of bytes are not known here; send JSON");
    }
    void tick(std::chrono::steady_clock::time_point now) override;

    void note(std::string_view level, const std::string& text) {
        const Json json = {{"op", "note"}, {"level", std::string(level)}, {"text", text}};
        socket_.send_text(json.dump());
    }
    const std::string& name() const { return name_; }
    std::string session() const { return socket_.session(); }
    void begin_mesh(std::size_t device, const std::string& name, const std::string& unit, std::string bytes) {
        playground(device).begin_mesh(name, unit, std::move(bytes));
    }

  private:
    Json answer(const std::string& op, const Json& request);
    Json add(std::size_t device, const Json& request);
    Json set(std::size_t device, const Json& request);
    Json remove(std::size_t device, const Json& request);
    Json clear(std::size_t device, const Json& request);
    Json arm(std::size_t device, const Json& request);
    Json disarm(std::size_t device, const Json& request);
    Json reset(std::size_t device, const Json& request);
    Json pull(std::size_t device, const Json& request);
    Json record(std::size_t device, const Json& request);
    Json stop(std::size_t device, const Json& request);
    Json doctor(std::size_t device, const Json& request);
    Json clock(std::size_t device, const Json& request);
    Playground& playground(std::size_t device);
    void require(Role role, const std::string& op) const;
    void tell_scenes();
    void keep_alive();
    std::set<std::uint64_t> mine(const SeenDevice& seen) const;

    LivePage::Impl& page_;
    Socket& socket_;
    std::string name_;
    std::map<std::size_t, Playground> playgrounds_;  // by device
    std::uint64_t servo_told_ = 0, status_told_ = 0, frame_told_ = 0, epoch_told_ = 0;
    struct Told {
        std::uint64_t scene = 0;  // version
        std::set<std::uint64_t> mine;
        bool felt = false;
    };
    std::vector<Told> told_;  // by device
};

}  // namespace knurl::gateway
