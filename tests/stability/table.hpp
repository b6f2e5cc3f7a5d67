#pragma once
// The sweep's output: tables of figures, each row made by one job; jobs run on a few threads.

#include <functional>
#include <string>
#include <vector>

#include <knurl/measure/measure.hpp>

namespace stability {

struct Value {
    double value = 0;
    enum class Kind { found, at_least, below } kind = Kind::found;
};

struct Row {
    std::string name;
    double x = 0;  // for plots, where the row is a point on an axis
    std::function<std::vector<Value>()> work;
    std::vector<Value> values;
};

struct Table {
    std::string key, title, unit;  // unit of all figures
    int digits = 0;                // behind the point
    std::vector<std::string> columns;
    std::vector<Row> rows;

    const Row& row(const std::string& name) const;
    double at(const std::string& name, const std::string& column) const;
};

/// All rows of all tables, on `jobs` threads. `progress` (may be null) is called for each finished row.
void fill(std::vector<Table>& tables, int jobs, const std::function<void(int done, int all)>& progress);

/// As Markdown.
std::string markdown(const Table& table);
/// The origin of the figures.
struct Origin {
    knurl::measure::Machine machine;
    std::string of;      // "seeds" or "phases"
    unsigned count = 0;  // of them
    double seconds = 0;
};
/// As JSON, in the form of all measuring programs: {"machine", ..., of: count, "seconds", "tables": [{key,
/// title, unit, columns, rows: [{name, x, values, kinds}]}]}
std::string json(const std::vector<Table>& tables, const Origin& origin);

}  // namespace stability
