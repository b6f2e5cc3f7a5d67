#include "two_hosts.hpp"

#include <atomic>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include "../../rights.hpp"

namespace knurl::bridge::test {

namespace {

constexpr const char* own_space = "/proc/thread-self/ns/net";
std::atomic<int> made = 0;  // by this process: each pair has its own names and addresses

}  // namespace

TwoHosts::TwoHosts(int server_mtu, int client_mtu) {
    const int number = made++;
    base_ = "knurl-" + std::to_string(::getpid()) + "-" + std::to_string(number);
    net_ = (::getpid() + number) % 250;
    const std::string a = name(Host::server), b = name(Host::client), width = "/24";
    run("ip netns add " + a);
    run("ip netns add " + b);
    run("ip -n " + a + " link add wire mtu " + std::to_string(server_mtu) + " type veth peer name wire mtu " +
        std::to_string(client_mtu) + " netns " + b);
    run("ip -n " + a + " address add " + address(Host::server) + width + " dev wire");
    run("ip -n " + b + " address add " + address(Host::client) + width + " dev wire");
    for (const std::string& host : {a, b})
        for (const char* link : {"lo", "wire"}) run("ip -n " + host + " link set " + link + " up");
    for (const Host host : {Host::server, Host::client}) {
        auto& space = spaces_[static_cast<std::size_t>(host)];
        space = shm::UniqueFd(::open(("/run/netns/" + name(host)).c_str(), O_RDONLY | O_CLOEXEC));
        if (two_ && !space) {
            give_up("no /run/netns/" + name(host));
        }
    }
}

TwoHosts::~TwoHosts() {
    if (base_.empty()) return;
    for (const Host host : {Host::server, Host::client}) {
        spaces_[static_cast<std::size_t>(host)].reset();
        // Also where only one could be made. The wire goes with its ends.
        [[maybe_unused]] const int gone =
            std::system(("ip netns delete " + name(host) + " >/dev/null 2>&1").c_str());
    }
}

bool TwoHosts::narrow(Host host, int mtu) {
    run("ip -n " + name(host) + " link set wire mtu " + std::to_string(mtu));
    return two_;
}

std::string TwoHosts::name(Host host) const {
    return base_ + (host == Host::server ? "-server" : "-client");
}

std::string TwoHosts::address(Host host) const {
    if (!two_) return "127.0.0.1";
    return "10.99." + std::to_string(net_) + (host == Host::server ? ".1" : ".2");
}

void TwoHosts::run(const std::string& command) {
    if (!two_) return;
    if (std::system((command + " >/dev/null 2>&1").c_str()) == 0) return;
    give_up("`" + command + "` failed");
}

void TwoHosts::give_up(const std::string& why) {
    two_ = false;
    why_ = knurl::test::missing(
        "network namespaces", why,
        "root has it, with CAP_NET_ADMIN and CAP_SYS_ADMIN; the other tests go over loopback");
}

TwoHosts::On::On(const TwoHosts& hosts, Host host) {
    if (!hosts.two()) return;
    before_ = shm::UniqueFd(::open(own_space, O_RDONLY | O_CLOEXEC));
    if (!before_ || ::setns(hosts.spaces_[static_cast<std::size_t>(host)].get(), CLONE_NEWNET) != 0)
        throw std::runtime_error("cannot enter the network namespace");
}

TwoHosts::On::~On() {
    if (before_) ::setns(before_.get(), CLONE_NEWNET);
}

}  // namespace knurl::bridge::test
