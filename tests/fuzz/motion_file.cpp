// Any bytes as a motion: refused in one line, or a motion that is finite at all times, and that stays the
// same when it is written and read again.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

#include <knurl/drivers/motion.hpp>

#include "refusal.hpp"

using namespace knurl;
using fuzz::require;

namespace {

std::string written(const drivers::Motion& motion) {
    std::string text;
    const auto put = [&text](double number, char end) {
        char digits[32];
        std::snprintf(digits, sizeof digits, "%.17g%c", number, end);
        text += digits;
    };
    for (const drivers::MotionRow& row : motion.rows()) {
        put(row.t, ',');
        put(row.position.x(), ',');
        put(row.position.y(), ',');
        put(row.position.z(), motion.has_orientation() ? ',' : '\n');
        if (!motion.has_orientation()) continue;
        put(row.orientation.w(), ',');
        put(row.orientation.x(), ',');
        put(row.orientation.y(), ',');
        put(row.orientation.z(), '\n');
    }
    return text;
}

void check_sample(const drivers::MotionSample& sample) {
    require(sample.position.allFinite() && sample.velocity.allFinite() && sample.angular_velocity.allFinite(),
            "a sample is finite");
    require(std::fabs(sample.orientation.norm() - 1) < 1e-9, "an orientation has length 1");
}

void check_again(const drivers::Motion& motion) {
    const drivers::Motion again = drivers::parse_motion(written(motion), "again.csv");
    require(
        again.rows().size() == motion.rows().size() && again.has_orientation() == motion.has_orientation(),
        "it reads what it writes");
    for (std::size_t i = 0; i < again.rows().size(); ++i) {
        const drivers::MotionRow &was = motion.rows()[i], &is = again.rows()[i];
        require(was.t == is.t && was.position == is.position, "a row is the same");
        require((was.orientation.coeffs() - is.orientation.coeffs()).norm() < 1e-14,
                "an orientation is the same");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const drivers::Motion motion =
            drivers::parse_motion({reinterpret_cast<const char*>(data), size}, "m.csv");
        double before = -std::numeric_limits<double>::infinity();
        std::size_t hint = 0;
        for (const drivers::MotionRow& row : motion.rows()) {
            require(row.t > before && std::isfinite(row.t), "times increase");
            if (std::isfinite(before)) check_sample(motion.sample(before / 2 + row.t / 2, hint));
            check_sample(motion.sample(row.t, hint));
            before = row.t;
        }
        for (const double t : {-std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::max()})
            check_sample(motion.sample(t));
        if (const auto doubt = drivers::unit_doubt(motion)) fuzz::check_refusal(*doubt, "");
        check_again(motion);
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "m.csv:");
    }
    return 0;
}
