// What a key, a button or a menu can ask for. keys.h says which key, commands.h what it does.
#pragma once

#include <cstdint>

namespace ringdown::viewer {

enum class Action : std::uint8_t {
  // the window
  quit,
  help,
  full_screen,
  theme,
  next_pane,
  larger,
  smaller,
  // what is edited
  undo,
  redo,
  record,
  next_object,
  previous_object,
  clear_sound,
  stronger,
  weaker,
  project_test_force,
  // the sound
  all_modes,
  highest_modes,
  test_tone,
  more_modes,
  fewer_modes,
  alpha_up,
  alpha_down,
  beta_up,
  beta_down,
  density_up,
  density_down,
  stiffness_up,
  stiffness_down,
  next_node,
  previous_node,
  next_mode,
  previous_mode,
  hear_mode,
  // the scene
  forward,
  back,
  left,
  right,
  up,
  down,
  turn_left,
  turn_right,
  turn_up,
  turn_down,
  closer,
  farther,
  home,
  test_force,
  new_box,
  new_sphere,
  clear_scene,
  vibrate,
  pause,
  restart,
};

}  // namespace ringdown::viewer
