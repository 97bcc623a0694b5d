// A window with an OpenGL 3.3 context and ImGui; the only part that uses GLFW. [main]
#pragma once

#include "clients/viewer/render/picture_file.h"
#include "engine/base/result.h"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::viewer {

class Window {
 public:
  struct Options {
    int width = 1440, height = 900;  // pixels; a visible window is larger by the display's scale
    bool visible = true;
    double scale = 0;  // scale of text; 0: the display's scale
  };
  // Fails without a display or OpenGL 3.3, with a sentence that says what to do.
  static Result<Window> open(const Options& options);
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  [[nodiscard]] bool closed() const;  // whether the user or the window manager has closed the window
  [[nodiscard]] int width() const;    // width of the framebuffer, in pixels
  [[nodiscard]] int height() const;
  [[nodiscard]] double scale() const;          // scale of text and controls
  [[nodiscard]] double display_scale() const;  // 1 on a display of 96 dots per inch
  [[nodiscard]] bool minimised() const;        // whether the window is minimised or has no size
  void set_scale(double scale);                // takes effect in the next frame
  void set_full_screen(bool on);
  [[nodiscard]] bool full_screen() const;

  // wait() processes input, waiting up to `seconds` for some; begin_frame() begins a frame of ImGui; end_frame() draws
  // and shows it.
  void wait(double seconds);
  void begin_frame();
  void end_frame();

  // Return the keys pressed since the last call, by the names of keys.h, and whether a key is down. While the user
  // types into a text field, only ctrl+tab and the function keys are reported. Keys with Alt or Super are left to the
  // desktop.
  struct KeyPress {
    std::string key;
    bool repeated;  // the keyboard repeated the key, which is held down
  };
  [[nodiscard]] std::vector<KeyPress> take_keys();
  [[nodiscard]] bool is_down(std::string_view key) const;

  // Returns the files that were dropped onto the window since the last call.
  [[nodiscard]] std::vector<std::filesystem::path> take_dropped();

  // Returns the picture that the last end_frame() drew.
  [[nodiscard]] Image read_pixels() const;

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::viewer
