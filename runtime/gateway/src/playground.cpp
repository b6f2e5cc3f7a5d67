#include "playground.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include <knurl/meshfile/unit.hpp>
#include <knurl/words/printable.hpp>

#include "params_text.hpp"

namespace knurl::gateway {

namespace {

Client connected(const std::string& servo, const std::string& name) {
    ConnectOptions options;
    options.name = name;
    options.wait = std::chrono::milliseconds(0);
    options.hints = false;
    return Client::connect(servo, options);
}

Claim claimed(Client& client, const std::string& device) {
    ClaimOptions options;
    options.shared = true;
    options.update_interval = std::chrono::milliseconds(17);
    return client.claim(device, options);
}

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return text;
}

}  // namespace

Playground::Playground(const std::string& servo, const std::string& device, const std::string& name)
    : client_(connected(servo, name)), claim_(claimed(client_, device)) {}

AnyHandle& Playground::handle(std::uint32_t slot) {
    const auto found = handles_.find(slot);
    if (found == handles_.end())
        throw std::runtime_error(
            fmt::format("this page has nothing in slot {}; it changes only what it added", slot));
    return found->second;
}

RepresentationId Playground::add(const Json& request) {
    const Kind kind = kind_of_name(request.at("kind").get<std::string>());
    AddOptions options;
    options.probe = request.value("probe", Json(0u)).get<std::uint32_t>();
    const std::vector<std::byte> params = params_of(kind, request.value("params", Json()));
    AnyHandle added = claim_.add_bytes(kind, params, options);
    const RepresentationId id = added.id();
    handles_.insert_or_assign(id.slot, std::move(added));
    return id;
}

void Playground::set(std::uint32_t slot, const Json& params) {
    AnyHandle& changed = handle(slot);
    std::vector<std::byte> before(kinds()[changed.kind()].size);
    changed.get_bytes(before);
    changed.set_bytes(params_of(changed.kind(), params, before));
}

void Playground::remove(std::uint32_t slot) {
    handle(slot).remove();
    handles_.erase(slot);
}

void Playground::clear() {
    claim_.together([&] {
        for (auto& [slot, handle] : handles_) handle.remove();
    });
    handles_.clear();
}

Playground::Read Playground::read_mesh(const std::string& bytes, const std::string& name,
                                       const std::string& unit) {
    Read read{.file = meshfile::read_mesh(bytes, name), .metre = 1, .notes = {}};
    const double size = read.file.size();
    const meshfile::Unit of = unit.empty() ? meshfile::guessed_unit(size) : meshfile::unit_of(unit);
    read.metre = of.metres;
    if (of.guessed) read.notes = fmt::format("its unit is taken to be {}", of.name);
    for (const std::string& note : read.file.notes) read.notes += (read.notes.empty() ? "" : "; ") + note;
    if (const auto odd = meshfile::odd_size(size * of.metres)) read.notes += "; " + *odd;
    return read;
}

void Playground::begin_mesh(const std::string& name, const std::string& unit, std::string bytes) {
    if (reading_.valid() || sending_)
        throw std::runtime_error(fmt::format("{} is still being sent; wait for it", mesh_name_));
    const std::string end = lower(name.substr(std::min(name.rfind('.'), name.size())));
    if (end != ".stl" && end != ".obj" && end != ".ply")
        throw std::runtime_error(
            fmt::format("{}: give a mesh as .stl, .obj or .ply", words::printable(name, 60)));
    if (!unit.empty()) meshfile::unit_of(unit);  // a wrong one is refused now
    mesh_name_ = words::printable(name, 60);
    // A file of 64 MiB takes a second to read: the pages of others go on meanwhile.
    reading_ = std::async(std::launch::async, [bytes = std::move(bytes), shown = mesh_name_, unit] {
        return read_mesh(bytes, shown, unit);
    });
}

std::optional<Json> Playground::mesh() {
    const auto answer = [this](Json members) {
        members["name"] = mesh_name_;
        return std::optional(std::move(members));
    };
    try {
        if (reading_.valid() && reading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
            const Read read = reading_.get();
            mesh_triangles_ = read.file.triangles.size();
            mesh_notes_ = read.notes;
            SendOptions options;
            options.scale = read.metre;
            sending_ = claim_.begin_sending(read.file.triangles_of(), options);
        }
        if (!sending_) return std::nullopt;
        const std::optional<SentShape> sent = sending_->done();
        if (!sent) return std::nullopt;
        sending_.reset();
        std::string notes = mesh_notes_;
        for (const std::string& note : meshfile::notes_of(sent->notes))
            notes += (notes.empty() ? "" : "; ") + note;
        const auto corner = [](const Vec3& v) { return Json::array({v.x, v.y, v.z}); };
        return answer({{"ok", true},
                       {"asset", sent->asset},
                       {"triangles", mesh_triangles_},
                       {"faces", sent->faces},
                       {"low", corner(sent->low)},
                       {"high", corner(sent->high)},
                       {"notes", notes}});
    } catch (const std::exception& error) {
        sending_.reset();
        return answer({{"ok", false}, {"error", error.what()}});
    }
}

}  // namespace knurl::gateway
