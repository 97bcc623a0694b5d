// The list of objects: the file, the user's own files, and the presets by families, with a field to search. [UI]
#pragma once

#include "clients/plugin/window/edits.h"

#include <array>

namespace ringdown::plugin {

class Browser {
 public:
  // Draws into ImGui's present window.
  void draw(Edits& edits, HostLink& host);

 private:
  std::array<char, 64> search_{};
};

}  // namespace ringdown::plugin
