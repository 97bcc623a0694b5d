// Tunes an object: finds the parameters of its geometry, or the level of its liquid, at which chosen modes have chosen
// frequencies. [worker]
//
//   TuneRequest request{.recipe = *read_object("bar.toml")};
//   request.variables = {{"length", 250, 400}, {"arch_depth", 2, 10}};
//   request.targets = {{.mode = 1, .frequency_hz = 440}, {.mode = 2, .frequency_hz = 1760}};
//   Result<TunedObject> tuned = tune_object(request, "presets/materials");
//
// Every evaluation is a bake of the band that the targets lie in. First elements of order 2 come near, then the
// object's own elements with the same slopes; then, while the estimated error of a tuned mode is a cent or more, finer
// ones. A mesh that keeps its topology while the parameters move (Transfinite, Layers) makes frequencies smooth in
// them; others work too, as long as the mesh is fine enough for the error.
//
// A variable named kLevelVariable is the level of [fill] in metres before scale, and the only one then. One bake with
// levels is searched (modal/levels/level_bank.h), and one or two bakes confirm the level on the object's own mesh.
#pragma once

#include "engine/bake/object_file.h"
#include "engine/bake/tuning/mode_family.h"
#include "engine/bake/tuning/tune.h"
#include "engine/modal/bank.h"

#include <memory>

namespace ringdown::bake {

inline constexpr std::string_view kLevelVariable = "fill.level";
inline constexpr double kMaxErrorCents = 1;  // estimated, of a tuned mode's frequency
inline constexpr int kMaxRefinements = 5;

struct TuneTarget {
  ModeFamily family = ModeFamily::kVertical;
  int mode = 1;  // in its family; 1 is the lowest
  double frequency_hz = 0;
};

struct FoundMode {
  double frequency_hz = 0;
  double cents = 0;        // off its target
  double error_cents = 0;  // estimated
};

struct TuneStep {
  int number = 0;
  std::string_view stage;  // "coarse", "fine", "finer"; "level"
  const std::map<std::string, double>& parameters;
  const std::vector<FoundMode>& found;
};

struct TuneRequest {
  ObjectRecipe recipe;                  // with a mesh size
  std::vector<TuneVariable> variables;  // a start outside its bounds is brought inside
  std::vector<TuneTarget> targets;
  std::optional<Vec3> strike;  // see body_axes()
  double tolerance_cents = 0.3;
  Eigen::MatrixXd slopes;  // of a relative tuned before, TunedObject::slopes: begins with the object's own elements
  std::shared_ptr<const modal::Bank> levels;                    // of the same object tuned before, TunedObject::levels
  std::function<void(const TuneStep&)> told;                    // after each evaluation
  std::function<bool(std::string_view, double)> progress = {};  // inside one; false stops

  [[nodiscard]] bool varies_level() const;
};

struct TunedObject {
  std::map<std::string, double> parameters;   // the tuned ones, to six digits
  std::vector<FoundMode> found;               // one for each target
  double mesh_size_m = 0;                     // at which that holds
  Eigen::MatrixXd slopes;                     // targets x variables
  std::shared_ptr<const modal::Bank> levels;  // of the liquid, if its level was varied
  int bakes = 0;
  bool reached =
      false;  // within tolerance, and every estimated error below kMaxErrorCents, unless the level was varied
};

// Fails when the object has no mesh size or cannot be baked, when a target's mode is not there at the start, when the
// level is varied of an object without [fill], with [bath] or together with its geometry, or outside of the basin, or
// with ErrorKind::cancelled.
Result<TunedObject> tune_object(const TuneRequest& request, const std::filesystem::path& materials);

}  // namespace ringdown::bake
