// IMD against a simulation in the test, with every possible fault.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fake_imd.hpp"
#include "imd.hpp"

namespace {

using namespace std::chrono_literals;
using dock::Imd;
using dock::ImdError;
using dock::ImdFrame;
using knurl::test::FakeImd;
using knurl::test::FakeImdOptions;
using testing::HasSubstr;

constexpr auto patience = 30s;

/// The next frame; empty: the connection has ended.
std::optional<ImdFrame> await(Imd& imd) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
        if (auto frame = imd.next()) return frame;
        if (imd.ended()) return {};
        imd.wait(100ms);
    }
    ADD_FAILURE() << "no frame";
    return {};
}

/// The error for a simulation with this fault, at whichever frame it occurs.
std::string complaint(FakeImdOptions fault) {
    fault.steps_per_second = 100'000;
    FakeImd simulation(fault);
    try {
        Imd imd(simulation.address(), fault.greets ? patience : 300ms);
        while (await(imd)) {
        }
        return imd.ended() ? "ended" : "nothing";
    } catch (const ImdError& error) {
        EXPECT_THAT(error.what(), HasSubstr(simulation.address())) << "it says who";
        return error.what();
    }
}

class ImdOrder : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Bytes, ImdOrder, testing::Bool(),
                         [](const auto& swapped) { return swapped.param ? "TheOther" : "ThisMachines"; });

TEST_P(ImdOrder, ReadsFramesAndPullsInTheServersByteOrder) {
    FakeImd simulation({.atoms = 5, .swapped = GetParam()});
    Imd imd(simulation.address(), patience);
    imd.set_rate(10);
    const auto first = await(imd);
    ASSERT_TRUE(first && first->energies);
    EXPECT_EQ(imd.swapped(), GetParam());
    ASSERT_EQ(first->atoms.size(), 5u);
    EXPECT_EQ(first->atoms[3], Eigen::Vector3f(6, 1, -1));
    EXPECT_EQ(first->energies->temperature, 300);
    EXPECT_EQ(first->energies->impropers, 7);

    imd.pull(3, {0, 2.5, -1});
    EXPECT_TRUE(simulation.eventually_pulled([](const FakeImd::Forces& forces) {
        const auto at = forces.find(3);
        return forces.size() == 1 && at != forces.end() && at->second == std::array<float, 3>{0, 2.5F, -1};
    }));
    EXPECT_EQ(simulation.rate(), 10);
    for (auto frame = first; frame && frame->atoms[3].y() < 1.2F;) frame = await(imd);
}

TEST(Imd, LetsGoAtItsEnd) {
    FakeImd simulation;
    {
        Imd imd(simulation.address(), patience);
        imd.pull(2, {5, 0, 0});
        ASSERT_TRUE(simulation.eventually_pulled([](const auto& forces) { return forces.contains(2); }));
    }
    ASSERT_TRUE(simulation.eventually_gone());
    EXPECT_TRUE(simulation.was_pulled());
    EXPECT_TRUE(simulation.eventually_pulled([](const FakeImd::Forces& forces) {
        return forces.size() == 1 && forces.begin()->second == std::array<float, 3>{};
    }));
    EXPECT_TRUE(simulation.said_goodbye());
}

TEST(Imd, LetsGoWhenWhatComesMakesNoSense) {
    FakeImd simulation({.steps_per_second = 1e5, .nonsense_at = 5});
    Imd imd(simulation.address(), patience);
    imd.pull(2, {5, 0, 0});
    EXPECT_THROW(while (await(imd)){}, ImdError);
    EXPECT_TRUE(imd.ended());
    EXPECT_TRUE(simulation.eventually_pulled(
        [](const FakeImd::Forces& forces) { return forces.size() == 1 && forces.contains(0); }));
}

TEST(Imd, SaysWhatIsWrongWithASimulation) {
    EXPECT_THAT(complaint({.version = 3}), HasSubstr("version 3"));
    EXPECT_THAT(complaint({.swapped = true, .version = 3}), HasSubstr("version 3"));
    EXPECT_THAT(complaint({.greets = false}), HasSubstr("sends nothing"));
    EXPECT_THAT(complaint({.handshake_bytes = 5}), HasSubstr("before IMD's handshake"));
    EXPECT_THAT(complaint({.handshake_bytes = 0}), HasSubstr("before IMD's handshake"));
    EXPECT_THAT(complaint({.cut_at = 3}), HasSubstr("within a message"));
    EXPECT_THAT(complaint({.more_atoms_at = 3}), HasSubstr("10 atoms, and there were 9"));
    EXPECT_THAT(complaint({.nan_at = 3}), HasSubstr("no number"));
    EXPECT_THAT(complaint({.nonsense_at = 3}), HasSubstr("type 77"));
    EXPECT_EQ(complaint({.close_at = 3}), "ended");
    EXPECT_EQ(complaint({.goodbye_at = 3}), "ended");
}

TEST(Imd, SaysWhatIsWrongWithAnAddress) {
    const auto says = [](const std::string& address) -> std::string {
        try {
            Imd imd(address, 200ms);
            return "connected";
        } catch (const ImdError& error) {
            return error.what();
        }
    };
    for (const char* address : {"localhost", ":8889", "localhost:", "localhost:http", "localhost:99999", ""})
        EXPECT_THAT(says(address), HasSubstr("HOST:PORT")) << address;
    int port = 0;
    std::string address;
    {
        FakeImd simulation;
        address = simulation.address();
        port = std::stoi(address.substr(address.rfind(':') + 1));
    }
    EXPECT_THAT(says(address), HasSubstr("-imdport " + std::to_string(port)));
}

}  // namespace
