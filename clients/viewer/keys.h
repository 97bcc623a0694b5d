// The one table of keys: what the window obeys, what F1 shows, what docs/viewer.md lists.
//
// Letters are those of the 2011 report's two programs where it gives them: its test GUI is our sound pane, its OpenGL
// scene our scene pane. Where both mean something by a letter (Q W E A S D) the focused pane decides. [any thread]
#pragma once

#include "clients/viewer/action.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ringdown::viewer {

enum class Pane : std::uint8_t { any, scene, sound, side };

// What a key does that stays down: nothing more, the same again and again, or something all the time.
enum class Hold : std::uint8_t { once, repeats, acts };

struct Binding {
  Pane pane;             // where it counts; a pane's own bindings go before those of any
  std::string_view key;  // "Q", "space", "ctrl+Z": as key_name() makes them
  Action action;
  Hold hold;
  std::string_view sentence;
};

std::span<const Binding> bindings();

// What `key` does while `focused` has the focus.
std::optional<Binding> binding_for(Pane focused, std::string_view key);

// The name of a key: `base` is the upper-case letter, digit or sign, or "space", "escape", "F1", "left" ...
std::string key_name(std::string_view base, bool control, bool shift);

// The table as Markdown, for docs/viewer.md.
std::string keys_as_markdown();

}  // namespace ringdown::viewer
