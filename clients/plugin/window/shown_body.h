// The object that the window shows, read from the file that the plug-in plays. The plug-in and its window may run in
// two processes, so the window reads the file itself. [UI]
#pragma once

#include "clients/plugin/key_map.h"
#include "clients/plugin/sources.h"
#include "clients/viewer/render/drawn_mesh.h"
#include "engine/base/result.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::plugin {

struct ShownBody {
  std::string source, material;
  bool is_note_map = false;
  std::size_t key = 0;  // the note map's key that strikes the object; of a single bank the one that was asked for
  std::shared_ptr<ringdown_bank> bank;
  Body body;
  viewer::DrawnMesh mesh;
  std::vector<double> frequencies_hz, decays_per_s;  // M, in the order of the bank

  // Returns a mode's shape, for the renderer.
  [[nodiscard]] viewer::Displacement displacement(std::size_t mode) const;
};

// Reads the object that a key strikes; in a note map the object of the nearest key that strikes one.
Result<ShownBody> read_body(const Source& source, std::size_t key);

}  // namespace ringdown::plugin
