// Chooses the material of an object among those of the catalogue. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/link/known_objects.h"
#include "engine/modal/bank.h"

#include <optional>
#include <vector>

namespace ringdown::viewer {

class MaterialPicker {
 public:
  // One line of the current window. A choice is one change, which can be undone.
  void draw(const KnownObject& object, Commands& commands);

 private:
  std::optional<std::vector<modal::Material>> known_;  // read when they are first needed
};

}  // namespace ringdown::viewer
