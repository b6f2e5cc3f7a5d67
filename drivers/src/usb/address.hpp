#pragma once
// "FALCON01,firmware=nvent.bin,low_pass=200": the part of a USB driver's address after the scheme.

#include <string>
#include <string_view>
#include <vector>

#include "usb/session.hpp"

namespace knurl::drivers::usb {

class Address {
  public:
    /// `wanted` has the scheme, kind and ids. A first part without '=' is the serial number, port=1-1.2 the
    /// port. Throws std::runtime_error for a repeated option.
    Address(Wanted wanted, std::string_view what);

    const Wanted& wanted() const { return wanted_; }

    // Each removes its option. Throw std::runtime_error: the bad value, and the allowed ones.
    double number(std::string_view name, double otherwise, double least, double greatest,
                  std::string_view unit);
    bool flag(std::string_view name, bool otherwise);
    std::string text(std::string_view name);
    /// Throws if an unknown option is left.
    void done() const;

  private:
    struct Option {
        std::string name, value;
    };
    const std::string* take(std::string_view name);
    [[noreturn]] void fail(const std::string& why) const;

    Wanted wanted_;
    std::string what_;
    std::vector<Option> options_;
    std::vector<std::string> known_;
    std::string taken_;
};

}  // namespace knurl::drivers::usb
