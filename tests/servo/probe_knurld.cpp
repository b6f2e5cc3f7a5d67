// knurld with one more driver: "probe:FILE" is sim:premium15 that keeps a ProbeRecord in FILE.

#include <ctime>
#include <memory>
#include <stdexcept>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/servo/daemon.hpp>
#include <knurl/shm/fd.hpp>

#include "probe_device.hpp"

namespace {

using namespace knurl;

class ProbeDevice final : public drivers::Device {
  public:
    ProbeDevice(std::unique_ptr<drivers::Device> inner, test::ProbeRecord& record)
        : inner_(std::move(inner)), record_(record) {}

    const drivers::LinkConfig& link() const noexcept override { return inner_->link(); }
    const drivers::Mechanism& mechanism() const noexcept override { return inner_->mechanism(); }
    drivers::ReadStatus read(drivers::Nanoseconds now, drivers::JointSample& sample) noexcept override {
        while (record_.hang.load() != 0) usleep(1000);  // looks starved to the guardian
        return inner_->read(now, sample);
    }
    bool write(drivers::Nanoseconds now, const drivers::JointEfforts& efforts) noexcept override {
        record_.writes.fetch_add(1);
        return inner_->write(now, efforts);
    }
    void notify(drivers::Notice notice) noexcept override { inner_->notify(notice); }
    void make_safe() noexcept override {
        record_.writes_at_zeroing.store(record_.writes.load());
        timespec now{};
        clock_gettime(CLOCK_MONOTONIC, &now);
        record_.zeroing_ns.store(static_cast<std::uint64_t>(now.tv_sec * 1'000'000'000 + now.tv_nsec));
        record_.zeroing_pid.store(static_cast<std::uint64_t>(getpid()));
        record_.zeroings.fetch_add(1);
    }

  private:
    std::unique_ptr<drivers::Device> inner_;
    test::ProbeRecord& record_;
};

std::unique_ptr<drivers::Device> open_probe(std::string_view path, const drivers::OpenOptions& options) {
    const shm::UniqueFd fd(open(std::string(path).c_str(), O_RDWR | O_CLOEXEC));
    void* memory = mmap(nullptr, sizeof(test::ProbeRecord), PROT_READ | PROT_WRITE, MAP_SHARED, fd.get(), 0);
    if (memory == MAP_FAILED) throw std::runtime_error("probe: cannot map " + std::string(path));
    return std::make_unique<ProbeDevice>(drivers::open_device("sim:premium15", options),
                                         *static_cast<test::ProbeRecord*>(memory));
}

}  // namespace

int main(int argc, char** argv) {
    drivers::drivers().push_back({"probe", "FILE", open_probe});
    return servo::knurld_main(argc, argv);
}
