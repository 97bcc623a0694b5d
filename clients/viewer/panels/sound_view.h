// The sound pane: meters, oscilloscope, spectrum, a bar for each sounding mode, and the table of modes. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/mode_list.h"
#include "clients/viewer/panels/plots.h"
#include "clients/viewer/panels/skin.h"
#include "clients/viewer/spectrum.h"

#include <memory>
#include <vector>

namespace ringdown::viewer {

class SoundView {
 public:
  // Fills the current ImGui window. `alone` means that no other pane shows the chosen object's settings, so this one
  // does.
  void draw(const Skin& skin, Model& model, Commands& commands, bool alone);

 private:
  void draw_meters(const Skin& skin, const Model& model, bool tone) const;
  void draw_curves(const Skin& skin, const Model& model, float height);
  void draw_amplitudes(const Skin& skin, Model& model, Commands& commands, float height);
  void draw_table(const Skin& skin, const KnownObject& object, Commands& commands);
  const std::vector<ListedMode>& modes_of(const KnownObject& object, const Commands& commands);

  Spectrum spectrum_;
  std::vector<float> left_, right_, mono_;
  std::shared_ptr<const KnownBank> listed_;
  Adjustment adjustment_;
  std::uint32_t node_ = 0, shown_mode_ = 0;
  std::vector<ListedMode> modes_;
};

}  // namespace ringdown::viewer
