// `knurl device calibrate`: on the simulated devices it finds their own figures.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/json/json.hpp>
#include <knurl/servo/servo.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;
using testing::HasSubstr;

class Calibrated : public testing::TestWithParam<const char*> {};

TEST_P(Calibrated, FindsTheSimulatedDevicesOwnFigures) {
    const Outcome said = run({knurl_program(), "device", "calibrate", GetParam(), "--virtual", "--json"});
    ASSERT_EQ(said.code, 0) << said.err;
    const json found = json::parse(said.out);
    // drivers/README.md, "The simulated device".
    EXPECT_NEAR(found.at("mass").get<double>(), 0.1, 0.01) << "0.15 kg with the finger, which is not on it";
    EXPECT_NEAR(found.at("damping").get<double>(), 0.2, 0.02);
    EXPECT_NEAR(found.at("friction").get<double>(), 0.05, 0.005);
    const double lag = drivers::open_device(GetParam())->link().lag;
    EXPECT_NEAR(found.at("lag").get<double>(), lag, 0.1 * lag);
}

INSTANTIATE_TEST_SUITE_P(Simulated, Calibrated,
                         testing::Values("sim:cartesian3,grip=0", "sim:premium15,grip=0"),
                         [](const auto& name) { return std::string(name.param).substr(4, 6); });

TEST(Calibrate, WritesAFileFromWhichTheStiffnessOfWallsFollows) {
    const Folder folder;
    const std::string file = folder.path("mine.toml");
    const Outcome said = run({knurl_program(), "device", "calibrate", "sim:cartesian3,grip=0,damping=0.4",
                              "--virtual", "--write", file});
    ASSERT_EQ(said.code, 0) << said.err;
    const auto device = drivers::open_device("sim:cartesian3,grip=0,measured=" + file);
    EXPECT_NEAR(device->link().damping, 0.4, 0.04) << "not its own 0.2";
    EXPECT_NEAR(device->link().apparent_mass, 0.1, 0.01);
    EXPECT_THAT(device->link().description, HasSubstr("measured: " + file));
    const double stated = servo::max_stiffness(drivers::open_device("sim:cartesian3,grip=0")->link(), 1000);
    EXPECT_NEAR(servo::max_stiffness(device->link(), 1000), 2 * stated, 0.3 * stated);
}

TEST(Calibrate, AFileThatIsNoneIsRefusedInOneLine) {
    const Folder folder;
    const auto refusal = [&](const std::string& text) {
        const std::string file = folder.file("wrong.toml", text);
        return run({knurl_program(), "device", "test", "sim:cartesian3,measured=" + file, "--virtual"}).err;
    };
    EXPECT_THAT(refusal("mass = 1\n"), HasSubstr("it has no [measured]"));
    EXPECT_THAT(refusal("[measured]\nmas = 1\n"), HasSubstr("mas is not known"));
    EXPECT_THAT(refusal("[measured]\nmass = 150\n"), HasSubstr("mass is no number from 0.001 to 10"));
    EXPECT_THAT(refusal("[measured\n"), HasSubstr("wrong.toml: "));
    EXPECT_THAT(run({knurl_program(), "device", "test", "sim:cartesian3,measured=/none", "--virtual"}).err,
                HasSubstr("there is no such file"));
}

}  // namespace
}  // namespace knurl::test
