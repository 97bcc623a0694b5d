// One measurement of the modal benchmark: what is measured, what came out, and both as text.
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace ringdown::bench {

// "ours" is solve_modes() as it comes; "bake" is ringdown-bake with its default settings, mesh and all; the others are
// methods.h's.
struct Spec {
  std::string part;     // of the benchmark: plan.h
  std::string body;     // bodies.h
  std::string mesh;     // cells "16x14x10", or gmsh's longest edge in mm "12"; "default" for "bake"
  std::string element;  // fem::element_name
  std::string method;
  int threads = 1;
  double top_hz = 0;  // modes up to here
  int expected = 0;   // how many those are, rigid motions too: told to the peers, who must be asked for a number

  [[nodiscard]] std::string key() const;  // the same for the same measurement; a file name
  // Of the same modes on the same mesh, by another method.
  [[nodiscard]] Spec by(const std::string& other_method, int with_threads = 1) const;
};

enum class Status { kDone, kNotInstalled, kOverLimit, kFailed };

struct Measurement {
  Spec spec;
  Status status = Status::kFailed;
  std::string complaint;         // why it failed
  long unknowns = 0, modes = 0;  // elastic modes up to the top
  double seconds = 0;            // from a mesh in memory to modes in memory; CalculiX: its whole run
  double assemble_s = 0, factor_s = 0, iterate_s = 0, processor_s = 0;
  double peak_mib = 0;
  double error_10 = -1, error_50 = -1;  // [%] worst of the first 10 and 50 against exact values; -1: none known
  double difference = -1;  // worst relative one of its frequencies from ours on the same mesh; ccx: see ccx-mass
  double ratio = -1;       // seconds over those of ours with one thread
};

// The measuring process tells the other one: lines "name value".
std::string to_lines(const Measurement& measurement);
Result<Measurement> from_lines(const std::string& text, const Spec& spec);

// By key().
using Measurements = std::map<std::string, Measurement>;
const Measurement* find(const Measurements& all, const Spec& spec);

// Differences and ratios, from what was measured and the frequencies that lie in `folder`.
void compare(Measurements& all, const std::filesystem::path& folder);

// Rows in the order given, those that exist, each with the machine's name. Atomic.
Result<void> write_csv(const std::filesystem::path& path, const std::vector<Spec>& order, const Measurements& all,
                       const std::string& machine);

// Frequencies [Hz] of one measurement, one to a line, ascending.
Result<void> write_frequencies(const std::filesystem::path& path, const std::vector<double>& hz);
std::vector<double> read_frequencies(const std::filesystem::path& path);  // empty when there is no such file

// Worst of |a / b - 1| over the first `count`, -1 when either is shorter.
double worst_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t count);

}  // namespace ringdown::bench
