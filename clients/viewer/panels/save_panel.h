// Two buttons with which the daemon writes a file: the sound, as WAV, and the scene in its present state. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/link/model.h"
#include "clients/viewer/panels/skin.h"

#include <array>
#include <string>

namespace ringdown::viewer {

class SavePanel {
 public:
  void draw(const Skin& skin, const Model& model, Commands& commands);

 private:
  using Name = std::array<char, 256>;
  void draw_capture(const Skin& skin, const Model& model, Commands& commands);
  void draw_scene(const Model& model, Commands& commands);
  void draw_outcome(const Skin& skin, const Model& model);

  Name sound_{}, scene_{};
  bool replace_ = false;
  // The file being captured; its length, as last reported, is extrapolated between the daemon's reports.
  std::string capture_;
  double reported_s_ = -1, reported_at_s_ = 0;
};

}  // namespace ringdown::viewer
