#pragma once

/// @file
/// Scenes as data: a TOML file with one table per representation, whose keys are the names of its parameters'
/// fields. Examples, tests and `knurl eval` share such files.
///
///     [[probe]]                      # probe 0, then 1, ...
///     radius = 0.005                 # m
///
///     [[plane]]
///     id = "floor"
///     normal = [0, 0, 1]
///     stiffness = 800                # N/m
///
///     [[plane]]                      # the same id, later: an update
///     id = "floor"
///     at = 0.5                       # s
///     offset = 0.003                 # m

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/triangles.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/reps/probe.hpp>
#include <knurl/reps/scene.hpp>

namespace knurl::scenefile {

/// What a scene file gets wrong: one line, "file:line:column: what; what to do".
class SceneError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// One entry of the file, resolved: parameters are complete and valid.
struct Change {
    /// What a change does.
    enum class Type {
        /// Adds a representation.
        add,
        /// Gives it new parameters.
        update,
        /// Removes it.
        remove,
    };

    /// When (s).
    double at = 0;
    /// What it does.
    Type type = Type::add;
    /// Which representation: 0, 1, ... in the order in which they are added.
    std::uint32_t item = 0;
    /// Its kind.
    Kind kind = 0;
    /// How it is used.
    AddOptions options;
    /// Its parameters, kinds()[kind].size bytes; of a removal, those that it had, but for a recovery that the
    /// removal states.
    std::vector<std::byte> params;
    /// Its id as in the file, or made up from kind and line.
    std::string id;
    /// Line of the file.
    std::uint32_t line = 0;
};

/// A surface of which shapes are made, in one of three forms: a file, triangles, or heights. The entry is
/// only read here: the program that plays the scene reads a mesh file and builds the asset.
struct AssetEntry {
    /// Line of the file.
    std::uint32_t line = 0;
    /// First form: path of a mesh file, relative to the folder of the scene file.
    std::string mesh;
    /// Of a mesh file: unit of its numbers, "mm".
    std::string unit;
    /// Of a mesh file: a closed part that is wound inside out stays so.
    bool inside = false;
    /// Second form: vertices (m).
    std::vector<Point3> vertices;
    /// Their triangles.
    std::vector<Triangle> triangles;
    /// Of the first and second form: corners as double.
    bool exact = false;
    /// Third form: heights (m), row by row.
    std::vector<float> heights;
    /// Their grid.
    HeightGrid grid;
};

/// A scene file, read.
struct SceneFile {
    /// Path of the file.
    std::string path;
    /// Assets 1, 2, ...
    std::vector<AssetEntry> assets;
    /// Placements of probes 0, 1, ...; the others are at the tip, with radius 0.
    std::vector<ProbePlacement> probes;
    /// Changes in order of time, then of the file.
    std::vector<Change> changes;
    /// Number of representations that are ever added.
    std::uint32_t items = 0;
    /// "file:line:column: ..." of what is legal and looks like a mistake.
    std::vector<std::string> remarks;
};

/// A key that a table takes besides the fields of its representation.
struct KeyInfo {
    /// Name of the key.
    std::string_view name;
    /// Which values it takes.
    std::string_view value;
    /// What it means.
    std::string_view meaning;
};
/// Keys of every representation's table (`material`: of surfaces alone).
std::span<const KeyInfo> entry_keys() noexcept;
/// Keys of [[asset]].
std::span<const KeyInfo> asset_keys() noexcept;

/// Reads the whole file or throws SceneError at the first thing wrong: nothing is half-applied.
///
/// A removal fades over the recovery that the representation had, or that the removal states.
/// An update inherits what it does not state from the entry before it, but for `recovery` (every field that
/// is `of_change`): that one describes the change itself, and absent it is its default. `probe`, `on_silence`
/// and `silence_time` are fixed when a representation is added. A removed id may be used again.
SceneFile read_scene(const std::string& path);

/// The same from memory; `path` is what errors name.
SceneFile parse_scene(std::string_view text, const std::string& path);

/// What one representation's table states, outside of a file: for those who have tables of another format, and shall
/// read the same keys in the same way.
struct Stated {
    /// Its id; empty: it has none.
    std::string id;
    /// How it is used; none: the table does not say so.
    std::optional<AddOptions> options;
    /// Its parameters, complete and valid.
    std::vector<std::byte> params;
};

/// Reads the keys of a [[table]] of that kind, as TOML without the table's head: "id = \"floor\"\nstiffness = 800\n".
/// `before`: parameters that it changes, of which it inherits what it does not state, as an update does; empty: the
/// defaults. Throws SceneError, one line without a place.
Stated read_stated(Kind kind, std::string_view keys, std::span<const std::byte> before = {});

}  // namespace knurl::scenefile
