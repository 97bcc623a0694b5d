// A window with an OpenGL 3.3 context and ImGui in it; the only part that knows GLFW. [main]
#pragma once

#include "clients/viewer/render/picture_file.h"
#include "engine/base/result.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::viewer {

class Window {
 public:
  struct Options {
    int width = 1440, height = 900;  // pixels; if visible, as many times more as the display's scale says
    bool visible = true;
    double scale = 0;  // of text; 0: the display's
  };
  // Fails, with a sentence that says what to do, where there is no display or no OpenGL 3.3.
  static Result<Window> open(const Options& options);
  Window(Window&&) noexcept;
  Window& operator=(Window&&) noexcept;
  ~Window();

  [[nodiscard]] bool closed() const;  // by its frame or the window manager
  [[nodiscard]] int width() const;    // of what is drawn, in pixels
  [[nodiscard]] int height() const;
  [[nodiscard]] double scale() const;          // of text and controls
  [[nodiscard]] double display_scale() const;  // 1 on a display of 96 dots per inch
  [[nodiscard]] bool minimised() const;        // or of no size
  void set_scale(double scale);                // from the next frame on
  void set_full_screen(bool on);
  [[nodiscard]] bool full_screen() const;

  // Takes what the user did, or waits for it up to `seconds`; begins ImGui's frame; draws and shows it.
  void wait(double seconds);
  void begin_frame();
  void end_frame();

  // Keys pressed since the last call, by keys.h's names; and whether one is down. Not while text is typed.
  struct KeyPress {
    std::string key;
    bool repeated;  // by the keyboard, because it stays down
  };
  [[nodiscard]] std::vector<KeyPress> take_keys();
  [[nodiscard]] bool is_down(std::string_view key) const;

  // What end_frame() has drawn last.
  [[nodiscard]] Image read_pixels() const;

 private:
  struct State;
  explicit Window(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::viewer
