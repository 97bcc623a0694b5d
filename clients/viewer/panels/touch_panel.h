// Mallets, bows and couplings by the mouse: a panel with their figures, and marks where bows and couplings lie. [UI]
//
// While the panel is open, a click throws a mallet, or lays a bow; a drag along a surface lays a bow whose hair moves
// in the direction of the drag; a drag from one object to another couples the two.
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/panels/skin.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace ringdown::viewer {

class TouchPanel {
 public:
  enum class Kind { mallet, bow, coupling };
  // Returns the window position of a point in an object's frame and size; nothing if it is not visible.
  using PlaceOf = std::function<std::optional<ImVec2>(const std::string& object, Vec3 point_m)>;

  void next();  // opens the panel with mallets, goes on to bows and couplings, and closes it
  void end() { is_open_ = false; }
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] Kind kind() const { return kind_; }
  // Returns whether a drag that begins on a surface is the panel's, not the camera's.
  [[nodiscard]] bool takes_drags() const { return is_open_ && kind_ != Kind::mallet; }

  // The mouse was pressed on a surface and released at `to`, if that is one. `way` is its way in the frame of the
  // object.
  void touch(const SurfacePoint& from, Vec3 way, const std::optional<SurfacePoint>& to, Commands& commands);

  // Draws the panel at the lower left of the picture.
  void draw(const Skin& skin, ImVec2 origin, ImVec2 size, Commands& commands);
  void mark(const Skin& skin, const Touches& touches, const PlaceOf& place_of) const;

 private:
  void draw_mallet();
  void draw_bow(Edits& edits);
  void draw_coupling(Edits& edits);

  bool is_open_ = false;
  Kind kind_ = Kind::mallet;
  double speed_m_s_ = 1;  // of mallets
  synth::verb::Mallet mallet_;
  synth::verb::Bow bow_{.speed_m_s = 0.2, .force_n = 1};
  synth::verb::Couple coupling_;
  std::string bowed_;                  // the object whose bow the sliders change
  std::uint32_t coupling_number_ = 0;  // the coupling that the sliders change
  std::string complaint_;
};

}  // namespace ringdown::viewer
