// The JSON that programs write and tests read.

#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include <knurl/json/json.hpp>

namespace knurl::test {
namespace {

TEST(Json, IsWrittenInTheOrderInWhichItsKeysCame) {
    Json json = {
        {"b", 1}, {"a", {1, 2.5, "x", nullptr, true}}, {"c", {{"d", Json::array()}, {"e", Json::object()}}}};
    json["n"] = std::uint64_t{18446744073709551615u};
    EXPECT_EQ(json.dump(),
              R"({"b":1,"a":[1,2.5,"x",null,true],"c":{"d":[],"e":{}},"n":18446744073709551615})");
    EXPECT_EQ(Json::parse(json.dump(2)), json);
    EXPECT_EQ(Json(std::map<std::string, int>{{"x", -1}}).dump(1), "{\n \"x\": -1\n}");
    EXPECT_EQ(Json("\xff").dump(), "\"\xef\xbf\xbd\"") << "what is no UTF-8 is replaced";
}

TEST(Json, SaysWhatIsMissingOrOfAnotherType) {
    const Json json = Json::parse(R"({"list": [1, 2], "name": "x"})");
    const auto said = [](const auto& use) {
        try {
            use();
        } catch (const JsonError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(said([&] { json.at("nome"); }), "key 'nome' is missing");
    EXPECT_EQ(said([&] { json.at("list").at(2); }), "element 2 is missing of 2");
    EXPECT_EQ(said([&] { json.at("name").get<double>(); }), "is text where a number is wanted");
    EXPECT_NE(said([&] { Json::parse(R"({"a": })"); }).find("column 7"), std::string::npos);
    EXPECT_EQ(json.at("list").get<std::vector<double>>(), (std::vector<double>{1, 2}));
    EXPECT_EQ(json.value("nome", 3), 3);
}

/// A program that reads a file must not run out of stack, whatever the file holds.
TEST(Json, RefusesWhatNestsTooDeep) {
    const auto nested = [](std::size_t levels) {
        return std::string(levels, '[') + std::string(levels, ']');
    };
    EXPECT_EQ(Json::parse(nested(100)).size(), 1u);
    for (const std::size_t levels : {std::size_t{300}, std::size_t{1'000'000}}) try {
            Json::parse(nested(levels));
            ADD_FAILURE() << levels;
        } catch (const JsonError& error) {
            EXPECT_STREQ(error.what(), "it nests deeper than 256 arrays and objects");
        }
}

TEST(Json, EqualsWhatHasTheSameValueWhateverItsTypeAndOrder) {
    EXPECT_EQ(Json(1), 1.0);
    EXPECT_EQ(Json(1u), 1);
    EXPECT_NE(Json(1), "1");
    EXPECT_LT(Json(-1), Json(std::uint64_t{18446744073709551615u}));
    EXPECT_GT(Json(2.5), 2);
    EXPECT_FALSE(Json("x") > 2);
    EXPECT_EQ(Json::parse(R"({"a": 1, "b": [2]})"), Json::parse(R"({"b": [2], "a": 1})"));
    EXPECT_NE(Json::parse(R"({"a": 1, "b": 2})"), Json::parse(R"({"a": 1, "c": 2})"));
}

TEST(Json, ACopyIsNotTouchedByWhatBecomesOfTheOther) {
    Json one = {{"list", {1}}};
    const Json copy = one;
    one["list"].push_back(2);
    EXPECT_EQ(copy.dump(), R"({"list":[1]})");
    EXPECT_EQ(one.dump(), R"({"list":[1,2]})");
    one.erase("list");
    EXPECT_TRUE(one.empty());
}

}  // namespace
}  // namespace knurl::test
