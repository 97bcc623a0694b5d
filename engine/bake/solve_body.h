// Finds the modes of a meshed body, or takes them from the cache. [worker]
#pragma once

#include "engine/bake/bake_options.h"
#include "engine/bake/body_modes.h"
#include "engine/bake/fitted_makeup.h"
#include "engine/base/progress.h"
#include "engine/mesh/boundary.h"

#include <chrono>
#include <optional>
#include <string>
#include <utility>

namespace ringdown::bake {

class Stopwatch {
 public:
  // Seconds since the last call, or since construction.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// The input of a bake, once its mesh has the element's order.
struct Task {
  mesh::TetMesh mesh;
  mesh::TetMesh unit_mesh;  // in units of units.length_m
  mesh::Boundary surface;
  BodyUnits units;
  const modal::Material& material;
  const BakeOptions& options;
  const std::string& name;
  FittedMakeup makeup;
  std::optional<WetPlan> wet;  // with options.liquids
};

// Returns the modes of the body up to `top`, free of units, and stores them in the cache if they were not there. With
// options.interior the body is solved even if the cache has its modes, because the cache keeps the surface alone.
Result<BodyModes> find_body_modes(const Task& task, double top, BakeReport& report, const Progress& progress);

}  // namespace ringdown::bake
