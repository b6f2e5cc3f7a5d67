#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include <knurl/gateway/live_page.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/words/printable.hpp>

#include "child.hpp"
#include "hand_pipe.hpp"
#include "live_text.hpp"
#include "playground.hpp"

namespace knurl::gateway {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto status_every = std::chrono::milliseconds(250);

Vec3 vector_of(const Json& json) {
    const auto parts = json.get<std::vector<double>>();
    if (parts.size() != 3) throw std::runtime_error("give a vector as three numbers, [x, y, z]");
    return {parts[0], parts[1], parts[2]};
}

/// A recording of one device, in a process of its own: it goes on when the page that began it has gone.
struct Recorder {
    std::string path;
    std::unique_ptr<Child> child;
};

class LiveSocket;

}  // namespace

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
    std::optional<Clock::time_point> status_made;

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

namespace {

class LiveSocket final : public SocketHandler {
  public:
    LiveSocket(LivePage::Impl& page, Socket& socket)
        : page_(page), socket_(socket), name_(fmt::format("page {}", ++page.opened)) {
        const Json hello = {{"op", "hello"},
                            {"version", KNURL_VERSION},
                            {"role", std::string(name_of(socket.role()))},
                            {"kinds", kinds_json()},
                            {"recordings", page.options.recordings}};
        socket_.send_text(hello.dump());
        page_.sockets.insert(this);
    }
    ~LiveSocket() override { page_.sockets.erase(this); }
    LiveSocket(const LiveSocket&) = delete;
    LiveSocket& operator=(const LiveSocket&) = delete;

