#include "cases.hpp"

#include <stdexcept>

#include "servo_stroke.hpp"
#include "stroke.hpp"

namespace stability {
namespace {

Value as_value(const Search::Found& found) {
    if (found.stiffness == 0) return {Search::lowest, Value::Kind::below};
    return {found.stiffness, found.at_top ? Value::Kind::at_least : Value::Kind::found};
}

Run on_bench(const Conditions& c) {
    return [c](double stiffness, unsigned seed, unsigned criteria) {
        return stroke(c, stiffness, seed, criteria);
    };
}

}  // namespace

const std::vector<NamedMethod>& methods() {
    using enum knurl::PlaneUpdate;
    constexpr auto force = Method::Kind::force, cap = Method::Kind::cap;
    static const std::vector<NamedMethod> all = {
        {way::force, {.kind = force}},
        {way::planes, {}},
        {"paper's recovery, 10 ms", {.recovery = 0.01, .update = paper}},
        {way::paper, {.recovery = 0.05, .update = paper}},
        {"last depth kept, 50 ms", {.recovery = 0.05, .update = last_depth}},
        {way::faded, {.recovery = knurl::automatic}},
        {"cross-faded, 50 ms", {.recovery = 0.05}},
        {"predicted", {.predicted = true}},
        {way::usual, {.predicted = true, .recovery = knurl::automatic}},
        {way::cap, {.kind = cap, .predicted = true, .recovery = knurl::automatic}},
        {"planes, passivity control", {.passivity = true}},
        {"default, passivity control", {.predicted = true, .recovery = knurl::automatic, .passivity = true}},
        {"planes, slew limit 100 N/s", {.slew = 100}},
    };
    return all;
}

const Method& method(const std::string& name) {
    for (const NamedMethod& m : methods())
        if (name == m.name) return m.method;
    throw std::out_of_range("no method " + name);
}

Conditions at_rest(Conditions c) {
    c.ridge = flat_wall;
    c.speed = 0;
    return c;
}

Conditions with(Conditions c, const Method& method) {
    c.method = method;
    return c;
}

Value largest(const Conditions& c, Seeds seeds, unsigned criteria) {
    return as_value(Search(on_bench(c), seeds, criteria).largest(criteria));
}

Value largest_on(const std::string& profile, const Conditions& c, Seeds seeds) {
    const Run run = [&](double stiffness, unsigned seed, unsigned criteria) {
        return servo_stroke(profile, c, stiffness, seed, criteria);
    };
    return as_value(Search(run, seeds, strict).largest(strict));
}

std::vector<Value> largest_of_each(const Conditions& c, Seeds seeds, const std::vector<unsigned>& criteria) {
    Search search(on_bench(c), seeds, every);
    std::vector<Value> values;
    for (const unsigned which : criteria) values.push_back(as_value(search.largest(which)));
    return values;
}

}  // namespace stability
