// The exact text of `knurl top`.

#include <gtest/gtest.h>
#include <top_text.hpp>

#include <knurl/json/json.hpp>
#include <knurl/protocol/text.hpp>

namespace knurl::test {
namespace {

using cli::DeviceRates;
using json = knurl::Json;

/// A device whose figures all differ.
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
    holder.client.scales.contacts = 0.25;
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
        "left (sim:premium15)  \1fault: slew, power\2  999.5 of 1000 Hz  force 5.00 of 8.5 N  k_max 3105 "
        "N/m\n"
        "    lateness  median 33.5 us  at most 1700.2 us  \1"
        "12 late cycles (+3)\2  2 overruns\n"
        "    cycle us  read 1.00  kinematics 2.00  take 3.00  scenes 4.00  supervise 5.00  write 6.00  "
        "publish 7.00"
        "  sleep 972.5  busy 28.00 (2.80 %)\n"
        "    pid 4711    app                      19.5 updates/s    26.125 ms old at use  12 merged (+1)  "
        "34 refused"
        "  \1"
        "56 missed (+5)\2  gain 0.50  surfaces x0.25  \1SILENT\2  2 plane\n"
        "    pid 4712    plotter               observes  \1"
        "9 missed (+8)\2\n");
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
    EXPECT_TRUE(said.at("parts_s").is_null());
    EXPECT_TRUE(said.at("late_p50_s").is_null());
    EXPECT_TRUE(said.at("clients").at(0).at("age_at_use_s").is_null());
    rates.clients.clear();
    EXPECT_NE(cli::text_of(rates).find("nobody holds it"), std::string::npos);
}

TEST(TopText, JsonHasTheSameFigures) {
    const json expected = json::parse(R"({
        "name": "left", "address": "sim:premium15", "state": "fault", "faults": 10, "rate": 1000.0,
        "measured_rate": 999.5, "force": 5.0, "late_cycles_now": 3, "overruns_now": 0, "late_p50_s": 33.5e-6,
        "late_max_s": 1700.25e-6, "step_s": 28e-6, "busy": 0.028,
        "parts_s": {"read": 1e-6, "kinematics": 2e-6, "take": 3e-6, "scenes": 4e-6, "supervise": 5e-6,
                    "write": 6e-6, "publish": 7e-6, "sleep": 972.5e-6},
        "clients": [
            {"pid": 4711, "name": "app", "role": "claim", "update_rate": 19.5, "age_at_use_s": 26.125e-3,
             "updates_merged_now": 1, "updates_refused_now": 0, "reports_missed_now": 5, "updates_merged": 12,
             "updates_refused": 34, "reports_missed": 56, "gain": 0.5,
             "scales": {"surfaces": 0.25, "effects": 1.0, "damping": 1.0}, "silent": true, "shed": false},
            {"pid": 4712, "name": "plotter", "role": "observer", "update_rate": 0.0, "age_at_use_s": null,
             "updates_merged_now": 0, "updates_refused_now": 0, "reports_missed_now": 8, "updates_merged": 0,
             "updates_refused": 0, "reports_missed": 9, "gain": 0.0,
             "scales": {"surfaces": 1.0, "effects": 1.0, "damping": 1.0}, "silent": false, "shed": false}]})");
    EXPECT_EQ(cli::json_of(busy_device()), expected) << cli::json_of(busy_device()).dump(2);
}

}  // namespace
}  // namespace knurl::test
