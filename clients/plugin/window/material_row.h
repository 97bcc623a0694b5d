// The object's material: a list of all materials, each of which sets Stiffness, Density and Loss in one step. [UI]
#pragma once

#include "clients/plugin/window/edits.h"
#include "clients/plugin/window/shown_body.h"
#include "engine/modal/bank.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::plugin {

// The values of the three parameters that give an object of one material the sound of another.
struct MaterialFactors {
  double stiffness = 1, density = 1, loss = 1;
  std::string obstacle;  // one sentence on why the material cannot be chosen; empty: it can
};
// Loss is one factor for all parts of the damping: that of the material's own at 1 kHz.
MaterialFactors factors_of(const modal::Material& bank, const modal::Material& wanted);

class MaterialRow {
 public:
  // `folder` is the catalogue's.
  explicit MaterialRow(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // Draws one line of ImGui's present window. A note map has objects of several materials, so none is offered.
  void draw(const ShownBody& body, Edits& edits);

 private:
  void choose(const modal::Material& bank, Edits& edits);

  const std::filesystem::path folder_;
  std::optional<std::vector<modal::Material>> known_;  // read at first use
};

}  // namespace ringdown::plugin
