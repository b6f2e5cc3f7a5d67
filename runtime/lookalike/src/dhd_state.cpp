#include "dhd_state.hpp"

#include <algorithm>
#include <charconv>
#include <new>
#include <string>

namespace knurl::lookalike {

const char* const which = "dhd";

namespace dhd {

std::atomic<bool> expert{false};

namespace {

/// Never destroyed: a thread of the program may still call while the process ends, and the servo takes the force of a
/// process that ends.
struct Table {
    std::mutex opening;  // one at a time; taken before the other one
    std::mutex
        mutex;  // for all below, and for a moment alone: a force loop must not wait while a device is opened
    std::array<std::shared_ptr<Opened>, most_devices> devices;
    int chosen = -1;
};

Table& table() {
    static auto& all = *new Table;
    return all;
}

Code code_of(Error::Kind kind) noexcept {
    switch (kind) {
        case Error::Kind::no_servo:
        case Error::Kind::no_such_device:
            return Code::no_device;
        case Error::Kind::device_held:
            return Code::device_in_use;
        case Error::Kind::disconnected:
            return Code::communication;
        case Error::Kind::refused:
            return Code::not_ready;
        default:
            return Code::failed;
    }
}

constexpr std::pair<int, const char*> texts[] = {
    {0, "no error"},
    {1, "undocumented error"},
    {2, "communication error: the servo is gone"},
    {3, "device controller busy"},
    {4, "no driver found"},
    {5, "no device found: does knurld run? `knurl ls` lists the servos"},
    {6, "not available on this device"},
    {7, "timeout"},
    {8, "geometry error"},
    {9, "expert mode is disabled"},
    {10, "not implemented"},
    {11, "out of memory"},
    {12, "device not ready: it is not open, or not armed; see `knurl top`"},
    {13, "file not found"},
    {14, "configuration error"},
    {15, "invalid index"},
    {16, "deprecated"},
    {17, "null argument"},
    {18, "redundant encoders disagree"},
    {19, "not enabled"},
    {20, "device in use: another program holds it and does not share it"},
    {21, "invalid argument"},
    {22, "no regulation runs"},
};

/// With Table::opening. Throws.
void open_at(Table& all, int number, const Place& place) {
    auto device = std::make_shared<Opened>(place);
    const std::lock_guard lock(all.mutex);
    all.devices[static_cast<std::size_t>(number)] = std::move(device);
    all.chosen = number;
}

bool is_open(Table& all, int number) {
    const std::lock_guard lock(all.mutex);
    return all.devices[static_cast<std::size_t>(number)] != nullptr;
}

/// -1: of the default. With the table's mutex. Throws Refused.
std::size_t index_of(const Table& all, char id) {
    const int said = static_cast<signed char>(id);  // char has a sign or none
    const int number = said < 0 ? all.chosen : said;
    if (said >= most_devices) throw Refused{Code::invalid_index};
    if (number < 0 || !all.devices[static_cast<std::size_t>(number)]) throw Refused{Code::not_ready};
    return static_cast<std::size_t>(number);
}

}  // namespace

int& last_error() noexcept {
    thread_local int error = 0;
    return error;
}

const char* text_of(int error) noexcept {
    for (const auto& [number, text] : texts)
        if (number == error) return text;
    return "unknown error";
}

int fail(Code code) noexcept {
    last_error() = static_cast<int>(code);
    return -1;
}

int not_available(const char* function) noexcept {
    say_once(std::string(function) + " is not available");
    return fail(Code::not_available);
}

Code caught() noexcept {
    try {
        throw;
    } catch (const Refused& refused) {
        return refused.code;
    } catch (const Error& error) {
        say_once(error.what());
        return code_of(error.kind);
    } catch (const std::bad_alloc&) {
        return Code::out_of_memory;
    } catch (const std::exception& error) {
        say_once(error.what());
        return Code::failed;
    } catch (...) {
        return Code::failed;
    }
}

std::shared_ptr<Opened> opened(char id) {
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    return all.devices[index_of(all, id)];
}

HandReport report(Opened& device) {
    if (const auto newest = device.hand.newest()) return *newest;
    throw Refused{Code::communication};
}

HandReport report(char id) {
    return report(*opened(id));
}

int open_number(int number) {
    if (number < 0 || number >= most_devices) throw Refused{Code::invalid_index};
    Table& all = table();
    const std::lock_guard opening(all.opening);
    if (is_open(all, number)) {
        const std::lock_guard lock(all.mutex);
        return all.chosen = number;
    }
    const std::vector<Place> known = places();
    if (static_cast<std::size_t>(number) >= known.size()) throw Refused{Code::no_device};
    open_at(all, number, known[static_cast<std::size_t>(number)]);
    return number;
}

int open_first() {
    Table& all = table();
    const std::lock_guard opening(all.opening);
    const std::vector<Place> known = places();
    Code why = Code::no_device;
    for (int number = 0; number < std::min(most_devices, static_cast<int>(known.size())); ++number) {
        if (is_open(all, number)) continue;
        try {
            open_at(all, number, known[static_cast<std::size_t>(number)]);
            return number;
        } catch (...) {
            why = caught();
        }
    }
    throw Refused{why};
}

void close_device(char id) {
    std::shared_ptr<Opened> closing;  // ends outside of the lock, when the last call in another thread has
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    const std::size_t index = index_of(all, id);
    closing = std::exchange(all.devices[index], nullptr);
    if (all.chosen != static_cast<int>(index)) return;
    const auto left =
        std::find_if(all.devices.begin(), all.devices.end(), [](const auto& d) { return d != nullptr; });
    all.chosen = left == all.devices.end() ? -1 : static_cast<int>(left - all.devices.begin());
}

int default_device() noexcept {
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    return all.chosen;
}

void set_default(char id) {
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    all.chosen = static_cast<int>(index_of(all, id));
}

int type_of(const DeviceDescription& device) {
    constexpr int falcon = 60, omega3 = 33, omega6_right = 34, custom = 91;
    if (device.profile == "falcon") return falcon;
    if (device.renders_torque) return custom;  // a wrist with motors, and no gripper: none of theirs
    return device.senses_orientation ? omega6_right : omega3;
}

unsigned short serial_of(const DeviceDescription& device, int number) {
    const std::string& text = device.serial;
    const std::size_t digits = text.find_last_not_of("0123456789") + 1;  // npos + 1: all of it
    unsigned value = 0;
    const auto [end, error] = std::from_chars(text.data() + digits, text.data() + text.size(), value);
    if (error == std::errc{} && end != text.data() + digits) return static_cast<unsigned short>(value);
    return static_cast<unsigned short>(number + 1);
}

void require_expert() {
    if (!expert) throw Refused{Code::expert_mode_disabled};
}

}  // namespace dhd

}  // namespace knurl::lookalike
