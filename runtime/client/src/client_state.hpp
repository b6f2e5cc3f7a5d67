#pragma once
// One connection: the handshake, the list of its readers and claims, and a watcher. The watcher is a thread
// that sleeps until the servo hangs up, and attaches all of them again when the servo is back.

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <pthread.h>

#include <knurl/bridge/endpoint.hpp>
#include <knurl/client/client.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/link/transport.hpp>
#include <knurl/protocol/registry.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::detail {

class Reader;

class ClientState {
  public:
    /// Waits for a servo that is still starting. Throws Error.
    ClientState(const std::string& address, const ConnectOptions& options);
    ClientState(const ClientState&) = delete;
    ClientState& operator=(const ClientState&) = delete;

    std::vector<DeviceDescription> devices();
    pid_t servo_pid();
    bool connected();
    /// "": the only device. Throws Error::no_such_device with the names of all devices.
    std::string resolve(const std::string& device);

    /// Attaches a reader and keeps it attached. Throws Error.
    void join(Reader& reader);
    /// On return the watcher no longer knows it.
    void leave(Reader& reader);

    void close();                    // ends the watcher
    bool stopping() const noexcept;  // close() has begun
    bool hints() const noexcept { return hints_; }

  private:
    using Lock = std::unique_lock<std::mutex>;

    std::unique_ptr<Link> open_link() const;
    std::unique_ptr<Link> open_link(const std::string& servo,
                                    const std::vector<bridge::Endpoint>& bridge) const;
    void watch();
    bool sleep_on(int descriptor, std::chrono::milliseconds timeout);  // false: close() was called
    void lose_link();
    void note_loss(const std::string& why);
    void reattach();
    void attach_one(Reader& reader);
    [[noreturn]] void throw_disconnected() const;

    const std::uint64_t made_in_ = fork_generation();
    const std::optional<protocol::RegistryAddress> registry_;  // it is looked up anew for each attempt
    const std::vector<bridge::Endpoint>
        bridge_;               // its addresses; none: a local servo, or one of the registry
    const std::string servo_;  // its name; through a bridge: host and port
    const ConnectOptions options_;
    const bool hints_;
    shm::UniqueFd stop_;  // readable: the watcher ends
    pthread_t watcher_{};

    // Taken before any Reader's mutex, never after one. Serialises requests on the socket.
    std::mutex mutex_;
    std::unique_ptr<Link> link_;  // null: detached
    std::vector<Reader*> readers_;
    std::string lost_;       // why it was lost last, or why it does not come back
    bool hopeless_ = false;  // for the watcher: attempts are useless until a person acts there
};

}  // namespace knurl::detail
