#include "registry.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/bridge/host_and_port.hpp>
#include <knurl/dds/registry.hpp>
#include <knurl/json/json.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

#include "wire_text.hpp"

namespace knurl::dds {

namespace {

constexpr const char* topic = "knurl/servos";
constexpr std::size_t longest_text = 200;
constexpr std::size_t most_devices = 64;

EndpointOptions quality() {
    return {.reliable = true, .transient_local = true, .depth = 1, .liveliness = Registry::lease};
}

/// A peer's text: another process wrote it.
std::string shown(const char* text) {
    return words::printable(said(text), longest_text);
}

knurl_dds_DeviceEntry wire(const DeviceEntry& device) {
    knurl_dds_DeviceEntry entry{};
    entry.name = text(device.name);
    entry.profile = text(device.profile);
    entry.state = text(device.state);
    entry.faults = text(device.faults);
    entry.rate = device.rate;
    entry.measured_rate = device.measured_rate;
    entry.peak_force = device.peak_force;
    entry.force = device.force;
    entry.max_stiffness = device.max_stiffness;
    entry.renders_torque = device.renders_torque;
    entry.senses_orientation = device.senses_orientation;
    entry.commanded_by_dds = device.commanded_by_dds;
    entry.holders = device.holders;
    entry.cycles = device.cycles;
    entry.late_cycles = device.late_cycles;
    return entry;
}

DeviceEntry read(const knurl_dds_DeviceEntry& entry) {
    return {.name = shown(entry.name),
            .profile = shown(entry.profile),
            .state = shown(entry.state),
            .faults = shown(entry.faults),
            .rate = entry.rate,
            .measured_rate = entry.measured_rate,
            .peak_force = entry.peak_force,
            .force = entry.force,
            .max_stiffness = entry.max_stiffness,
            .renders_torque = entry.renders_torque,
            .senses_orientation = entry.senses_orientation,
            .commanded_by_dds = entry.commanded_by_dds,
            .holders = entry.holders,
            .cycles = entry.cycles,
            .late_cycles = entry.late_cycles};
}

ServoEntry read(const knurl_dds_ServoInfo& info) {
    ServoEntry servo{.id = shown(info.id),
                     .name = shown(info.name),
                     .servo = shown(info.servo),
                     .host = shown(info.host),
                     .pid = info.pid,
                     .build = shown(info.build),
                     .bridge = shown(info.bridge),
                     .state = shown(info.state)};
    const std::size_t count = std::min<std::size_t>(info.devices._length, most_devices);
    for (std::size_t i = 0; i < count; ++i) servo.devices.push_back(read(info.devices._buffer[i]));
    return servo;
}

}  // namespace

std::string json_of(const ServoEntry& servo) {
    Json devices = Json::array();
    for (const DeviceEntry& device : servo.devices)
        devices.push_back({{"name", device.name},
                           {"profile", device.profile},
                           {"state", device.state},
                           {"fault_names", device.faults.empty() ? Json() : Json(device.faults)},
                           {"rate", device.rate},
                           {"measured_rate", device.measured_rate > 0 ? Json(device.measured_rate) : Json()},
                           {"peak_force", device.peak_force},
                           {"force", device.force},
                           {"k_max", device.max_stiffness},
                           {"renders_torque", device.renders_torque},
                           {"senses_orientation", device.senses_orientation},
                           {"commanded_by_dds", device.commanded_by_dds},
                           {"holders", device.holders},
                           {"cycles", device.cycles},
                           {"late_cycles", device.late_cycles}});
    return Json{{"name", servo.name},
                {"address", "knurl://" + servo.name + "/"},
                {"servo", servo.servo},
                {"host", servo.host},
                {"pid", servo.pid},
                {"build", servo.build},
                {"bridge", servo.bridge.empty() ? Json() : Json(servo.bridge)},
                {"state", servo.state},
                {"devices", devices}}
        .dump();
}

Registry::Registry(Domain& domain)
    : domain_(domain), reader_(domain.reader(topic, knurl_dds_ServoInfo_desc, quality())) {}

void Registry::announce(const ServoEntry& servo) {
    const std::scoped_lock lock(mutex_);
    if (!writer_) writer_ = domain_.writer(topic, knurl_dds_ServoInfo_desc, quality());
    own_ = servo;
    std::vector<knurl_dds_DeviceEntry> devices;
    for (const DeviceEntry& device : servo.devices) devices.push_back(wire(device));
    knurl_dds_ServoInfo info{};
    info.id = text(servo.id);
    info.name = text(servo.name);
    info.servo = text(servo.servo);
    info.host = text(servo.host);
    info.pid = servo.pid;
    info.build = text(servo.build);
    info.bridge = text(servo.bridge);
    info.state = text(servo.state);
    info.revision = ++revision_;
    info.devices._maximum = info.devices._length = static_cast<std::uint32_t>(devices.size());
    info.devices._buffer = devices.data();
    // A reader that takes nothing for a millisecond misses this one and gets the next.
    dds_write(writer_.get(), &info);
}

ServoEntry Registry::own() const {
    const std::scoped_lock lock(mutex_);
    return own_;
}

std::vector<ServoEntry> Registry::servos() const {
    const std::scoped_lock lock(mutex_);
    std::vector<void*> samples(most_servos, nullptr);
    std::vector<dds_sample_info_t> infos(most_servos);
    const dds_return_t count =
        dds_read(reader_.get(), samples.data(), infos.data(), most_servos, most_servos);
    std::vector<ServoEntry> all;
    std::map<std::string, Heard> heard;
    const auto now = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i)
        if (infos[i].valid_data && infos[i].instance_state == DDS_ALIVE_INSTANCE_STATE) {
            const auto& info = *static_cast<const knurl_dds_ServoInfo*>(samples[i]);
            ServoEntry servo = read(info);
            const auto before = heard_.find(servo.id);
            Heard& last = heard[servo.id] =
                before == heard_.end() ? Heard{info.revision, now} : before->second;
            if (last.revision != info.revision) last = {info.revision, now};
            if (now - last.at <= silence) all.push_back(std::move(servo));
        }
    heard_ = std::move(heard);
    if (count > 0) dds_return_loan(reader_.get(), samples.data(), count);
    std::sort(all.begin(), all.end(), [](const ServoEntry& a, const ServoEntry& b) {
        return std::tie(a.name, a.id) < std::tie(b.name, b.id);
    });
    return all;
}

