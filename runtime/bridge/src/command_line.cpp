#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <sys/resource.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <knurl/bridge/bridge.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/servo_address.hpp>

#include "relay.hpp"

namespace knurl::bridge {

namespace {

constexpr const char* description =
    "Lets applications on other hosts use a servo of this host, as knurl://HOST:PORT. It is an ordinary\n"
    "client of the servo. With keys (made by `keygen`) all traffic is encrypted, and a key's role says what\n"
    "its owner may do. Without keys it serves this host only, every user of it, and must be told so: "
    "--anyone.";
std::string bounds() {
    return detail::format(
        "Bounds: {} sessions, {} claims and observers each; {} callers that have shown no key, {} that have "
        "and "
        "are\nnot in yet ({} of one host), {:g} s each; a session without a sign of life for {:g} s ends; "
        "its "
        "application\ncounts as silent {:g} s later than a local one.",
        max_sessions, max_streams, WaitingRoom::seats, Relay::most_pending, Relay::most_pending_of_host,
        Relay::greeting_seconds, static_cast<double>(dead_after_ns) * 1e-9, delay_allowance);
}

/// Signals arrive through a descriptor.
shm::UniqueFd take_signals() {
    sigset_t set;
    ::sigemptyset(&set);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaddset(&set, signal);
    ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    shm::UniqueFd fd(::signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK));
    if (!fd) throw std::runtime_error(detail::format("signalfd: {}", std::strerror(errno)));
    return fd;
}

/// Each stream costs a few descriptors, and the usual soft limit is 1024.
void raise_descriptor_limit() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = std::max(limit.rlim_cur, std::min<rlim_t>(limit.rlim_max, 16384));
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// A remark about the servo at the start; empty if it runs.
std::string about(const std::string& servo) {
    try {
        detail::connect_local(servo, "knurl-bridge", servo_answer_time);
        return {};
    } catch (const Error& error) {
        return detail::format(", but {} (clients are told so until then)", error.what());
    }
}

/// TCP does not say which user of this host calls, as the servo's own socket does.
void require_keys_or_anyone(const std::vector<Endpoint>& listen, bool keys, bool anyone) {
    const bool this_host =
        std::any_of(listen.begin(), listen.end(), [](const Endpoint& each) { return each.loopback(); });
    if (this_host && !keys && !anyone)
        throw commandline::UsageError(
            "without keys every user of this host could move the hand: make a key (`knurl-bridge keygen "
            "--name "
            "NAME --role control`) and give --keys FILE, or give --anyone if that is meant");
    if (keys && anyone) throw commandline::UsageError("--keys FILE and --anyone: give one of the two");
}

int serve(const std::string& servo, const std::string& listen, const std::string& keys_file, bool anyone) {
    try {
        protocol::servo_address(servo);
    } catch (const std::runtime_error& error) {
        throw commandline::UsageError(std::string("--servo ") + error.what());
    }
    RelayOptions options;
    options.servo = servo;
    options.listen = resolve_all(listen);
    require_keys_or_anyone(options.listen, !keys_file.empty(), anyone);
    if (!keys_file.empty()) options.keys = read_keys(keys_file);
    const shm::UniqueFd signals = take_signals();
    raise_descriptor_limit();
    commandline::go_before_others();
    Relay relay(std::move(options));
    std::printf("knurl-bridge: servo '%s' is reached at knurl://%s%s%s\n", servo.c_str(),
                relay.listening_at().c_str(), keys_file.empty() ? "" : ", with a key", about(servo).c_str());
    std::fflush(stdout);
    for (;;) {
        relay.run(signals.get());
        signalfd_siginfo what{};
        if (::read(signals.get(), &what, sizeof what) != sizeof what || what.ssi_signo != SIGHUP) return 0;
        if (keys_file.empty()) return 0;  // its terminal was closed: there is no file to read again
        try {
            relay.admit(read_keys(keys_file));
            std::printf("knurl-bridge: %s: read again\n", keys_file.c_str());
        } catch (const std::exception& error) {
            std::printf("knurl-bridge: %s; the keys stay as they were\n", error.what());
        }
        std::fflush(stdout);
    }
}

int generate(const std::string& file, const std::string& name, const std::string& role_word) {
    const std::optional<Role> role = parse_role(role_word);
    if (!role)
        throw commandline::UsageError(
            detail::format("--role {}: give observe, render or control", role_word));
    const Key key = make_key(name, *role);
    add_key(file, key);
    std::printf(
        "%s: key of %s, role %s, added. Give its owner this one line in a file of mode 0600, named by "
        "KNURL_KEY.\n",
        file.c_str(), name.c_str(), role_word.c_str());
    return 0;
}

}  // namespace

int bridge_main(int argc, char** argv) {
    std::string servo = "default", listen = "127.0.0.1:4096", keys, name, role = "control";
    std::string file = "/etc/knurl/bridge.keys";
    bool anyone = false;
    commandline::Command app("knurl-bridge", description);
    app.footer(bounds());
    app.servo(servo, "The servo's name").shows_default();
    app.option("--listen", listen, "HOST:PORT, for TCP and UDP; any but this host's own needs --keys")
        .shows_default();
    app.flag("--anyone", anyone, "Without keys: any user of this host may do everything");
    app.option("--keys", keys, "File with the keys that may connect (mode 0600); read again on SIGHUP");
    commandline::Command& keygen = app.verb("keygen", "Adds a key to a file");
    keygen.option("--keys", file, "The file; created if it is missing").shows_default();
    keygen.option("--name", name, "Whose key it is").required();
    keygen.option("--role", role, "observe (reports), render (joins a device that is on), control (all)")
        .shows_default();
    keygen.action([&] { return generate(file, name, role); });
    app.action([&] { return serve(servo, listen, keys, anyone); });
    return commandline::run(app, argc, argv);
}

}  // namespace knurl::bridge
