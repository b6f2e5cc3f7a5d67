#pragma once
// A servo with a knurl-dds, in a domain of this test's own on loopback.

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/dds/domain.hpp>
#include <knurl/dds/registry.hpp>

#include "../apps/program.hpp"
#include "../client/servo_process.hpp"

namespace dds_test {

using namespace std::chrono_literals;
using knurl::test::Background;
using knurl::test::eventually;

/// Tests run beside each other. Domains above 100 have ports that the system gives to others.
inline std::uint32_t own_domain() {
    return 1 + static_cast<std::uint32_t>(::getpid()) % 99;
}

/// A knurl-dds, which has said that it runs. It ends with this object.
class DdsProgram {
  public:
    explicit DdsProgram(std::vector<std::string> more = {}, std::uint32_t domain = own_domain()) {
        std::vector<std::string> words{KNURL_DDS, "--domain", std::to_string(domain)};
        words.insert(words.end(), more.begin(), more.end());
        program_.emplace(words);
        if (!program_->says("in domain")) throw std::runtime_error("knurl-dds: " + program_->said());
    }
    Background& program() { return *program_; }
    void end(int signal) {
        program_->end(signal);
        program_.reset();
    }

  private:
    std::optional<Background> program_;
};

/// A process of the domain that may be killed: see peer.cpp.
inline std::unique_ptr<Background> peer(std::vector<std::string> words) {
    words.insert(words.begin(), {KNURL_DDS_PEER, std::to_string(own_domain())});
    return std::make_unique<Background>(words);
}

/// This test in the domain.
struct Here {
    knurl::dds::Domain domain{{.id = own_domain(), .peers = {}, .log = [](const std::string&) {}}};
};

/// A servo of another host, as far as the domain knows: announced until this ends.
class Announced {
  public:
    Announced(Here& here, knurl::dds::ServoEntry entry) : registry(here.domain), entry_(std::move(entry)) {
        thread_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                {
                    const std::scoped_lock lock(mutex_);
                    registry.announce(entry_);
                }
                std::this_thread::sleep_for(50ms);  // the rate at which it says that it is there
            }
        });
    }
    template <class Change>
    void change(Change change) {
        const std::scoped_lock lock(mutex_);
        change(entry_);
    }
    knurl::dds::Registry registry;

  private:
    std::mutex mutex_;
    knurl::dds::ServoEntry entry_;
    std::jthread thread_;
};

/// The next sample of a reader that is as wanted.
template <class T, class Wanted>
bool comes(const knurl::dds::Entity& reader, Wanted wanted) {
    return eventually([&] {
        const knurl::dds::Taken<T> taken(reader.get());
        for (std::size_t i = 0; i < taken.size(); ++i)
            if (taken.info(i).valid_data && wanted(taken[i])) return true;
        return false;
    });
}

}  // namespace dds_test
