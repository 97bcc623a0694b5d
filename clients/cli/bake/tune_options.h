// The command line of ringdown-tune. [main thread]
#pragma once

#include "engine/bake/tuning/tune_object.h"

#include <string>
#include <vector>

namespace ringdown::manual {
class App;
}

namespace ringdown::cli {

// A target as the command line gives it: in Hz, as a multiple of the first target, or as the note of a scale.
struct AskedTarget {
  bake::ModeFamily family = bake::ModeFamily::kVertical;
  int mode = 1;
  enum class Kind { kHertz, kMultiple, kNote } kind = Kind::kHertz;
  double value = 0;  // Hz, or the multiple
};

struct TuneArguments {
  std::filesystem::path input, output, materials;
  std::vector<bake::TuneVariable> variables;
  std::vector<AskedTarget> targets;
  std::map<std::string, double> settings;  // parameters that are fixed, with other values than the object's
  std::optional<Vec3> strike;
  std::optional<double> mesh_size_m;
  double tolerance_cents = 0.3;
  bool is_scale = false;
  int lowest_note = 0, highest_note = 0;
  bool quiet = false, no_cache = false;
};

// Options whose text is not parsed yet.
struct TuneWords {
  std::vector<std::string> vary, targets, settings;
  std::string scale;
  std::vector<double> strike;
};

void add_tune_options(manual::App& app, TuneArguments& arguments, TuneWords& words);

// Parses the words. Fails with what is wrong and the right way to write it.
Result<void> read_words(const TuneWords& words, TuneArguments& arguments);

// The targets in hertz. `note_hz` replaces the note of a scale.
std::vector<bake::TuneTarget> targets_at(const TuneArguments& arguments, double note_hz);

}  // namespace ringdown::cli
