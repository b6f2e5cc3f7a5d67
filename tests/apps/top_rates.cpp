// The rates that `knurl top` computes from two observations of a servo.

#include <gtest/gtest.h>

#include <knurl/view/rates.hpp>

namespace knurl::test {
namespace {

using view::ClientView;
using view::DeviceView;

DeviceView device(std::map<std::string, std::uint64_t> counters, std::vector<ClientView> clients = {}) {
    DeviceView view;
    view.info.rate = 1000;
    view.counters = std::move(counters);
    view.clients = std::move(clients);
    return view;
}

ClientView client(std::uint32_t row, pid_t pid) {
    ClientView view;
    view.row = row;
    view.pid = pid;
    return view;
}

TEST(TopRates, AreDifferencesPerSecond) {
    const auto rates =
        view::rates_between(device({{"cycles", 1000}, {"late_cycles", 3}, {"overruns", 1}}),
                            device({{"cycles", 1500}, {"late_cycles", 5}, {"overruns", 1}}), 0.5, {});
    EXPECT_EQ(rates.rate, 1000);
    EXPECT_EQ(rates.late, 2u);
    EXPECT_EQ(rates.overruns, 0u);
    EXPECT_FALSE(rates.parts) << "no cycle was stamped";
    EXPECT_FALSE(rates.late_median) << "no report was seen";
}

TEST(TopRates, PartsAreMeansOfTheStampedCycles) {
    const auto rates = view::rates_between(
        device({{"stamped_cycles", 10}, {"read_ns", 5000}, {"scenes_ns", 100'000}}),
        device({{"stamped_cycles", 18}, {"read_ns", 13'000}, {"scenes_ns", 132'000}}), 0.5, {});
    ASSERT_TRUE(rates.parts);
    EXPECT_EQ((*rates.parts)[0], 1) << "us";
    EXPECT_EQ((*rates.parts)[3], 4);
    EXPECT_EQ(rates.step, 5);
    EXPECT_DOUBLE_EQ(rates.busy, 0.005);
    EXPECT_EQ(rates.sleep, 0) << "it did not move";
}

TEST(TopRates, TheRestOfThePeriodIsSleep) {
    const auto rates =
        view::rates_between(device({{"cycles", 100}, {"stamped_cycles", 1}}),
                            device({{"cycles", 600}, {"stamped_cycles", 5}, {"write_ns", 24'000}}), 0.5, {});
    EXPECT_EQ(rates.step, 6);
    EXPECT_EQ(rates.sleep, 994);
}

TEST(TopRates, ALookThatIsTooShortForAStampKeepsThePartsOfTheOneBefore) {
    const auto start = device({{"stamped_cycles", 1}}),
               later = device({{"stamped_cycles", 5}, {"take_ns", 8000}});
    const auto first = view::rates_between(start, later, 0.5, {});
    auto second = view::rates_between(later, later, 0.05, {});
    ASSERT_FALSE(second.parts);
    view::keep_parts(first, second);
    ASSERT_TRUE(second.parts);
    EXPECT_EQ((*second.parts)[2], 2);
    EXPECT_EQ(second.step, 2);
    auto third = view::rates_between(start, device({{"stamped_cycles", 2}, {"take_ns", 3000}}), 0.5, {});
    view::keep_parts(second, third);
    EXPECT_EQ((*third.parts)[2], 3) << "it has its own";
}

TEST(TopRates, LatenessIsOfTheReportsThatWereSeen) {
    std::vector<Report> seen(41);
    for (std::size_t i = 0; i < seen.size(); ++i)
        seen[i].read_ns = static_cast<std::int64_t>(10'000 * (i + 1));
    const auto rates = view::rates_between(device({}), device({}), 1, seen);
    EXPECT_EQ(rates.late_median, 210);
    EXPECT_EQ(rates.late_max, 410);
    seen.resize(5);
    const auto few = view::rates_between(device({}), device({}), 1, seen);
    EXPECT_FALSE(few.late_median) << "too few";
    EXPECT_EQ(few.late_max, 50);
}

TEST(TopRates, ClientsAreFoundAgainByTheirRow) {
    ClientView first = client(0, 7), second = client(1, 7);
    first.commits = 100;
    second.commits = 1000;
    ClientView first_now = first, second_now = second, newcomer = client(2, 9);
    first_now.commits = 110;
    second_now.commits = 1500;
    second_now.merged = 4;
    second.missed = 7;
    second_now.missed = 10;
    newcomer.commits = 30;
    const auto rates = view::rates_between(device({}, {first, second}),
                                           device({}, {first_now, second_now, newcomer}), 0.5, {});
    ASSERT_EQ(rates.clients.size(), 3u);
    EXPECT_EQ(rates.clients[0].updates, 20);
    EXPECT_EQ(rates.clients[1].updates, 1000);
    EXPECT_EQ(rates.clients[1].merged, 4u);
    EXPECT_EQ(rates.clients[1].missed, 3u);
    EXPECT_EQ(rates.clients[2].updates, 0) << "nothing is known of it before";
}

TEST(TopRates, CountersOfAnotherServoMakeNoNegativeRates) {
    EXPECT_EQ(view::rates_between(device({{"cycles", 5000}}), device({{"cycles", 10}}), 1, {}).rate, 0);
}

}  // namespace
}  // namespace knurl::test
