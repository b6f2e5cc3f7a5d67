#include "hd_state.hpp"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <deque>
#include <string>

#include <knurl/client/error.hpp>

namespace knurl::lookalike {

const char* const which = "hd";

namespace hd {

namespace {

/// Never destroyed: the scheduler or a thread of the program may still call while the process ends.
struct Table {
    std::mutex opening;  // one at a time; taken before the other one
    std::mutex
        mutex;  // for all below, and for a moment alone: the scheduler must not wait while a device is opened
    std::array<std::shared_ptr<Device>, most_devices> devices;
    std::array<Place, most_devices> where;
};

Table& table() {
    static auto& all = *new Table;
    return all;
}

constexpr HHD none = HD_INVALID_HANDLE;
/// What another thread made current: for threads that have not chosen, as the scheduler's.
std::atomic<HHD> chosen_last{none};
thread_local HHD chosen_here = none;
/// The handle of the error: the device that the thread spoke to last.
thread_local HHD spoken_to = none;

std::string small(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// "Default Device", "Default PHANToM", "" and null mean the first one; "Left Device" is also the device `left`.
bool means(const std::string& said, const Place& place) {
    const std::string wanted = small(said), name = small(place.device);
    return wanted == name || wanted == name + " device" ||
           (!place.alias.empty() && wanted == small(place.alias)) || said == place.servo + "/" + place.device;
}

std::size_t find_place(const std::vector<Place>& known, const char* said) {
    if (known.empty()) throw Error(Error::Kind::no_such_device, "the servo has no device");
    const std::string name = said == nullptr ? "" : said;
    if (name.empty() || small(name).starts_with("default ")) return 0;
    std::string names;
    for (std::size_t i = 0; i < known.size(); ++i) {
        if (means(name, known[i])) return i;
        names += (names.empty() ? "" : ", ") + known[i].device;
    }
    throw Error(Error::Kind::no_such_device, "there is no device '" + name + "'; there are: " + names +
                                                 "; knurl as hd --device '" + name + "=" + known[0].device +
                                                 "' gives one that name");
}

HDerror code_of(Error::Kind kind) noexcept {
    switch (kind) {
        case Error::Kind::refused:
        case Error::Kind::device_held:
            return HD_DEVICE_FAULT;
        default:
            return HD_COMM_ERROR;
    }
}

std::deque<HDErrorInfo>& errors() {
    thread_local std::deque<HDErrorInfo> stack;
    return stack;
}

}  // namespace

void fail(HDerror code) noexcept try {
    constexpr std::size_t most = 64;  // a program that never asks must not fill the memory: the oldest go
    auto& stack = errors();
    if (stack.size() == most) stack.pop_front();
    stack.push_back({code, 0, spoken_to});
} catch (...) {
    // No memory for an error.
}

HDErrorInfo take_error() noexcept {
    auto& stack = errors();
    if (stack.empty()) return {HD_SUCCESS, 0, none};
    const HDErrorInfo newest = stack.back();
    stack.pop_back();
    return newest;
}

void not_available(const char* what) noexcept {
    say_once(std::string(what) + " is not available");
    fail(HD_INVALID_OPERATION);
}

HDerror caught() noexcept {
    try {
        throw;
    } catch (const Refused& refused) {
        return refused.code;
    } catch (const Error& error) {
        say_once(error.what());
        return code_of(error.kind);
    } catch (const std::exception& error) {
        say_once(error.what());
        return HD_DEVICE_FAULT;
    } catch (...) {
        return HD_DEVICE_FAULT;
    }
}

namespace {

/// The handle of that device, if it is open, and one that is free (none: there is none).
std::pair<HHD, HHD> look_up(Table& all, const Place& place) {
    const std::lock_guard lock(all.mutex);
    HHD same = none, free = none;
    for (HHD i = most_devices; i-- > 0;) {
        if (!all.devices[i])
            free = i;
        else if (all.where[i].servo == place.servo && all.where[i].device == place.device)
            same = i;
    }
    return {same, free};
}

}  // namespace

HHD open(const char* name) {
    Table& all = table();
    const std::lock_guard opening(all.opening);
    const std::vector<Place> known = places();
    const Place& place = known[find_place(known, name)];
    const auto [same, free] = look_up(all, place);
    if (same != none) {
        make_current(same);
        fail(HD_DEVICE_ALREADY_INITIATED);
        return same;
    }
    if (free == none) throw Refused{HD_DEVICE_FAULT};
    auto device = std::make_shared<Device>(place);
    device->hand.allow_force(false);  // until hdEnable(HD_FORCE_OUTPUT)
    device->now.report = device->last.report = device->hand.newest().value_or(HandReport{});
    {
        const std::lock_guard lock(all.mutex);
        all.devices[free] = std::move(device);
        all.where[free] = place;
    }
    make_current(free);
    return free;
}

void close_device(HHD handle) {
    std::shared_ptr<Device> closing;  // ends outside of the lock, when the last call in another thread has
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    if (handle >= most_devices || !all.devices[handle]) throw Refused{HD_BAD_HANDLE};
    closing = std::exchange(all.devices[handle], nullptr);
    HHD was = handle;
    chosen_last.compare_exchange_strong(was, none);
    if (chosen_here == handle) chosen_here = none;
}

std::shared_ptr<Device> device_of(HHD handle) {
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    if (handle >= most_devices || !all.devices[handle]) throw Refused{HD_BAD_HANDLE};
    spoken_to = handle;
    return all.devices[handle];
}

HHD current_handle() noexcept {
    return chosen_here != none ? chosen_here : chosen_last.load();
}

std::shared_ptr<Device> current() {
    return device_of(current_handle());
}

std::shared_ptr<Device> first() noexcept {
    Table& all = table();
    const std::lock_guard lock(all.mutex);
    for (const auto& device : all.devices)
        if (device) return device;
    return nullptr;
}

void make_current(HHD handle) {
    chosen_here = chosen_last = handle;
    spoken_to = handle;
}

}  // namespace hd

}  // namespace knurl::lookalike
