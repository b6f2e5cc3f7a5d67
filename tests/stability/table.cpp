#include "table.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include <knurl/json/json.hpp>

namespace stability {

const Row& Table::row(const std::string& name) const {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.name == name; });
    if (found == rows.end()) throw std::out_of_range(title + ": no row " + name);
    return *found;
}

double Table::at(const std::string& name, const std::string& column) const {
    const auto found = std::find(columns.begin(), columns.end(), column);
    if (found == columns.end()) throw std::out_of_range(title + ": no column " + column);
    return row(name).values.at(static_cast<std::size_t>(found - columns.begin())).value;
}

void fill(std::vector<Table>& tables, int jobs, const std::function<void(int, int)>& progress) {
    std::vector<Row*> all;
    for (Table& table : tables)
        for (Row& row : table.rows) all.push_back(&row);
    std::atomic<std::size_t> next = 0;
    int done = 0;
    std::mutex mutex;
    const auto work = [&] {
        for (std::size_t i = next++; i < all.size(); i = next++) {
            all[i]->values = all[i]->work();
            const std::lock_guard lock(mutex);
            ++done;
            if (progress) progress(done, static_cast<int>(all.size()));
        }
    };
    std::vector<std::thread> threads;
    for (int i = 1; i < jobs; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

std::string markdown(const Table& table) {
    std::string text = fmt::format("\n### {}\n\n|  |", table.title);
    for (const std::string& column : table.columns) text += " " + column + " |";
    text += "\n|---|";
    for (std::size_t i = 0; i < table.columns.size(); ++i) text += "---:|";
    for (const Row& row : table.rows) {
        text += "\n| " + row.name + " |";
        for (const Value& v : row.values) {
            const char* sign = v.kind == Value::Kind::at_least ? "> "
                               : v.kind == Value::Kind::below  ? "< "
                                                               : "";
            text += fmt::format(" {}{:.{}f} |", sign, v.value, table.digits);
        }
    }
    return text + "\n";
}

std::string json(const std::vector<Table>& tables, const Origin& origin) {
    auto out = knurl::Json::parse(knurl::measure::to_json({.machine = origin.machine, .results = {}}));
    out[origin.of] = origin.count;
    out["seconds"] = std::round(origin.seconds);
    for (const Table& table : tables) {
        knurl::Json rows = knurl::Json::array();
        for (const Row& row : table.rows) {
            std::vector<double> values;
            std::vector<int> kinds;  // 0 found, 1 at least, 2 below
            for (const Value& v : row.values)
                values.push_back(v.value), kinds.push_back(static_cast<int>(v.kind));
            rows.push_back({{"name", row.name}, {"x", row.x}, {"values", values}, {"kinds", kinds}});
        }
        out["tables"].push_back({{"key", table.key},
                                 {"title", table.title},
                                 {"unit", table.unit},
                                 {"columns", table.columns},
                                 {"rows", rows}});
    }
    return out.dump(1) + "\n";
}

}  // namespace stability