std::vector<std::string> Registry::name_clashes() const {
    std::vector<std::string> lines;
    const std::vector<ServoEntry> all = servos();
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        if (all[i].name != all[i + 1].name || (i > 0 && all[i - 1].name == all[i].name)) continue;
        lines.push_back(
            fmt::format("two servos are called '{}', on {} (pid {}) and {} (pid {}): nobody can connect to "
                        "knurl://{}/ until one has "
                        "another --name",
                        all[i].name, all[i].host, all[i].pid, all[i + 1].host, all[i + 1].pid, all[i].name));
    }
    return lines;
}

std::string Registry::resolve(const std::string& name) const {
    const std::vector<ServoEntry> all = servos();
    std::vector<const ServoEntry*> found;
    std::vector<std::string> names;
    for (const ServoEntry& servo : all) {
        names.push_back(servo.name);
        if (servo.name == name) found.push_back(&servo);
    }
    const std::string domain = fmt::format("domain {}", domain_.options().id);
    if (found.empty()) {
        const std::string known = names.empty() ? std::string("no servo is announced there")
                                                : fmt::format("there are {}", fmt::join(names, ", "));
        return fmt::format("? {} has no servo '{}'; {}", domain, words::printable(name, longest_text),
                           words::did_you_mean(name, names, known));
    }
    if (found.size() > 1)
        return fmt::format("? {} servos of {} are called '{}', on {} and {}; give one of them another --name",
                           found.size(), domain, name, found[0]->host, found[1]->host);
    const ServoEntry& servo = *found.front();
    if (servo.state != "running")
        return fmt::format("? servo '{}' on {} does not run, only its knurl-dds does; start knurld there",
                           name, servo.host);
    if (servo.id == own().id) return "knurl:" + servo.servo;
    if (servo.bridge.empty())
        return fmt::format(
            "? servo '{}' on {} announces no bridge, so no other host can use it; start knurl-bridge there "
            "and knurl-dds with "
            "--bridge HOST:PORT",
            name, servo.host);
    try {
        bridge::check_host_and_port(servo.bridge);
    } catch (const std::runtime_error& error) {
        return fmt::format("? servo '{}' on {} announces a bridge that is none: {}", name, servo.host,
                           error.what());
    }
    return "knurl://" + servo.bridge;
}

}  // namespace knurl::dds
