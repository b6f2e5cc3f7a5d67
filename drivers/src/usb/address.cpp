#include "usb/address.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <stdexcept>

#include <knurl/words/nearest.hpp>

namespace knurl::drivers::usb {

Address::Address(Wanted wanted, std::string_view what) : wanted_(std::move(wanted)), what_(what) {
    for (std::size_t at = 0; at < what.size();) {
        const std::size_t end = std::min(what.find(',', at), what.size());
        std::string_view item = what.substr(at, end - at);
        if (const std::size_t query = item.find('?'); at == 0 && query != std::string_view::npos) {
            if (item.substr(query) != "?wait")
                fail("after ? there is only wait: the device is waited for if it is absent");
            wanted_.wait = true;
            item = item.substr(0, query);
            if (item.empty()) {
                at = end + 1;
                continue;
            }
        }
        const std::size_t equals = item.find('=');
        if (equals == std::string_view::npos && at == 0) {
            wanted_.serial = item;
        } else if (equals == std::string_view::npos) {
            fail(std::string(item) + " is no option; write NAME=VALUE");
        } else {
            const std::string name(item.substr(0, equals));
            if (std::ranges::find(options_, name, &Option::name) != options_.end())
                fail(name + " is there twice");
            options_.push_back({name, std::string(item.substr(equals + 1))});
        }
        at = end + 1;
    }
    wanted_.port = text("port");
}

void Address::fail(const std::string& why) const {
    throw std::runtime_error(wanted_.scheme + ":" + what_ + ": " + why);
}

const std::string* Address::take(std::string_view name) {
    known_.emplace_back(name);
    const auto found = std::ranges::find(options_, name, &Option::name);
    if (found == options_.end()) return nullptr;
    taken_ = found->value;
    options_.erase(found);
    return &taken_;
}

double Address::number(std::string_view name, double otherwise, double least, double greatest,
                       std::string_view unit) {
    const std::string* value = take(name);
    if (value == nullptr) return otherwise;
    double parsed = 0;
    const char* last = value->data() + value->size();
    const auto [end, error] = std::from_chars(value->data(), last, parsed);
    if (value->empty() || error != std::errc() || end != last || !(parsed >= least && parsed <= greatest)) {
        std::ostringstream why;
        why << "cannot use " << name << "=" << *value << "; give " << least << " to " << greatest << ' '
            << unit;
        fail(why.str());
    }
    return parsed;
}

bool Address::flag(std::string_view name, bool otherwise) {
    const std::string* value = take(name);
    if (value == nullptr) return otherwise;
    if (*value != "on" && *value != "off")
        fail(std::string("cannot use ") + std::string(name) + "=" + *value + "; give on or off");
    return *value == "on";
}

std::string Address::text(std::string_view name) {
    const std::string* value = take(name);
    if (value == nullptr) return "";
    if (value->empty()) fail(std::string(name) + "= is empty");
    return *value;
}

void Address::done() const {
    if (options_.empty()) return;
    std::string known;
    for (const std::string& name : known_) known += (known.empty() ? "" : ", ") + name;
    fail(std::string("no option ") + options_.front().name + "; there are " + known +
         words::meant(options_.front().name, known_));
}

}  // namespace knurl::drivers::usb
