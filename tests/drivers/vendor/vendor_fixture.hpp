#pragma once
// A device behind knurl-device and a counterfeit library, with the test as its servo.

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/drivers/registry.hpp>

#include "../../eventually.hpp"
#include "vendor_bench.hpp"

namespace knurl::drivers {

using counterfeit::Fault;
using testing::HasSubstr;

inline std::string refusal(const std::string& address) {
    try {
        open_device(address);
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
        return error.what();
    }
    return "";
}

class Vendor : public testing::Test {
  protected:
    counterfeit::Bench bench_;
    std::unique_ptr<Device> device_;
    JointSample sample_;
    ReadStatus status_ = ReadStatus::stale;
    int bad_ = 0, resting_ = 0;

    void open_at(const std::string& address) { device_ = open_device(address); }
    void cycle(const JointEfforts& efforts = {}) {
        status_ = device_->read(0, sample_);
        bad_ += status_ == ReadStatus::bad ? 1 : 0;
        device_->write(0, efforts);
    }
    /// As a servo: after a bad sample zero for a while, as its fault has it. (Here the loop is not real-time, and may be
    /// late for the device's watchdog.)
    void careful_cycle(const JointEfforts& efforts) {
        cycle(resting_ > 0 ? JointEfforts{} : efforts);
        resting_ = status_ == ReadStatus::bad ? 150 : std::max(0, resting_ - 1);
    }
    /// Cycles a millisecond long until it is so.
    template <class So>
    bool until(const JointEfforts& efforts, So so) {
        return test::eventually([&] {
            cycle(efforts);
            return so();
        });
    }
    bool comes(const JointEfforts& efforts = {}) {
        return until(efforts, [&] { return status_ == ReadStatus::ok && sample_.calibrated; });
    }
    bool pushes(double newtons = 2) {
        return comes() && gives({newtons}, [&] {
                   return bench_.device().share_of(0, counterfeit::now_ns()) == newtons;
               });
    }
    template <class So>
    bool gives(const JointEfforts& efforts, So so) {
        return test::eventually([&] {
            careful_cycle(efforts);
            return so();
        });
    }
};

}  // namespace knurl::drivers
