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
  // Draws one line of the current window. Each choice is one undoable change.
  void draw(const KnownObject& object, Commands& commands);

 private:
  std::optional<std::vector<modal::Material>> known_;  // read at first use
};

}  // namespace ringdown::viewer
