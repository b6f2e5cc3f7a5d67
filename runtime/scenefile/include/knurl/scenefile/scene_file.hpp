#pragma once
// Scenes as data: a TOML file with one table per representation, whose keys are the names of its parameters'
// fields. Examples, tests and `knurl eval` share such files.
//
//     [[probe]]                      # probe 0, then 1, ...
//     radius = 0.005                 # m
//
//     [[plane]]
//     id = "floor"
//     normal = [0, 0, 1]
//     stiffness = 800                # N/m
//
//     [[plane]]                      # the same id, later: an update
//     id = "floor"
//     at = 0.5                       # s
//     offset = 0.003                 # m

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/triangles.hpp>
#include <knurl/reps/all.hpp>
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
    enum class Type { add, update, remove };

    double at = 0;  // s
    Type type = Type::add;
    std::uint32_t item = 0;  // which representation: 0, 1, ... in the order in which they are added
    Kind kind = 0;
    AddOptions options;
    // kinds()[kind].size bytes; of a removal, those it had, but for a recovery that the removal states
    std::vector<std::byte> params;
    std::string id;  // as in the file, or made up from kind and line
    std::uint32_t line = 0;
};

/// A surface that shapes are made of, in one of three forms. Only read: whoever plays the scene builds it,
/// and reads a file.
struct AssetEntry {
    std::uint32_t line = 0;
    std::string mesh;              // a file, seen from the folder of the scene file
    std::string unit;              //   of its numbers: "mm"
    bool inside = false;           //   a closed part that is wound inside out stays so
    std::vector<Point3> vertices;  // or these; m
    std::vector<Triangle> triangles;
    bool exact = false;          // of both
    std::vector<float> heights;  // or these; m
    HeightGrid grid;
};

struct SceneFile {
    std::string path;
    std::vector<AssetEntry> assets;      // 1, 2, ...
    std::vector<ProbePlacement> probes;  // of probes 0, 1, ...; the rest sit at the tip, with no radius
    std::vector<Change> changes;         // in order of time, then of the file
    std::uint32_t items = 0;             // representations that are ever added
    std::vector<std::string> remarks;    // "file:line:column: ...", of what is legal and looks like a mistake
};

/// A key that a table takes besides the fields of its representation.
struct KeyInfo {
    std::string_view name;
    std::string_view value;  // what it takes
    std::string_view meaning;
};
/// Of every representation's table (`material`: of surfaces alone), and of [[asset]].
std::span<const KeyInfo> entry_keys() noexcept;
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

}  // namespace knurl::scenefile
