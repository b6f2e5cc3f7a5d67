#pragma once
// The output of knurl-surface: the printed table, and the files from which the picture is drawn.

#include <filesystem>
#include <string>
#include <vector>

#include <knurl/measure/measure.hpp>

#include "judge.hpp"
#include "recording.hpp"

namespace surface {

/// One way's stroke, recorded and judged.
struct Outcome {
    Recording recording;
    std::vector<Terrain::Foot> feet = {};  // the true surface's, of each recorded cycle
    Judgement judgement = {};
    std::vector<double> ages = {};  // s, of the updates at their first use
};

Outcome judged(Recording recording, const Terrain& terrain, const Span& span);

/// The part of the run that all its strokes share.
struct RunText {
    std::string model = {};   // the file's name
    std::string scale = {};   // Relief::statement
    std::string device = {};  // "premium15 (sim:premium15)"
    knurl::measure::Machine machine = {};
    double servo_rate = 0;  // Hz
    double rate = 0;        // Hz, of the application
    double think = 0;       // s
};

std::string machine_sentence(const knurl::measure::Machine& machine);

/// For a wide terminal: 33 columns, and 19 for each way.
std::string table(const std::vector<Outcome>& outcomes, const RunText& text);

// Each throws std::runtime_error if its file cannot be written.
void write_json(const std::filesystem::path& file, const std::vector<Outcome>& outcomes, const RunText& text);
/// One row per cycle:
///   way,t,x,y,z,vx,vy,vz,fx,fy,fz,true_fx,true_fy,true_fz,sent_fx,sent_fy,sent_fz,surface_z,height,faults
/// (true_f: of the true surface; sent_f: of what was sent, nan where that is not known; surface_z: the true
/// surface's height right below the probe; height: the probe's signed distance from it.)
void write_csv(const std::filesystem::path& file, const std::vector<Outcome>& outcomes,
               const Terrain& terrain);
/// The felt surface at the samples, in mm, as an ESRI ASCII grid with cells in mm.
void write_relief(const std::filesystem::path& file, const Terrain& terrain);

/// p-quantile (nearest rank) of an unsorted sample; 0 of an empty one.
double quantile(std::vector<double> values, double p);

}  // namespace surface
