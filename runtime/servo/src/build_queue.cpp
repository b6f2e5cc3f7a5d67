#include "build_queue.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fmt/format.h>
#include <sched.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <knurl/protocol/text.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "asset_answer.hpp"

extern char** environ;

namespace knurl::servo {

namespace {

struct SpawnSettings {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    SpawnSettings() {
        posix_spawn_file_actions_init(&actions);
        posix_spawnattr_init(&attributes);
    }
    ~SpawnSettings() {
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;
};

std::string refused(int error) {
    return fmt::format("asset: cannot start its builder ({}); see the limits of processes and memory",
                       std::strerror(error));
}

}  // namespace

BuildQueue::~BuildQueue() {
    end_process();
    reap(true);
}

void BuildQueue::start(Job job) {
    reap(false);
    const std::uint64_t owner = job.owner;
    queue_.push(owner, std::move(job));
    next();
}

void BuildQueue::next() {
    while (!running_ && !queue_.empty()) {
        const Job job = *queue_.pop();
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
            failed_.push_back(
                {.ticket = job.ticket, .asset = {}, .ready = {}, .digest = {}, .refusal = refused(errno)});
            continue;
        }
        shm::UniqueFd ours(ends[0]), theirs(ends[1]);
        const std::string budget = std::to_string(job.budget), bytes = std::to_string(job.bytes);
        const std::array<const char*, 5> arguments{program_.c_str(), build_asset_option, bytes.c_str(),
                                                   budget.c_str(), nullptr};
        SpawnSettings with;
        posix_spawn_file_actions_adddup2(&with.actions, job.source.get(), 0);
        posix_spawn_file_actions_adddup2(&with.actions, theirs.get(), 1);
        // The broker runs in real time; its children must not.
        const sched_param none{};
        posix_spawnattr_setschedparam(&with.attributes, &none);
        posix_spawnattr_setschedpolicy(&with.attributes, SCHED_IDLE);
        sigset_t unblocked;
        sigemptyset(&unblocked);
        posix_spawnattr_setsigmask(&with.attributes, &unblocked);
        posix_spawnattr_setflags(&with.attributes, POSIX_SPAWN_SETSCHEDULER | POSIX_SPAWN_SETSIGMASK);
        pid_t pid = 0;
        const int error = ::posix_spawn(&pid, program_.c_str(), &with.actions, &with.attributes,
                                        const_cast<char* const*>(arguments.data()), environ);
        if (error != 0) {
            failed_.push_back(
                {.ticket = job.ticket, .asset = {}, .ready = {}, .digest = {}, .refusal = refused(error)});
            continue;
        }
        ++builds_;
        running_ = Running{.ticket = job.ticket, .number = job.number, .pid = pid, .socket = std::move(ours)};
    }
}

void BuildQueue::end_process() noexcept {
    if (!running_) return;
    ::kill(running_->pid, SIGKILL);
    ending_.push_back(running_->pid);
    running_.reset();
    reap(false);
}

void BuildQueue::reap(bool wait) noexcept {
    std::erase_if(ending_, [&](pid_t pid) { return ::waitpid(pid, nullptr, wait ? 0 : WNOHANG) != 0; });
}

void BuildQueue::cancel(std::uint64_t ticket) noexcept {
    queue_.erase_if([&](const Job& job) { return job.ticket == ticket; });
    if (!running_ || running_->ticket != ticket) return;
    end_process();
    next();
}

std::optional<BuildQueue::Result> BuildQueue::collect() {
    if (!failed_.empty()) {
        Result result = std::move(failed_.front());
        failed_.pop_front();
        return result;
    }
    if (!running_) return std::nullopt;
    AssetAnswer answer;
    const shm::Received received =
        shm::receive_message(running_->socket, std::as_writable_bytes(std::span(&answer, 1)), shm::Block::no);
    if (received.nothing) return std::nullopt;
    Result result{.ticket = running_->ticket, .asset = {}, .ready = {}, .digest = {}, .refusal = {}};
    const std::uint32_t number = running_->number;
    end_process();  // its answer is complete
    next();
    if (received.closed || received.bytes != sizeof answer) {
        result.refusal =
            "asset: its builder died; this is a fault of Knurl's: please report it, with the shape";
    } else if (answer.refused != 0) {
        result.refusal = protocol::text_of(answer.text);
    } else {
        try {
            if (received.fds.size() != 1) throw std::runtime_error("its builder sent no memory");
            const auto memory = std::make_shared<shm::Segment>(
                shm::Segment::open_sealed(received.fds.front().get(), answer.block_bytes));
            const std::span<const std::byte> block(memory->data(), memory->size());
            auto asset = asset_of(block, memory);
            asset->materials.assign(answer.materials.begin(),
                                    answer.materials.begin() + answer.material_count);
            result.asset = std::move(asset);
            result.ready = answer.ready;
            result.ready.number = number;
            result.digest = answer.digest;
        } catch (const std::exception& error) {
            result.refusal =
                fmt::format("asset: no memory for it ({}); see the limits of memory", error.what());
        }
    }
    return result;
}

}  // namespace knurl::servo
