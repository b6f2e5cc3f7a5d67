#pragma once
// What drives one device through its maker's library, in a process of its own.

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <knurl/drivers/driver_process.hpp>

namespace knurl::device {

/// From the command line.
struct Arguments {
    std::string scheme;
    unsigned lane = 0;
    int priority = 0;
    std::string library;                     // path of the maker's
    std::string name;                        // serial number, index or name; empty: the first device
    std::string serial;                      // this very device again
    std::map<std::string, double> settings;  // --set NAME=VALUE

    double setting(const std::string& name, double otherwise) const {
        const auto found = settings.find(name);
        return found == settings.end() ? otherwise : found->second;
    }
};

/// The device is gone, or refuses: one line for people. The process ends.
class Gone : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// One device, opened in the constructor, at zero and closed after the destructor.
class Backend {
  public:
    virtual ~Backend() = default;
    /// What it is.
    virtual drivers::process::Description description() const = 0;
    /// Moves samples and orders until exchange.leaving(). Throws Gone.
    virtual void run(drivers::process::Exchange& exchange) = 0;
};

/// A device that the library sees, for `knurl devices`.
struct Seen {
    std::string name, serial;
    std::string problem;  // why it cannot be used; empty: nothing is known against it
};
/// What a library says of itself without opening a device.
struct Survey {
    std::string version;  // "3.17.1"
    std::vector<Seen> devices;
};

/// Throws std::runtime_error: what is wrong, what to do.
std::unique_ptr<Backend> open_dhd(const Arguments& arguments);
std::unique_ptr<Backend> open_hd(const Arguments& arguments);
Survey survey_dhd(const std::string& library);
Survey survey_hd(const std::string& library);

}  // namespace knurl::device
