// The actions that a key, a button or a menu can ask for, and the one table of keys, which the window uses, F1 shows
// and docs/use/window.md lists. commands.h describes the actions.
//
// The letters are those of the 2011 report's two programs: its test GUI is the sound pane, its OpenGL scene is the
// scene pane. Letters with a meaning in both (Q W A S) act on the focused pane. [any thread]
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ringdown::viewer {

enum class Action : std::uint8_t {
  // the window
  quit,
  help,
  full_screen,
  theme,
  listen,
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
  remove_body,
  place_body,
  touch,
  clear_scene,
  vibrate,
  choose_support,
  copy_support,
  pause,
  restart,
};

enum class Pane : std::uint8_t { any, scene, sound, side };

// The panes that have keys, in the order of lists of keys; the side pane has no keys.
inline constexpr std::array kPanesWithKeys = {Pane::any, Pane::scene, Pane::sound};

// The behaviour of a key that is held down: the action happens once, repeats with the keyboard's repeat rate, or goes
// on continuously in every frame.
enum class WhileDown : std::uint8_t { once, repeats, continues };

struct Binding {
  Pane pane;             // pane in which the key works; the focused pane's bindings take precedence over Pane::any
  std::string_view key;  // "Q", "space", "ctrl+Z": as key_name() writes them
  Action action;
  WhileDown while_down;
  std::string_view sentence;
};

std::span<const Binding> bindings();

// Returns the heading above the keys of a pane: "Everywhere", "In the scene", "In the sound".
std::string_view heading_of(Pane pane);

// Returns the binding of `key` while `focused` has the focus.
std::optional<Binding> binding_for(Pane focused, std::string_view key);

// Returns the name of a key with its modifiers. `base` is an upper-case letter, a digit or sign, or "space", "escape",
// "F1" ...
std::string key_name(std::string_view base, bool control, bool shift);

// Returns the table as lists in Markdown, for docs/use/window.md.
std::string keys_as_markdown();

}  // namespace ringdown::viewer
