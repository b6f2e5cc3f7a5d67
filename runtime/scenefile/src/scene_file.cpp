#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include <knurl/reps/all.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/toml.hpp>

#include "entry.hpp"

namespace knurl::scenefile {

namespace {

template <class R>
std::vector<std::byte> bytes_of_default() {
    const R params{};
    std::vector<std::byte> bytes(sizeof params);
    std::memcpy(bytes.data(), &params, sizeof params);
    return bytes;
}

template <class... R>
std::vector<std::byte> default_params(Kind kind, TypeList<R...>) {
    std::vector<std::byte> (*const makers[])() = {&bytes_of_default<R>...};
    return makers[kind]();
}

/// An update does not inherit fields that describe a change rather than the thing; they get their defaults.
void reset_what_describes_a_change(Kind kind, std::vector<std::byte>& params) {
    const auto defaults = default_params(kind, Representations{});
    for (const Field& field : kinds()[kind].fields) {
        if (field.of_change)
            std::memcpy(params.data() + field.offset, defaults.data() + field.offset, field.bytes());
    }
}

[[noreturn]] void fail_unknown_table(const std::string& path, std::string_view name,
                                     const toml::source_position& where) {
    std::vector<std::string_view> known{"probe", "asset"};
    for (const KindInfo& info : kinds()) known.push_back(info.name);
    std::string all;
    for (const auto word : known) all += (all.empty() ? "[[" : ", [[") + std::string(word) + "]]";
    const auto meant = words::nearest(name, known);
    fail(path, where,
         fmt::format("unknown table '{}'; {}", name,
                     meant.empty() ? "a scene has " + all : fmt::format("did you mean [[{}]]?", meant)));
}

/// The tables of a [[name]]; fails if it has another form.
std::vector<const toml::table*> tables_of(const std::string& path, const toml::key& name,
                                          const toml::node& node) {
    std::vector<const toml::table*> tables;
    const auto* array = node.as_array();
    bool whole = array != nullptr;
    for (std::size_t i = 0; whole && i < array->size(); ++i) {
        tables.push_back((*array)[i].as_table());
        whole = tables.back() != nullptr;
    }
    if (!whole) {
        fail(path, name.source().begin,
             fmt::format("'{}' must be a list of tables; write [[{}]] above its keys", name.str(),
                         name.str()));
    }
    return tables;
}

bool changes_options(const Entry& entry, const AddOptions& options) {
    return entry.probe.value_or(options.probe) != options.probe ||
           entry.on_silence.value_or(options.on_silence) != options.on_silence ||
           entry.silence_time.value_or(options.silence_time) != options.silence_time;
}

/// Turns entries, sorted by time, into adds, updates and removals.
class Resolver {
  public:
    explicit Resolver(SceneFile& scene) : scene_(scene) {}

    void take(const Entry& entry) {
        const auto [place, fresh] = newest_.try_emplace(entry.id);
        if (!fresh && place->second.change.at == entry.at) {
            fail(scene_.path, entry.where,
                 fmt::format(
                     "{} has two entries at {} s (the other in line {}); give one of them another 'at' or id",
                     entry.called, entry.at, place->second.change.line));
        }
        if (fresh) place->second.present = false;
        Newest& newest = place->second;
        if (entry.remove) {
            remove(entry, newest);
        } else if (newest.present) {
            update(entry, newest);
        } else {
            add(entry, newest);
        }
    }

  private:
    struct Newest {
        Change change;
        bool present = false;
    };

    void add(const Entry& entry, Newest& newest) {
        Change change;
        change.at = entry.at;
        change.item = scene_.items++;
        change.kind = entry.kind;
        change.options = options_of(entry);
        change.params = default_params(entry.kind, Representations{});
        apply(scene_.path, entry, change.params);
        keep(entry, std::move(change), newest, true);
    }

    void update(const Entry& entry, Newest& newest) {
        check_kind(entry, newest);
        if (changes_options(entry, newest.change.options)) {
            fail(scene_.path, entry.options_at,
                 fmt::format(
                     "probe, on_silence and silence_time of {} were fixed in line {}; remove it and add it "
                     "again to change them",
                     entry.called, newest.change.line));
        }
        Change change = newest.change;
        change.type = Change::Type::update;
        change.at = entry.at;
        reset_what_describes_a_change(entry.kind, change.params);
        apply(scene_.path, entry, change.params);
        keep(entry, std::move(change), newest, true);
    }

    void remove(const Entry& entry, Newest& newest) {
        if (!newest.present) {
            fail(scene_.path, entry.where,
                 fmt::format("{} is removed at {} s, but nothing of that id is there then", entry.called,
                             entry.at));
        }
        check_kind(entry, newest);
        Change change = newest.change;
        change.type = Change::Type::remove;
        change.at = entry.at;
        apply(scene_.path, entry, change.params);
        keep(entry, std::move(change), newest, false);
    }

    void check_kind(const Entry& entry, const Newest& newest) const {
        if (entry.kind == newest.change.kind) return;
        fail(scene_.path, entry.where,
             fmt::format("{} is a {} since line {}; an update must be of the same kind", entry.called,
                         kinds()[newest.change.kind].name, newest.change.line));
    }

