#include "clients/viewer/keys.h"

#include <algorithm>
#include <array>

namespace ringdown::viewer {
namespace {

using enum WhileDown;

constexpr std::array kBindings = {
    Binding{Pane::any, "escape", Action::quit, once, "Close this help, or quit; the daemon keeps running"},
    Binding{Pane::any, "tab", Action::full_screen, once, "Full screen on or off"},
    Binding{Pane::any, "F11", Action::full_screen, once, "Full screen on or off"},
    Binding{Pane::any, "ctrl+tab", Action::next_pane, once, "Go to the next pane"},
    Binding{Pane::any, "F1", Action::help, once, "Show the keys"},
    Binding{Pane::any, "F2", Action::theme, once, "Dark or light theme"},
    Binding{Pane::any, "F3", Action::listen, once, "Listen from the camera, or from where you put the listener"},
    Binding{Pane::any, "F5", Action::pause, once, "Pause or continue the scene"},
    Binding{Pane::any, "F6", Action::restart, once, "Restart the scene"},
    Binding{Pane::any, "ctrl+=", Action::larger, repeats, "Larger text"},
    Binding{Pane::any, "ctrl+-", Action::smaller, repeats, "Smaller text"},
    Binding{Pane::any, "ctrl+Z", Action::undo, repeats, "Undo the last change of a parameter, or of a body"},
    Binding{Pane::any, "ctrl+Y", Action::redo, repeats, "Redo the change that was undone last"},
    Binding{Pane::any, "ctrl+R", Action::record, once, "Start or end a recording of strikes"},
    Binding{Pane::any, "Z", Action::alpha_up, repeats, "More loss to supports"},
    Binding{Pane::any, "X", Action::alpha_down, repeats, "Less loss to supports"},
    Binding{Pane::any, "C", Action::beta_up, repeats, "More loss to the material"},
    Binding{Pane::any, "V", Action::beta_down, repeats, "Less loss to the material"},
    Binding{Pane::any, "B", Action::density_up, repeats, "More density: a semitone down"},
    Binding{Pane::any, "N", Action::density_down, repeats, "Less density: a semitone up"},
    Binding{Pane::any, "M", Action::stiffness_up, repeats, "More stiffness (lambda and mu): a semitone up"},
    Binding{Pane::any, ",", Action::stiffness_down, repeats, "Less stiffness: a semitone down"},
    Binding{Pane::any, ".", Action::next_node, repeats, "Excite the next node"},
    Binding{Pane::any, "/", Action::previous_node, repeats, "Excite the previous node"},
    Binding{Pane::any, "O", Action::next_object, repeats, "Choose the next object"},
    Binding{Pane::any, "I", Action::previous_object, repeats, "Choose the previous object"},
    Binding{Pane::any, "P", Action::project_test_force, once, "Project the test force: strike the excited node"},
    Binding{Pane::any, "L", Action::stronger, repeats, "Stronger test force"},
    Binding{Pane::any, "K", Action::weaker, repeats, "Weaker test force"},
    Binding{Pane::any, "G", Action::vibrate, once, "Show the chosen object vibrating in the chosen mode, or at rest"},
    Binding{Pane::any, "backspace", Action::clear_sound, once, "Clear: fade everything that rings"},

    Binding{Pane::scene, "W", Action::forward, continues, "Camera forward"},
    Binding{Pane::scene, "S", Action::back, continues, "Camera back"},
    Binding{Pane::scene, "A", Action::left, continues, "Camera to the left"},
    Binding{Pane::scene, "D", Action::right, continues, "Camera to the right"},
    Binding{Pane::scene, "page up", Action::up, continues, "Camera up"},
    Binding{Pane::scene, "page down", Action::down, continues, "Camera down"},
    Binding{Pane::scene, "left", Action::turn_left, continues, "Look to the left"},
    Binding{Pane::scene, "right", Action::turn_right, continues, "Look to the right"},
    Binding{Pane::scene, "up", Action::turn_up, continues, "Look up"},
    Binding{Pane::scene, "down", Action::turn_down, continues, "Look down"},
    Binding{Pane::scene, "=", Action::closer, continues, "Closer"},
    Binding{Pane::scene, "-", Action::farther, continues, "Farther"},
    Binding{Pane::scene, "home", Action::home, once, "Back to the scene's own camera"},
    Binding{Pane::scene, "space", Action::test_force, once,
            "Test force: strike the object under the mouse, or in the middle of the view"},
    Binding{Pane::scene, "H", Action::new_box, once, "Drop a new box"},
    Binding{Pane::scene, "J", Action::new_sphere, once, "Drop a new sphere"},
    Binding{Pane::scene, "delete", Action::remove_body, once,
            "Remove the body under the mouse, or in the middle of the view"},
    Binding{Pane::scene, "E", Action::place_body, once,
            "Move, turn and size the body under the mouse, or in the middle of the view, or end that"},
    Binding{Pane::scene, "T", Action::touch, once,
            "Click with a mallet, then a bow, then a coupling, then with the test force again"},
    Binding{Pane::scene, "F", Action::choose_support, once,
            "Choose the flat surface under the mouse, or in the middle of the view, as a support, or deselect it"},
    Binding{Pane::scene, "ctrl+C", Action::copy_support, once, "Copy the chosen support as text for an object file"},
    Binding{Pane::scene, "Q", Action::clear_sound, once, "Clear: fade everything that rings"},
    Binding{Pane::scene, "ctrl+delete", Action::clear_scene, once, "Remove all bodies"},

    Binding{Pane::sound, "Q", Action::highest_modes, once, "Play the 20 highest modes"},
    Binding{Pane::sound, "W", Action::test_tone, once, "Test tone of 440 Hz on or off"},
    Binding{Pane::sound, "E", Action::clear_sound, once, "Clear: fade everything that rings"},
    Binding{Pane::sound, "R", Action::project_test_force, once, "Project the test force: strike the excited node"},
    Binding{Pane::sound, "T", Action::all_modes, once, "Play all modes at once"},
    Binding{Pane::sound, "A", Action::more_modes, repeats, "More modes"},
    Binding{Pane::sound, "S", Action::fewer_modes, repeats, "Fewer modes"},
    Binding{Pane::sound, "down", Action::next_mode, repeats, "Choose the next mode"},
    Binding{Pane::sound, "up", Action::previous_mode, repeats, "Choose the previous mode"},
    Binding{Pane::sound, "enter", Action::hear_mode, once, "Hear the chosen mode alone"},
};

}  // namespace

std::span<const Binding> bindings() { return kBindings; }

std::string_view heading_of(Pane pane) {
  return pane == Pane::scene ? "In the scene" : pane == Pane::sound ? "In the sound" : "Everywhere";
}

std::optional<Binding> binding_for(Pane focused, std::string_view key) {
  for (const Pane pane : {focused, Pane::any}) {
    const auto* found =
        std::ranges::find_if(kBindings, [&](const Binding& b) { return b.pane == pane && b.key == key; });
    if (found != kBindings.end()) return *found;
  }
  return std::nullopt;
}

std::string key_name(std::string_view base, bool control, bool shift) {
  std::string name = control ? "ctrl+" : "";
  if (shift && base == "tab") name += "shift+";
  return name.append(base);
}

std::string keys_as_markdown() {
  std::string text;
  for (const Pane pane : kPanesWithKeys) {
    text.append("\n### ").append(heading_of(pane)).append("\n\n");
    for (const Binding& binding : kBindings) {
      if (binding.pane != pane) continue;
      text.append("- `").append(binding.key).append("`: ").append(binding.sentence).append("\n");
    }
  }
  return text;
}

}  // namespace ringdown::viewer
