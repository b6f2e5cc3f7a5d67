#include "process_knurld.hpp"

#include <chrono>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <knurl/protocol/command.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/counters.hpp>
#include <knurl/shm/socket.hpp>

namespace knurl::test {

namespace {

constexpr int patience_ms = static_cast<int>(std::chrono::milliseconds(patience).count());

shm::UniqueFd open_pidfd(pid_t pid) {
    return shm::UniqueFd(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
}

bool readable(int fd, int timeout_ms) {
    pollfd wait{.fd = fd, .events = POLLIN, .revents = 0};
    return poll(&wait, 1, timeout_ms) > 0;
}

}  // namespace

std::string Home::socket(const std::string& servo) const {
    return (runtime() / (servo + ".sock")).string();
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& directory) {
    std::vector<std::filesystem::path> files;
    std::error_code none;  // no such directory: no files
    for (const auto& entry : std::filesystem::directory_iterator(directory, none))
        files.push_back(entry.path());
    return files;
}

std::size_t descriptors_of(pid_t pid) {
    return files_in("/proc/" + std::to_string(pid) + "/fd").size();
}

Program::Program(const Home& home, const std::string& program, const std::vector<std::string>& arguments) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    pipe_ = shm::UniqueFd(ends[0]);
    const shm::UniqueFd childs_end(ends[1]);
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string runtime = home.runtime().string();
    const std::string state = home.state().string();
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("fork");
    if (pid_ == 0) {
        setenv("KNURL_RUNTIME_DIR", runtime.c_str(), 1);
        setenv("KNURL_STATE_DIR", state.c_str(), 1);
        dup2(childs_end.get(), STDOUT_FILENO);
        dup2(childs_end.get(), STDERR_FILENO);
        execv(argv[0], argv.data());
        _exit(127);
    }
    pidfd_ = open_pidfd(pid_);
}

Program::~Program() {
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
}

void Program::signal(int number) const {
    kill(pid_, number);
}

int Program::wait() {
    // Reads its pipe meanwhile, so that it cannot block on it. A guardian may hold the pipe's other end
    // longer.
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (!readable(pidfd_.get(), 0)) {
        if (std::chrono::steady_clock::now() > deadline) {
            throw std::runtime_error("process " + std::to_string(pid_) +
                                     " does not end; it said: " + output_);
        }
        if (!read_some(20)) readable(pidfd_.get(), 20);
    }
    while (read_some(0)) {
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

bool Program::read_some(int timeout_ms) {
    if (!readable(pipe_.get(), timeout_ms)) return false;
    char text[4096];
    const ssize_t n = read(pipe_.get(), text, sizeof text);
    if (n <= 0) return false;
    output_.append(text, static_cast<std::size_t>(n));
    return true;
}

const std::string& Program::output() {
    while (read_some(0)) {
    }
    return output_;
}

void Program::wait_for_output(const std::string& text) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (output_.find(text) == std::string::npos) {
        const bool ended = readable(pidfd_.get(), 0);
        if (!read_some(20) && (ended || std::chrono::steady_clock::now() > deadline)) {
            throw std::runtime_error("\"" + text + "\" does not come; it said: " + output_);
        }
    }
}

Knurld::Knurld(const Home& home, const std::vector<std::string>& arguments, const std::string& program)
    : Program(home, program, arguments) {
    wait_for_output("knurld: ready");
    const std::string word = "guardian ";
    const std::size_t at = output().find(word);
    if (at == std::string::npos) throw std::runtime_error("no guardian: " + output());
    guardian_ = static_cast<pid_t>(std::stol(output().substr(at + word.size())));
}

Knurld::~Knurld() {
    // The guardian of a killed servo writes its file into the test's directory before that is removed.
    const shm::UniqueFd watch = open_pidfd(guardian_);
    if (pid() > 0) signal(SIGKILL);
    if (pid() > 0) signal(SIGCONT);
    if (watch) readable(watch.get(), patience_ms);
}

std::string text(const Answer& answer) {
    return answer.refused ? answer.refused->text : "not refused";
}

RawClient::RawClient(const Home& home, const std::string& servo)
    : socket_(shm::connect_to(home.socket(servo))) {}

bool RawClient::send_bytes(const void* bytes, std::size_t size, const std::vector<int>& fds) {
    return shm::send_message(socket_, {static_cast<const std::byte*>(bytes), size}, fds);
}

Answer RawClient::answer() {
    if (!readable(socket_.get(), patience_ms)) throw std::runtime_error("the broker does not answer");
    std::array<std::byte, 4096> buffer;
    shm::Received received = shm::receive_message(socket_, buffer);
    Answer answer;
    if (received.closed) {
        answer.hung_up = true;
        return answer;
    }
    const auto take = [&](auto& into) {
        using Message = typename std::remove_reference_t<decltype(into)>::value_type;
        if (received.bytes != sizeof(Message)) throw std::runtime_error("an answer of the wrong size");
        into.emplace();
        std::memcpy(static_cast<void*>(&*into), buffer.data(), sizeof(Message));
    };
    protocol::MessageHeader header;
    std::memcpy(&header, buffer.data(), sizeof header);
    switch (header.type) {
        case protocol::MessageType::welcome:
            take(answer.welcome);
            break;
        case protocol::MessageType::refused:
            take(answer.refused);
            break;
        case protocol::MessageType::claimed:
            take(answer.claimed);
            break;
        case protocol::MessageType::serving:
            take(answer.serving);
            break;
        case protocol::MessageType::recording:
            take(answer.recording);
            break;
        case protocol::MessageType::watching:
            take(answer.watching);
            break;
        default:
            throw std::runtime_error("an answer that is none");
    }
    answer.fds = std::move(received.fds);
    return answer;
}

void RawClient::say_hello(const std::string& name) {
    protocol::Hello hello;
    hello.layout = protocol::wire_hash();
    name.copy(hello.client, sizeof hello.client - 1);
    send(hello);
}

Answer RawClient::greet(const std::string& name) {
    say_hello(name);
    return answer();
}

Answer RawClient::grant(const protocol::ClaimRequest& request) {
    send(request);
    return answer();
}

Answer RawClient::say_mapped(const protocol::Claimed& granted) {
    protocol::Mapped mapped;
    mapped.key = granted.key;
    send(mapped);
    return answer();
}

Answer RawClient::claim(const protocol::ClaimRequest& request) {
    Answer granted = grant(request);
    if (!granted.claimed) return granted;
    granted.memory = map_claim(granted);
    granted.memory.seal_against_new_writers();
    Answer served = say_mapped(*granted.claimed);
    if (served.refused) return served;
    if (!served.serving) throw std::runtime_error("an answer to Mapped that is none");
    return granted;
}

shm::Segment map_claim(const Answer& granted) {
    return shm::Segment::open(granted.fds.at(0).get(),
                              protocol::claim_layout(granted.claimed.value().capacity).total,
                              shm::Segment::Access::read_write);
}

DeviceView::DeviceView(int fd)
    : segment_(shm::Segment::open(fd, protocol::device_layout().total, shm::Segment::Access::read_only)) {}

protocol::DeviceInfo DeviceView::info() const {
    protocol::DeviceInfo info;
    std::memcpy(static_cast<void*>(&info), segment_.data() + protocol::device_layout().info, sizeof info);
    return info;
}

std::uint64_t DeviceView::count(protocol::Count which) const {
    return shm::CountersReader(segment_.data() + protocol::device_layout().counters, protocol::count_names)
        .read(static_cast<std::size_t>(which));
}

const protocol::ClientRow& DeviceView::row(std::uint32_t i) const {
    return reinterpret_cast<const protocol::ClientRow*>(segment_.data() +
                                                        protocol::device_layout().clients)[i];
}

std::optional<Report> DeviceView::newest() const {
    shm::BroadcastReader reader(segment_.data() + protocol::device_layout().reports, protocol::report_slots,
                                sizeof(Report));
    Report report;
    if (!reader.latest(&report)) return std::nullopt;
    return report;
}

std::uint32_t DeviceView::held_rows() const {
    std::uint32_t held = 0;
    for (std::uint32_t i = 0; i < protocol::max_clients; ++i) held += row(i).pid.load() != 0 ? 1 : 0;
    return held;
}

HeldClaim::HeldClaim(Answer answer)
    : terms(answer.claimed.value()),
      segment(std::move(answer.memory)),
      commands(segment.data() + protocol::claim_layout(terms.capacity).commands,
               protocol::claim_layout(terms.capacity).command_cells),
      sent(reinterpret_cast<shm::WaiterFlag*>(segment.data() +
                                              protocol::claim_layout(terms.capacity).waiter)) {}

void HeldClaim::send(protocol::CommandType type) {
    std::array<std::byte, shm::cell_bytes> cell{};
    protocol::CommandHeader header;
    header.cells = 1;
    header.type = type;
    header.number = ++issued;
    std::memcpy(cell.data(), &header, sizeof header);
    if (!commands.try_push(cell.data(), 1)) throw std::runtime_error("the command ring is full");
    sent.add();
}

}  // namespace knurl::test
