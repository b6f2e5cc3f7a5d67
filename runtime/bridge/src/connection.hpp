#pragma once
// The application's end of one connection to a bridge: the TCP frames, a UDP socket for the clock, the
// streams, and a thread. The application's own threads do the work for which they wait (stream.hpp). The
// connection's thread does the rest: the bridge's answers, repeated sending, the clock, reading what nobody
// reads, and detecting the death of the other end.

#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <pthread.h>

#include <knurl/bridge/remote.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/shm/deadline.hpp>
#include <knurl/shm/fd.hpp>

#include "asset_sender.hpp"
#include "clock_estimate.hpp"
#include "datagram_channel.hpp"
#include "frame_stream.hpp"
#include "path_mtu.hpp"
#include "receive_batch.hpp"

namespace knurl::bridge {

class Stream;

class Connection : public std::enable_shared_from_this<Connection> {
  public:
    using Lock = std::unique_lock<std::mutex>;

    /// Connects, greets, and checks that datagrams get through. Throws Error.
    Connection(const Endpoint& bridge, const RemoteOptions& options);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    void start();  // the thread
    void stop();   // ends the thread

    const std::vector<DeviceDescription>& devices() const { return devices_; }
    pid_t servo_pid() const { return servo_pid_; }
    int hang_up() const { return frames_.fd(); }
    /// Of an ended connection: one line. The bridge's own reason, else the local observation.
    std::string why_it_ended();

    struct Joined {
        std::shared_ptr<Stream> stream;
        protocol::Claimed terms;
    };
    /// Throws Error. The stream stays registered here until release().
    Joined attach(std::uint32_t device, const protocol::ClaimRequest& request);
    void release(std::uint32_t stream) noexcept;

    // The assets of a stream's claim. These throw Error.
    using Parcel = AssetSender::Parcel;
    std::shared_ptr<Parcel> offer_asset(std::uint32_t stream, std::uint32_t number,
                                        const shm::UniqueFd& source, std::uint64_t bytes);
    std::optional<protocol::AssetReady> asset_answer(Parcel& parcel);  // none: no answer yet
    void forget_asset(std::uint32_t stream, std::uint32_t number);
    void withdraw_asset(const Parcel& parcel) noexcept;

    // For the streams. One lock guards everything here and in them; no thread sleeps while it holds the lock.
    Lock lock() const { return Lock(mutex_); }
    // With the lock held:
    bool dead() const noexcept { return dead_; }
    bool send(FrameType type, std::uint32_t stream,
              std::span<const std::span<const std::byte>> parts) noexcept;
    /// `room` holds a header (kind, stream, piece) and a body, `bytes` together. False: the path is too
    /// narrow.
    bool post(int socket, std::span<std::byte> room, std::size_t bytes) noexcept;
    /// Opens an incoming datagram, which is also a sign of life of the other end.
    IncomingDatagrams::Opened open(std::span<std::byte> datagram) noexcept;
    std::size_t overhead() const noexcept { return outgoing_.overhead(); }
    const PathMtu& mtu() const noexcept { return mtu_; }
    const ClockEstimate& clock() const noexcept { return clock_; }
    bool encrypted() const noexcept { return frames_.encrypted(); }
    ReceiveBatch& receive_batch() noexcept { return receive_batch_; }
    shm::UniqueFd datagram_socket() const;  // connected to the bridge; throws Error

  private:
    struct Answer {
        std::optional<Attached> attached;
        std::optional<Refused> refused;
    };

    // connection_greeting.cpp, before the thread exists.
    void connect(shm::Deadline deadline);
    void greet(const std::string& name, shm::Deadline deadline);
    void welcome(std::span<const std::byte> payload);
    void try_datagrams(shm::Deadline deadline);
    [[noreturn]] void no_datagrams() const;
    void await_socket(shm::Deadline deadline);
    const Frame* await_frame(shm::Deadline deadline);
    [[noreturn]] void broken() const;
    [[noreturn]] void nonsense() const;
    Error refusal(const Refused& refused) const;

    void run() noexcept;
    void tick(std::int64_t now) noexcept;
    void serve_frames() noexcept;
    void take_frame(const Frame& frame) noexcept;
    void serve_clock() noexcept;
    /// `length`: the least length of the whole datagram, padded with zeros.
    void ping(std::int64_t now, std::size_t length = 0) noexcept;
    void die(std::string_view why = {}) noexcept;
    std::string last_words();
    void give_back(std::uint32_t stream) noexcept;
    Stream* stream_of(std::uint32_t id) noexcept;

    const Endpoint bridge_;
    const std::chrono::milliseconds answer_time_;
    const double report_rate_;
    mutable std::mutex mutex_;
    FrameStream frames_;
    std::optional<detail::LostInChild> frames_lost_in_child_;
    shm::UniqueFd clock_socket_, stop_;
    pthread_t thread_{};
    bool running_ = false;

    OutgoingDatagrams outgoing_;
    IncomingDatagrams incoming_;
    ReceiveBatch receive_batch_;
    std::array<CounterWindow, max_streams + 1>
        windows_{};  // per stream, shared by all later users of its number
    ClockEstimate clock_;
    PathMtu mtu_;
    LongestLately longest_;  // of the datagrams from there
    std::int64_t started_ns_ = 0, next_ping_ns_ = 0, next_probe_ns_ = 0, heard_ns_ = 0, last_tick_ns_ = 0;

    std::vector<DeviceDescription> devices_;
    pid_t servo_pid_ = 0;
    std::array<std::shared_ptr<Stream>, max_streams> streams_;  // of stream n at n - 1
    AssetSender assets_{frames_};
    std::condition_variable answered_;
    std::optional<Answer> answer_;
    bool asked_ = false;  // attach() waits for an answer
    bool dead_ = false;
    char why_[sizeof(Refused::text)] = {};  // the reason, from the bridge or from here; empty: frames_ has it
};

}  // namespace knurl::bridge
