#pragma once
// A servo, a bridge in front of it, and keys for its clients.

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include <knurl/bridge/keys.hpp>

#include "../client/refusal.hpp"
#include "../client/servo_process.hpp"
#include "../temp_folder.hpp"

namespace knurl::bridge::test {

using namespace client_test;

/// A folder with the bridge's keys file, and one file per key for its owner.
class KeyRing {
  public:
    /// The owner's file.
    std::string add(const std::string& name, Role role) {
        const Key key = make_key(name, role);
        add_key(file(), key);
        add_key(folder_ / name, key);
        return (folder_ / name).string();
    }
    std::string stranger(const std::string& name, Role role) {
        add_key(folder_ / ("stranger-" + name), make_key(name, role));
        return (folder_ / ("stranger-" + name)).string();
    }
    std::string file() const { return (folder_ / "bridge.keys").string(); }

  private:
    knurl::test::TempFolder folder_;
};

inline Client connect_to(const BridgeProcess& bridge, const std::string& key = {}, double report_rate = 0) {
    return Client::connect(bridge.address(),
                           {.name = "test", .wait = 10s, .report_rate = report_rate, .key_file = key});
}
inline Error refused_by(const BridgeProcess& bridge, const std::string& key = {}) {
    return refusal(
        [&] { Client::connect(bridge.address(), {.name = "test", .wait = 0ms, .key_file = key}); });
}

}  // namespace knurl::bridge::test