    /// A shape must refer to an asset of the scene.
    void check_asset(const Entry& entry, const Change& change) const {
        if (change.kind != kind_of<Shape>) return;
        Shape shape;
        std::memcpy(&shape, change.params.data(), sizeof shape);
        if (shape.asset <= scene_.assets.size()) return;
        fail(
            scene_.path, entry.where,
            fmt::format("{} is made of asset {}, but the scene has {}; they are numbered from 1 in the order "
                        "of their [[asset]]",
                        entry.called, shape.asset, scene_.assets.size()));
    }

    void keep(const Entry& entry, Change change, Newest& newest, bool present) {
        check_asset(entry, change);
        change.id = entry.id;
        change.line = entry.where.line;
        newest.change = change;
        newest.present = present;
        scene_.changes.push_back(std::move(change));
    }

    SceneFile& scene_;
    std::map<std::string, Newest> newest_;
};

toml::table parse_toml(std::string_view text, const std::string& path) {
    try {
        return words::parse_toml(text, path);
    } catch (const words::TomlError& error) {
        throw SceneError(error.what());
    }
}

void add_probe(SceneFile& scene, const toml::table& table) {
    if (scene.probes.size() == Scene::max_probes) {
        fail(scene.path, table.source().begin,
             fmt::format("too many probes; a scene has at most {}", Scene::max_probes));
    }
    scene.probes.push_back(read_probe(scene.path, scene.probes.size(), table));
}

void add_asset(SceneFile& scene, const toml::table& table) {
    if (scene.assets.size() == max_assets) {
        fail(scene.path, table.source().begin,
             fmt::format("too many assets; a scene has at most {}", max_assets));
    }
    scene.assets.push_back(read_asset(scene.path, scene.assets.size() + 1, table));
}

Kind kind_named(const toml::key& name, const std::string& path) {
    Kind kind = 0;
    while (kind < kinds().size() && kinds()[kind].name != name.str()) ++kind;
    if (kind == kinds().size()) fail_unknown_table(path, name.str(), name.source().begin);
    return kind;
}

/// Reads a [[name]]. Probes and assets belong to the scene; entries are not yet sorted by time.
void read_tables(const toml::key& name, const toml::node& node, SceneFile& scene,
                 std::vector<Entry>& entries) {
    if (name.str() == "probe") {
        for (const auto* table : tables_of(scene.path, name, node)) add_probe(scene, *table);
    } else if (name.str() == "asset") {
        for (const auto* table : tables_of(scene.path, name, node)) add_asset(scene, *table);
    } else {
        const Kind kind = kind_named(name, scene.path);
        for (const auto* table : tables_of(scene.path, name, node))
            entries.push_back(read_entry(scene.path, kind, *table));
    }
}

}  // namespace

SceneFile parse_scene(std::string_view text, const std::string& path) {
    const toml::table root = parse_toml(text, path);
    SceneFile scene;
    scene.path = path;
    std::vector<Entry> entries;
    for (const auto& [name, node] : root) read_tables(name, node, scene, entries);
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.at, a.where.line, a.where.column) < std::tie(b.at, b.where.line, b.where.column);
    });
    Resolver resolver(scene);
    for (const Entry& entry : entries) {
        resolver.take(entry);
        doubt_units(path, entry, scene.remarks);
    }
    return scene;
}

Stated read_stated(Kind kind, std::string_view keys, std::span<const std::byte> before) {
    const std::string nowhere = "-";
    try {
        const toml::table table = parse_toml(keys, nowhere);
        for (const char* of_files : {"at", "remove"})
            if (const auto* node = table.get(of_files))
                fail(nowhere, node->source().begin,
                     fmt::format("'{}' is a key of scene files alone", of_files));
        const Entry entry = read_entry(nowhere, kind, table);
        Stated stated;
        if (table.contains("id")) stated.id = entry.id;
        if (entry.probe || entry.on_silence || entry.silence_time) stated.options = options_of(entry);
        stated.params = default_params(kind, Representations{});
        if (!before.empty()) {
            stated.params.assign(before.begin(), before.end());
            reset_what_describes_a_change(kind, stated.params);
        }
        apply(nowhere, entry, stated.params);
        return stated;
    } catch (const SceneError& error) {
        // "-:line:column: what": the place is one in our own text.
        std::string_view what = error.what();
        for (int colons = 0; colons < 3; ++colons)
            what.remove_prefix(std::min(what.find(':') + 1, what.size()));
        while (what.starts_with(' ')) what.remove_prefix(1);
        throw SceneError(std::string(what));
    }
}

SceneFile read_scene(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    if (!file || !(text << file.rdbuf())) {
        // An empty file also sets the failbit, and is a scene without content.
        if (!file.is_open() || file.bad() || file.peek() != std::ifstream::traits_type::eof()) {
            throw SceneError(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
        }
    }
    return parse_scene(text.str(), path);
}

}  // namespace knurl::scenefile