    void text(std::string_view message) override;
    void binary(std::span<const std::byte>) override {
        note("warning", "messages of bytes are not known here; send JSON");
    }
    void tick(Clock::time_point now) override;

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

void LiveSocket::require(Role role, const std::string& op) const {
    if (socket_.role() >= role) return;
    throw std::runtime_error(fmt::format("{}: this page may {}; {} needs the role {}", op,
                                         name_of(socket_.role()), op, name_of(role)));
}

Playground& LiveSocket::playground(std::size_t device) {
    const auto found = playgrounds_.find(device);
    if (found != playgrounds_.end()) return found->second;
    const SeenDevice& seen = page_.device(device);
    return playgrounds_
        .try_emplace(device, page_.options.servo, protocol::text_of(seen.info.name), "knurl-web " + name_)
        .first->second;
}

void LiveSocket::text(std::string_view message) {
    Json id;
    std::string op;
    try {
        const Json request = Json::parse(message);
        id = request.value("id", Json());
        op = request.at("op").get<std::string>();
        Json told = answer(op, request);
        told["op"] = "answer";
        told["id"] = id;
        told["ok"] = true;
        socket_.send_text(told.dump());
    } catch (const std::exception& error) {
        const std::string why = words::printable(error.what(), 500);
        if (page_.options.log) page_.options.log(fmt::format("{} ({}): {}", name_, socket_.peer(), why));
        const Json told = {{"op", "answer"}, {"id", id}, {"ok", false}, {"error", why}};
        socket_.send_text(told.dump());
    }
}

Json LiveSocket::answer(const std::string& op, const Json& request) {
    const auto device = [&] { return request.value("device", Json(0u)).get<std::size_t>(); };
    const auto slot = [&] { return request.at("slot").get<std::uint32_t>(); };
    Json told = Json::object();
    if (op == "add") {
        require(Role::render, op);
        const RepresentationId id = playground(device()).add(request);
        told["slot"] = id.slot;
        told["generation"] = id.generation;
    } else if (op == "set") {
        require(Role::render, op);
        playground(device()).set(slot(), request.at("params"));
    } else if (op == "remove") {
        require(Role::render, op);
        playground(device()).remove(slot());
    } else if (op == "clear") {
        require(Role::render, op);
        playground(device()).clear();
    } else if (op == "arm") {
        require(Role::control, op);
        playground(device()).arm();
    } else if (op == "disarm") {
        require(Role::control, op);
        playground(device()).disarm();
    } else if (op == "reset") {
        require(Role::control, op);
        playground(device()).reset();
    } else if (op == "pull") {
        require(Role::control, op);
        page_.device(device());
        const HandPipe& pipe = page_.pipes.at(device());
        if (!pipe.can_pull())
            throw std::runtime_error(
                "pull: this hand cannot be pulled; `knurl web` starts a simulated one that can, or give a "
                "simulated "
                "device a pipe: --device right=sim:premium15,live=PIPE");
        const Json target = request.value("target", Json());
        if (!target.is_null()) pipe.pull(vector_of(target));
    } else if (op == "record") {
        require(Role::control, op);
        told["path"] = page_.record(device(), request.value("file", Json("")).get<std::string>());
    } else if (op == "stop") {
        require(Role::control, op);
        page_.stop(device());
    } else if (op == "doctor") {
        if (request.value("run", Json(false)).get<bool>()) {
            require(Role::control, op);
            if (page_.options.knurl_program.empty())
                throw std::runtime_error("doctor: the program knurl was not found beside this one");
            if (!page_.doctor)
                page_.doctor.emplace(
                    std::vector<std::string>{page_.options.knurl_program, "doctor", "--json"});
        }
        told["running"] = page_.doctor.has_value();
        told["verdict"] = page_.verdict.empty() ? Json() : Json::parse(page_.verdict);
    } else {
        throw std::runtime_error(
            fmt::format("'{}' is no request that is known here", words::printable(op, 40)));
    }
    return told;
}

std::set<std::uint64_t> LiveSocket::mine(const SeenDevice& seen) const {
    std::set<std::uint64_t> numbers;
    const std::string shown = "knurl-web " + name_;
    for (const auto& [number, claim] : seen.claims)
        for (const view::ClientView& client : seen.rates.device.clients)
            if (client.row == claim.row && client.pid == ::getpid() && client.name == shown)
                numbers.insert(number);
    return numbers;
}

void LiveSocket::keep_alive() {
    for (auto it = playgrounds_.begin(); it != playgrounds_.end();) {
        try {
            it->second.commit();
            if (auto mesh = it->second.mesh()) {
                (*mesh)["op"] = "asset";
                (*mesh)["device"] = it->first;
                socket_.send_text(mesh->dump());
            }
            ++it;
        } catch (const std::exception& error) {
            note("error", error.what());
            ++it;
        }
    }
}

void LiveSocket::tell_scenes() {
    const auto devices = page_.view.devices();
    if (epoch_told_ != page_.view.epoch()) {
        epoch_told_ = page_.view.epoch();
        told_.assign(devices.size(), {});
    }
    for (std::uint32_t i = 0; i < devices.size() && i < told_.size(); ++i) {
        Told& told = told_[i];
        std::set<std::uint64_t> own = mine(devices[i]);
        if (devices[i].scene_version != told.scene || own != told.mine || told.scene == 0) {
            // Version 0 asks for all; a scene in which nothing has happened yet is version 1 for the page.
            socket_.send_text(scene_text(i, devices[i], told.scene, own));
            told.scene = std::max<std::uint64_t>(devices[i].scene_version, 1);
            told.mine = std::move(own);
        }
        if (std::string felt = felt_text(i, devices[i], told.felt); !felt.empty())
            socket_.send_text(std::move(felt));
    }
}

void LiveSocket::tick(Clock::time_point) {
    keep_alive();
    if (servo_told_ != page_.servo_changes) {
        servo_told_ = page_.servo_changes;
        socket_.send_text(page_.servo);
    }
    // A page that reads slowly gets the newest, and never a queue.
    if (!socket_.idle() || !page_.view.connected()) return;
    tell_scenes();
    if (frame_told_ != page_.ticks) {
        frame_told_ = page_.ticks;
        socket_.send_text(page_.frame);
        for (const auto& samples : page_.samples)
            if (!samples.empty()) socket_.send_binary(samples);
    }
    if (status_told_ != page_.statuses) {
        status_told_ = page_.statuses;
        socket_.send_text(page_.status);
    }
}

}  // namespace

// ------------------------------------------------------------------------------------------ all pages

void LivePage::Impl::tell_all(std::string_view level, const std::string& text) {
    for (LiveSocket* socket : sockets) socket->note(level, text);
    if (options.log) options.log(text);
}

void LivePage::Impl::look_at_servo() {
    if (epoch == view.epoch() && connected == view.connected() && !servo.empty()) return;
    if (epoch != view.epoch()) {
        pipes.clear();
        for (const SeenDevice& seen : view.devices())
            pipes.emplace_back(protocol::text_of(seen.info.address));
    }
    epoch = view.epoch();
    connected = view.connected();
    std::vector<bool> can_pull;
    for (const HandPipe& pipe : pipes) can_pull.push_back(pipe.can_pull());
    servo = servo_text(view, can_pull);
    ++servo_changes;
}

void LivePage::Impl::look_at_children() {
    for (auto it = recorders.begin(); it != recorders.end();) {
        const auto code = it->second.child->look();
        if (!code) {
            ++it;
            continue;
        }
        std::string said = it->second.child->said();
        said.resize(said.find_last_not_of('\n') + 1);  // its summary is the last line
        said.erase(0, said.rfind('\n') + 1);
        tell_all(*code == 0 ? "info" : "error", "recording ended: " + words::printable(said, 400));
        it = recorders.erase(it);
    }
    if (!doctor || !doctor->look()) return;
    const std::string& said = doctor->said();
    try {
        const std::size_t begin = std::min(said.find('{'), said.size());
        verdict = Json::parse(said.substr(begin)).dump();
    } catch (const std::exception&) {
        tell_all("error", "knurl doctor: " + words::printable(said, 300));
    }
    doctor.reset();
}

std::string LivePage::Impl::record(std::size_t i, const std::string& file) {
    const SeenDevice& seen = device(i);
    if (options.recordings.empty() || options.knurl_program.empty())
        throw std::runtime_error(
            "record: no folder for recordings was named; start knurl-web with --recordings DIR");
    if (recorders.contains(i))
        throw std::runtime_error(fmt::format("record: already recording into {}", recorders.at(i).path));
    const bool plain = !file.empty() && file.size() <= 100 && file.front() != '.' &&
                       std::all_of(file.begin(), file.end(), [](char c) {
                           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                                  (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
                       });
    if (!plain)
        throw std::runtime_error(
            "record: give the file a name of letters, digits, '.', '-' and '_', without a folder: "
            "stroke-1.mcap");
    const std::string name = file.ends_with(".mcap") ? file : file + ".mcap";
    const std::string path = (std::filesystem::path(options.recordings) / name).string();
    if (std::filesystem::exists(path))
        throw std::runtime_error(fmt::format("record: {} is there already", path));
    const std::vector<std::string> words = {options.knurl_program,
                                            "record",
                                            path,
                                            "--servo",
                                            options.servo,
                                            "--device",
                                            protocol::text_of(seen.info.name)};
    recorders[i] = {.path = path, .child = std::make_unique<Child>(words)};
    return path;
}

void LivePage::Impl::stop(std::size_t i) {
    const auto found = recorders.find(i);
    if (found == recorders.end())
        throw std::runtime_error("stop: this device is not being recorded from here");
    found->second.child->interrupt();
}

LivePage::LivePage(const LiveView& view, LivePageOptions options)
    : impl_(std::make_unique<Impl>(view, std::move(options))) {}
LivePage::~LivePage() = default;

void LivePage::tick(Clock::time_point now) {
    Impl& page = *impl_;
    page.look_at_servo();
    page.look_at_children();
    if (!page.view.connected() || page.sockets.empty()) return;
    const auto devices = page.view.devices();
    ++page.ticks;
    page.frame = frame_text(devices);
    page.samples.clear();
    for (std::uint32_t i = 0; i < devices.size(); ++i) page.samples.push_back(samples_of(i, devices[i]));
    if (page.status_made && now - *page.status_made < status_every) return;
    page.status_made = now;
    std::map<std::size_t, std::string> recordings;
    for (const auto& [i, recorder] : page.recorders) recordings[i] = recorder.path;
    page.status = status_text(devices, recordings);
    ++page.statuses;
}

std::unique_ptr<SocketHandler> LivePage::open(Socket& socket) {
    return std::make_unique<LiveSocket>(*impl_, socket);
}

void LivePage::take_mesh(const std::string& session, std::size_t device, const std::string& name,
                         const std::string& unit, std::string bytes) {
    LiveSocket* page = nullptr;
    for (LiveSocket* socket : impl_->sockets)
        if (!session.empty() && socket->session() == session) page = socket;
    if (page == nullptr)
        throw std::runtime_error("mesh: open the page first; a mesh belongs to the page that sent it");
    page->begin_mesh(device, name, unit, std::move(bytes));
}

std::optional<std::string> LivePage::asset(std::size_t device, std::uint64_t claim,
                                           std::uint32_t number) const {
    const auto devices = impl_->view.devices();
    if (device >= devices.size()) return std::nullopt;
    const auto of = devices[device].claims.find(claim);
    if (of == devices[device].claims.end()) return std::nullopt;
    const auto found = of->second.assets.find(number);
    if (found == of->second.assets.end() || found->second == nullptr) return std::nullopt;
    const SeenAsset& asset = *found->second;
    const std::uint32_t counts[] = {static_cast<std::uint32_t>(asset.vertices.size() / 3),
                                    static_cast<std::uint32_t>(asset.triangles.size() / 3)};
    const auto bytes = [](const auto& values) {
        return std::string_view(reinterpret_cast<const char*>(std::data(values)),
                                sizeof(values[0]) * std::size(values));
    };
    std::string text(bytes(counts));
    text += bytes(asset.vertices);
    text += bytes(asset.triangles);
    return text;
}

std::size_t LivePage::pages() const {
    return impl_->sockets.size();
}

}  // namespace knurl::gateway
