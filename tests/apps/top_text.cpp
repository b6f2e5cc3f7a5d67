// What `knurl top` says, to the letter.

#include <gtest/gtest.h>
#include <json.hpp>
#include <top_text.hpp>

#include <knurl/protocol/text.hpp>

namespace knurl::test {
namespace {

using cli::DeviceRates;
using json = knurl::Json;

/// A device of which every figure is another one.
DeviceRates busy_device() {
    DeviceRates rates;
    protocol::put_text(rates.device.info.name, "left");
    protocol::put_text(rates.device.info.address, "sim:premium15");
    rates.device.info.rate = 1000;
    rates.device.info.peak_force = 8.5;
    rates.device.info.max_stiffness = 3105;
    rates.device.counters = {{"late_cycles", 12}, {"overruns", 2}};
    Report report{};
    report.state = DeviceState::fault;
    report.faults = 1U << 1 | 1U << 3;
    report.sent_force = {0, 3, 4};
    rates.device.report = report;
    rates.rate = 999.5;
    rates.late = 3;
    rates.parts = {1, 2, 3, 4, 5, 6, 7};
    rates.step = 28;
    rates.sleep = 972.5;
    rates.busy = 0.028;
    rates.late_median = 33.5;
    rates.late_max = 1700.25;

    cli::ClientRates holder;
    holder.client.pid = 4711;
    holder.client.name = "app";
    holder.client.age = 26.125e-3;
    holder.client.gain = 0.5;
    holder.client.merged = 12;
    holder.client.refused = 34;
    holder.client.missed = 56;
    holder.client.silent = true;
    holder.client.present = {2};
    holder.updates = 19.5;
    holder.merged = 1;
    holder.missed = 5;
    cli::ClientRates observer;
    observer.client.pid = 4712;
    observer.client.name = "plotter";
    observer.client.observer = true;
    observer.client.missed = 9;
    observer.missed = 8;
    rates.clients = {holder, observer};
    return rates;
}

TEST(TopText, SaysEveryFigureInItsPlace) {
    EXPECT_EQ(
        cli::text_of(busy_device()),
        "left (sim:premium15)  fault: slew, power  999.5 of 1000 Hz  force 5.00 of 8.5 N  k_max 3105 N/m\n"
        "    lateness  median 33.5 us  at most 1700.2 us  12 late cycles (+3)  2 overruns\n"
        "    cycle us  read 1.00  kinematics 2.00  take 3.00  scenes 4.00  supervise 5.00  write 6.00  "
        "publish 7.00"
        "  sleep 972.5  busy 28.00 (2.80 %)\n"
        "    pid 4711    app                      19.5 updates/s    26.125 ms old at use  12 merged (+1)  "
        "34 refused"
        "  56 missed (+5)  gain 0.50  SILENT  2 plane\n"
        "    pid 4712    plotter               observes  9 missed (+8)\n");
}

TEST(TopText, WhatIsNotKnownIsSaidToBeSo) {
    DeviceRates rates = busy_device();
    rates.parts.reset();
    rates.late_median.reset();
    rates.clients.resize(1);
    rates.clients[0].client.age = 0;
    const std::string text = cli::text_of(rates);
    EXPECT_EQ(text.find("cycle us"), std::string::npos) << text;
    EXPECT_EQ(text.find("median"), std::string::npos) << text;
    EXPECT_NE(text.find("lateness  at most"), std::string::npos) << text;
    EXPECT_NE(text.find("age unknown"), std::string::npos) << text;
    const json said = cli::json_of(rates);
    EXPECT_TRUE(said.at("parts_us").is_null());
    EXPECT_TRUE(said.at("lateness_median_us").is_null());
    EXPECT_TRUE(said.at("clients").at(0).at("age_at_use_us").is_null());
    rates.clients.clear();
    EXPECT_NE(cli::text_of(rates).find("nobody holds it"), std::string::npos);
}

TEST(TopText, JsonHasTheSameFigures) {
    const json expected = json::parse(R"({
        "name": "left", "address": "sim:premium15", "state": "fault", "faults": 10, "nominal_rate": 1000.0,
        "rate": 999.5, "force": 5.0, "late": 3, "overruns": 0, "lateness_median_us": 33.5,
        "lateness_max_us": 1700.25, "step_us": 28.0, "busy": 0.028,
        "parts_us": {"read": 1.0, "kinematics": 2.0, "take": 3.0, "scenes": 4.0, "supervise": 5.0,
                     "write": 6.0, "publish": 7.0, "sleep": 972.5},
        "clients": [
            {"pid": 4711, "name": "app", "role": "claim", "updates": 19.5, "age_at_use_us": 26125.0,
             "merged": 1, "refused": 0, "missed": 5, "merged_in_all": 12, "refused_in_all": 34,
             "missed_in_all": 56, "gain": 0.5, "silent": true},
            {"pid": 4712, "name": "plotter", "role": "observer", "updates": 0.0, "age_at_use_us": null,
             "merged": 0, "refused": 0, "missed": 8, "merged_in_all": 0, "refused_in_all": 0,
             "missed_in_all": 9, "gain": 0.0, "silent": false}]})");
    EXPECT_EQ(cli::json_of(busy_device()), expected) << cli::json_of(busy_device()).dump(2);
}

}  // namespace
}  // namespace knurl::test
