#include "live_socket.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>

#include <unistd.h>

#include <knurl/protocol/text.hpp>
#include <knurl/words/printable.hpp>

#include "live_text.hpp"

namespace knurl::gateway {

namespace {

using Clock = std::chrono::steady_clock;

Vec3 vector_of(const Json& json) {
    const auto parts = json.get<std::vector<double>>();
    if (parts.size() != 3) throw std::runtime_error("give a vector as three numbers, [x, y, z]");
    return {parts[0], parts[1], parts[2]};
}

}  // namespace

LiveSocket::LiveSocket(LivePage::Impl& page, Socket& socket)
    : page_(page), socket_(socket), name_(fmt::format("page {}", ++page.opened)) {
    const Json hello = {{"op", "hello"},
                        {"version", KNURL_VERSION},
                        {"role", std::string(name_of(socket.role()))},
                        {"kinds", kinds_json()},
                        {"recordings", page.options.recordings}};
    socket_.send_text(hello.dump());
    page_.sockets.insert(this);
}

LiveSocket::~LiveSocket() {
    page_.sockets.erase(this);
}

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
    struct Request {
        std::string_view op;
        Role needs;
        Json (LiveSocket::*answer)(std::size_t device, const Json& request);
    };
    static constexpr Request known[] = {
        {"add", Role::render, &LiveSocket::add},        {"set", Role::render, &LiveSocket::set},
        {"remove", Role::render, &LiveSocket::remove},  {"clear", Role::render, &LiveSocket::clear},
        {"arm", Role::control, &LiveSocket::arm},       {"disarm", Role::control, &LiveSocket::disarm},
        {"reset", Role::control, &LiveSocket::reset},   {"pull", Role::control, &LiveSocket::pull},
        {"record", Role::control, &LiveSocket::record}, {"stop", Role::control, &LiveSocket::stop},
        {"doctor", Role::observe, &LiveSocket::doctor}, {"clock", Role::observe, &LiveSocket::clock},
    };
    const auto found =
        std::find_if(std::begin(known), std::end(known), [&](const Request& one) { return one.op == op; });
    if (found == std::end(known))
        throw std::runtime_error(
            fmt::format("'{}' is no request that is known here", words::printable(op, 40)));
    require(found->needs, op);
    return (this->*found->answer)(request.value("device", Json(0u)).get<std::size_t>(), request);
}

Json LiveSocket::add(std::size_t device, const Json& request) {
    const RepresentationId id = playground(device).add(request);
    return {{"slot", id.slot}, {"generation", id.generation}};
}

Json LiveSocket::set(std::size_t device, const Json& request) {
    playground(device).set(request.at("slot").get<std::uint32_t>(), request.at("params"));
    return Json::object();
}

Json LiveSocket::remove(std::size_t device, const Json& request) {
    playground(device).remove(request.at("slot").get<std::uint32_t>());
    return Json::object();
}

Json LiveSocket::clear(std::size_t device, const Json&) {
    playground(device).clear();
    return Json::object();
}

Json LiveSocket::arm(std::size_t device, const Json&) {
    playground(device).arm();
    return Json::object();
}

Json LiveSocket::disarm(std::size_t device, const Json&) {
    playground(device).disarm();
    return Json::object();
}

Json LiveSocket::reset(std::size_t device, const Json&) {
    playground(device).reset();
    return Json::object();
}

Json LiveSocket::pull(std::size_t device, const Json& request) {
    page_.device(device);
    const HandPipe& pipe = page_.pipes.at(device);
    if (!pipe.can_pull())
        throw std::runtime_error(
            "pull: this hand cannot be pulled; `knurl web` starts a simulated one that can, or give a "
            "simulated "
            "device a pipe: --device right=sim:premium15,live=PIPE");
    const Json target = request.value("target", Json());
    if (!target.is_null()) pipe.pull(vector_of(target));
    return Json::object();
}

Json LiveSocket::record(std::size_t device, const Json& request) {
    return {{"path", page_.record(device, request.value("file", Json("")).get<std::string>())}};
}

Json LiveSocket::stop(std::size_t device, const Json&) {
    page_.stop(device);
    return Json::object();
}

Json LiveSocket::doctor(std::size_t, const Json& request) {
    if (request.value("run", Json(false)).get<bool>()) {
        require(Role::control, "doctor");
        if (page_.options.knurl_program.empty())
            throw std::runtime_error("doctor: the program knurl was not found beside this one");
        if (!page_.doctor)
            page_.doctor.emplace(std::vector<std::string>{page_.options.knurl_program, "doctor", "--json"});
    }
    return {{"running", page_.doctor.has_value()},
            {"verdict", page_.verdict.empty() ? Json() : Json::parse(page_.verdict)}};
}

Json LiveSocket::clock(std::size_t, const Json&) {
    return {
        {"t", std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count()}};
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

}  // namespace knurl::gateway
