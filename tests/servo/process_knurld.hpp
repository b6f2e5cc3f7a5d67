#pragma once
// knurld as a user starts it, and a client that speaks the raw protocol. Every wait is for an event, with a
// deadline after which the test fails.

#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/spsc_ring.hpp>

#include "../eventually.hpp"
#include "../temp_folder.hpp"

namespace knurl::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// A directory of its own for one test's sockets and state, gone afterwards.
class Home {
  public:
    std::filesystem::path runtime() const { return folder_ / "run"; }
    std::filesystem::path state() const { return folder_ / "state"; }
    std::filesystem::path path() const { return folder_.path(); }
    std::string socket(const std::string& servo = "default") const;

  private:
    TempFolder folder_;
};

std::vector<std::filesystem::path> files_in(const std::filesystem::path& directory);
/// The number of descriptors that the process has open.
std::size_t descriptors_of(pid_t pid);

/// A program with KNURL_RUNTIME_DIR and KNURL_STATE_DIR in `home`; killed and reaped at the end.
class Program {
  public:
    Program(const Home& home, const std::string& program, const std::vector<std::string>& arguments);
    ~Program();
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    pid_t pid() const { return pid_; }
    void signal(int number) const;
    /// Its exit code, or -signal. Throws if it does not end.
    int wait();
    /// All its output on both streams; complete after wait().
    const std::string& output();
    /// Throws if that line does not come.
    void wait_for_output(const std::string& text);

  private:
    bool read_some(int timeout_ms);

    pid_t pid_ = -1;
    shm::UniqueFd pidfd_, pipe_;
    std::string output_;
};

/// A running servo: the constructor returns when it admits clients.
class Knurld : public Program {
  public:
    explicit Knurld(const Home& home,
                    const std::vector<std::string>& arguments = {"--device", "sim:premium15"},
                    const std::string& program = KNURLD);
    ~Knurld();  // with its guardian
    pid_t guardian() const { return guardian_; }

  private:
    pid_t guardian_ = -1;
};

/// The broker's answer: exactly one of these, or nothing when it hung up.
struct Answer {
    std::optional<protocol::Welcome> welcome;
    std::optional<protocol::Refused> refused;
    std::optional<protocol::Claimed> claimed;
    std::optional<protocol::Serving> serving;
    std::optional<protocol::Recording> recording;
    std::optional<protocol::Watching> watching;
    std::vector<shm::UniqueFd> fds;
    shm::Segment memory;  // of a claim that is served
    bool hung_up = false;
};

/// What was refused, and why.
std::string text(const Answer& answer);

class RawClient {
  public:
    explicit RawClient(const Home& home, const std::string& servo = "default");

    template <class Message>
    bool send(const Message& message, const std::vector<int>& fds = {}) {
        return send_bytes(&message, sizeof message, fds);
    }
    bool send_bytes(const void* bytes, std::size_t size, const std::vector<int>& fds = {});
    Answer answer();

    void say_hello(const std::string& name = "a test");
    /// A correct Hello, and its answer.
    Answer greet(const std::string& name = "a test");
    /// The claim is granted; nothing is mapped yet.
    Answer grant(const protocol::ClaimRequest& request);
    /// Says that the claim is mapped, and returns the answer.
    Answer say_mapped(const protocol::Claimed& granted);
    /// The claim is granted, mapped and served, or refused.
    Answer claim(const protocol::ClaimRequest& request);
    void hang_up() { socket_.reset(); }
    int fd() const { return socket_.get(); }

  private:
    shm::UniqueFd socket_;
};

/// Maps the segment of a granted claim for writing.
shm::Segment map_claim(const Answer& granted);

/// The report memory of a device as a client maps it.
class DeviceView {
  public:
    explicit DeviceView(int fd);
    protocol::DeviceInfo info() const;
    std::uint64_t count(protocol::Count which) const;
    const protocol::ClientRow& row(std::uint32_t i) const;
    std::optional<Report> newest() const;
    std::uint32_t held_rows() const;

  private:
    shm::Segment segment_;
};

/// A claim with its command ring.
struct HeldClaim {
    HeldClaim(Answer answer);
    void arm() { send(protocol::CommandType::arm); }
    void reset_fault() { send(protocol::CommandType::reset_fault); }

    protocol::Claimed terms;
    shm::Segment segment;
    shm::SpscProducer commands;
    shm::SentCount sent;
    std::uint64_t issued = 0;

  private:
    void send(protocol::CommandType type);
};

}  // namespace knurl::test
