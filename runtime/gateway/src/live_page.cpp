#include <algorithm>
#include <filesystem>

#include <knurl/protocol/text.hpp>
#include <knurl/words/printable.hpp>

#include "live_socket.hpp"
#include "live_text.hpp"

namespace knurl::gateway {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto status_every = std::chrono::milliseconds(250);

}  // namespace

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
    return mesh_bytes(*found->second);
}

std::size_t LivePage::pages() const {
    return impl_->sockets.size();
}

}  // namespace knurl::gateway
