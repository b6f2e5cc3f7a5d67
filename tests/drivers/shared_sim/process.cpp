#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "shared_sim.hpp"

extern char** environ;

namespace knurl::drivers::shared_sim {

Mapping::Mapping(const std::string& path) {
    const int fd = open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (fd < 0) {
        throw std::runtime_error(path + ": " + std::strerror(errno) + "; start knurl-fake-device " + path);
    }
    struct stat info = {};
    fstat(fd, &info);
    size_ = static_cast<std::size_t>(info.st_size);
    void* memory = size_ >= sizeof(Shared) ? mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0)
                                           : MAP_FAILED;
    close(fd);
    shared_ = static_cast<Shared*>(memory);
    if (memory == MAP_FAILED || shared_->magic_number != magic || file_size(shared_->capacity) != size_) {
        if (memory != MAP_FAILED) {
            munmap(memory, size_);
        }
        throw std::runtime_error(path + " is not the file of a knurl-fake-device");
    }
}

Mapping::~Mapping() {
    munmap(shared_, size_);
}

std::vector<Record> read_log(const Mapping& mapping) {
    const std::uint64_t count = mapping->records.load(std::memory_order_acquire);
    const Record* first = log_of(&*mapping);
    return {first, first + count};
}

std::string file_in_memory(const std::string& name, std::uint64_t capacity) {
    std::error_code none;
    const std::filesystem::path memory = "/dev/shm";
    // Writing to a full disk ends a process by SIGBUS. Half of the file: no test fills its log further.
    const bool there = access(memory.c_str(), W_OK) == 0 &&
                       std::filesystem::space(memory, none).available >= file_size(capacity) / 2 && !none;
    return ((there ? memory : std::filesystem::temp_directory_path()) /
            (name + "-" + std::to_string(getpid())))
        .string();
}

FakeDevice::FakeDevice(const std::string& program, const Settings& settings) : settings_(settings) {
    std::vector<std::string> words = {program,       settings.path,
                                      "--profile",   settings.profile,
                                      "--period-us", std::to_string(settings.period.count()),
                                      "--capacity",  std::to_string(settings.capacity)};
    if (!settings.hand_file.empty()) {
        words.insert(words.end(), {"--hand", settings.hand_file});
    }
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    unlink(settings.path.c_str());
    const int error = posix_spawn(&pid_, program.c_str(), nullptr, nullptr, arguments.data(), environ);
    if (error != 0) {
        throw std::runtime_error(program + ": " + std::strerror(error));
    }
    // The file appears complete (by rename) once the device runs.
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (access(settings.path.c_str(), F_OK) != 0) {
        if (waitpid(pid_, nullptr, WNOHANG) == pid_ || std::chrono::steady_clock::now() > give_up) {
            throw std::runtime_error(program + " did not come up with " + settings.path);
        }
        std::this_thread::yield();
    }
    mapping_ = std::make_unique<Mapping>(settings.path);
}

FakeDevice::~FakeDevice() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
}

bool FakeDevice::wait_steps(std::uint64_t steps) const {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    const std::uint64_t until = (*mapping_)->steps.load(std::memory_order_acquire) + steps;
    while ((*mapping_)->steps.load(std::memory_order_acquire) < until) {
        if (std::chrono::steady_clock::now() > give_up) {
            return false;
        }
        std::this_thread::yield();
    }
    return true;
}

}  // namespace knurl::drivers::shared_sim
