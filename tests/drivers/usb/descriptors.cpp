#include <initializer_list>

#include "model.hpp"

namespace knurl::drivers::usb_emulator {

std::vector<std::uint8_t> descriptors(const Identity& identity) {
    std::vector<std::uint8_t> bytes;
    const auto add = [&bytes](std::initializer_list<int> more) {
        for (const int byte : more) bytes.push_back(static_cast<std::uint8_t>(byte & 0xff));
    };
    const int endpoints = static_cast<int>(identity.endpoints.size());
    const int total = 9 + 9 + 7 * endpoints;
    add({18, 1, 0, 2, 0, 0, 0, 64});  // device: USB 2.0, packets of 64 bytes at endpoint 0
    add({identity.vendor, identity.vendor >> 8, identity.product, identity.product >> 8, 0, 1, 1, 2, 3, 1});
    add({9, 2, total, total >> 8, 1, 1, 0, 0x80, 50});  // configuration 1: from the bus's power, 100 mA
    add({9, 4, 0, 0, endpoints, identity.interface_class, 0, 0, 0});
    for (const std::uint8_t endpoint : identity.endpoints)
        add({7, 5, endpoint, identity.interrupt_endpoints ? 3 : 2, 64, 0, 1});
    return bytes;
}

}  // namespace knurl::drivers::usb_emulator
