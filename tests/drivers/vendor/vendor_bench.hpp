#pragma once
// The counterfeit hardware of a test, and the environment by which knurl-device finds the counterfeit library.

#include <cstdlib>
#include <filesystem>
#include <string>

#include "../../temp_folder.hpp"
#include "control.hpp"

namespace knurl::counterfeit {

class Bench {
  public:
    Bench() : mapping_((folder_ / "hardware").string(), true) {
        setenv("KNURL_COUNTERFEIT", (folder_ / "hardware").c_str(), 1);
        setenv("KNURL_DEVICE_PROGRAM", KNURL_DEVICE_PROGRAM_FILE, 1);
        setenv("KNURL_LIBDHD", KNURL_COUNTERFEIT_DHD, 1);
        setenv("KNURL_LIBHD", KNURL_COUNTERFEIT_HD, 1);
    }
    Control* operator->() const { return &*mapping_; }
    Device& device(std::size_t i = 0) const { return mapping_->device.at(i); }
    std::filesystem::path folder() const { return folder_.path(); }

  private:
    test::TempFolder folder_;
    Mapping mapping_;
};

}  // namespace knurl::counterfeit
