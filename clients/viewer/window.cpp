#include "clients/viewer/window.h"

#include "clients/viewer/keys.h"
#include "clients/viewer/panels/font.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <set>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr double kMaxScale = 8;

constexpr std::array<std::pair<int, std::string_view>, 28> kNamedKeys = {{{GLFW_KEY_ESCAPE, "escape"},
                                                                          {GLFW_KEY_TAB, "tab"},
                                                                          {GLFW_KEY_SPACE, "space"},
                                                                          {GLFW_KEY_ENTER, "enter"},
                                                                          {GLFW_KEY_KP_ENTER, "enter"},
                                                                          {GLFW_KEY_LEFT, "left"},
                                                                          {GLFW_KEY_RIGHT, "right"},
                                                                          {GLFW_KEY_UP, "up"},
                                                                          {GLFW_KEY_DOWN, "down"},
                                                                          {GLFW_KEY_PAGE_UP, "page up"},
                                                                          {GLFW_KEY_PAGE_DOWN, "page down"},
                                                                          {GLFW_KEY_BACKSPACE, "backspace"},
                                                                          {GLFW_KEY_DELETE, "delete"},
                                                                          {GLFW_KEY_HOME, "home"},
                                                                          {GLFW_KEY_F1, "F1"},
                                                                          {GLFW_KEY_F2, "F2"},
                                                                          {GLFW_KEY_F3, "F3"},
                                                                          {GLFW_KEY_F4, "F4"},
                                                                          {GLFW_KEY_F5, "F5"},
                                                                          {GLFW_KEY_F6, "F6"},
                                                                          {GLFW_KEY_F7, "F7"},
                                                                          {GLFW_KEY_F8, "F8"},
                                                                          {GLFW_KEY_F9, "F9"},
                                                                          {GLFW_KEY_F10, "F10"},
                                                                          {GLFW_KEY_F11, "F11"},
                                                                          {GLFW_KEY_F12, "F12"},
                                                                          {GLFW_KEY_KP_ADD, "="},
                                                                          {GLFW_KEY_KP_SUBTRACT, "-"}}};

// The label of the key in the user's layout; empty for keys without a meaning here.
std::string base_name(int key, int scancode) {
  const auto* named = std::ranges::find(kNamedKeys, key, &std::pair<int, std::string_view>::first);
  if (named != kNamedKeys.end()) return std::string(named->second);
  const char* printed = glfwGetKeyName(key, scancode);
  std::string name = printed ? printed : "";
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name == "+" ? "=" : name;
}

// Returns whether a key acts while the user types into a text field.
bool acts_on_text(std::string_view key) { return key == "ctrl+tab" || (key.size() > 1 && key[0] == 'F'); }

// Draws ImGui's picture into the framebuffer that is bound.
void paint(int width, int height) {
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace

struct Window::State {
  GLFWwindow* window = nullptr;
  double scale = 1, wanted_scale = 1;
  bool has_imgui = false;
  std::vector<KeyPress> pressed;
  std::vector<std::filesystem::path> dropped;
  std::set<std::string, std::less<>> down;
  std::array<int, 4> windowed{};  // position and size before full screen
  bool full_screen = false;

  ~State() {
    if (has_imgui) {
      ImGui_ImplOpenGL3_Shutdown();
      ImGui_ImplGlfw_Shutdown();
      ImGui::DestroyContext();
    }
    if (window) glfwDestroyWindow(window);
    glfwTerminate();
  }

  // ImGui gets every key except Tab, with which it would move its own focus. In a text field it does get Tab, which
  // moves to the next field.
  void on_key(int key, int scancode, int action, int modifiers) {
    const bool tab = key == GLFW_KEY_TAB && action != GLFW_RELEASE;
    const bool control = (modifiers & GLFW_MOD_CONTROL) != 0;
    if (!tab || (ImGui::GetIO().WantTextInput && !control)) {
      ImGui_ImplGlfw_KeyCallback(window, key, scancode, action, modifiers);
    }
    const std::string base = base_name(key, scancode);
    if (base.empty()) return;
    if (action == GLFW_RELEASE) {
      down.erase(base);
      return;
    }
    if ((modifiers & (GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return;  // the desktop's keys
    if (action == GLFW_PRESS && modifiers == 0) down.insert(base);
    pressed.push_back({key_name(base, control, (modifiers & GLFW_MOD_SHIFT) != 0), action == GLFW_REPEAT});
  }

  void show_font() {
    scale = wanted_scale;
    load_font(scale);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
};

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;
Window::~Window() = default;

Result<Window> Window::open(const Options& options) {
  static std::string complaint;
  glfwSetErrorCallback([](int, const char* what) { complaint = what; });
  if (!glfwInit()) {
    return fail(ErrorKind::refused,
                "there is no display to open a window on (" + complaint +
                    "): start it in a desktop session, or without a screen by `xvfb-run -a ringdown-viewer ...`");
  }
  auto state = std::make_unique<State>();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, options.visible ? GLFW_TRUE : GLFW_FALSE);
  state->window = glfwCreateWindow(options.width, options.height, "Ringdown", nullptr, nullptr);
  if (!state->window) {
    return fail(ErrorKind::refused,
                "this display has no OpenGL 3.3 (" + complaint + "): install Mesa's drivers (libgl1-mesa-dri)");
  }
  glfwMakeContextCurrent(state->window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(state->window, state.get());
  glfwSetWindowFocusCallback(state->window, [](GLFWwindow* window, int focused) {
    if (!focused) static_cast<State*>(glfwGetWindowUserPointer(window))->down.clear();
  });
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // settings.h keeps what is to be kept
  ImGui::GetIO().ConfigDragClickToInputText = true;
  ImGui_ImplGlfw_InitForOpenGL(state->window, true);
  glfwSetKeyCallback(state->window, [](GLFWwindow* window, int key, int scancode, int action, int modifiers) {
    static_cast<State*>(glfwGetWindowUserPointer(window))->on_key(key, scancode, action, modifiers);
  });
  glfwSetDropCallback(state->window, [](GLFWwindow* window, int count, const char** paths) {
    auto& dropped = static_cast<State*>(glfwGetWindowUserPointer(window))->dropped;
    dropped.insert(dropped.end(), paths, paths + count);
  });
  ImGui_ImplOpenGL3_Init("#version 330 core");
  state->has_imgui = true;
  Window window(std::move(state));
  window.set_scale(options.scale > 0 ? options.scale : window.display_scale());
  window.state_->show_font();
  return window;
}

bool Window::closed() const { return glfwWindowShouldClose(state_->window) != 0; }

int Window::width() const {
  int width = 0;
  glfwGetFramebufferSize(state_->window, &width, nullptr);
  return width;
}

int Window::height() const {
  int height = 0;
  glfwGetFramebufferSize(state_->window, nullptr, &height);
  return height;
}

double Window::scale() const { return state_->scale; }
double Window::display_scale() const {
  float scale = 1;
  glfwGetWindowContentScale(state_->window, &scale, nullptr);
  return scale;
}
bool Window::minimised() const {
  return glfwGetWindowAttrib(state_->window, GLFW_ICONIFIED) != 0 || width() == 0 || height() == 0;
}
void Window::set_scale(double scale) { state_->wanted_scale = std::clamp(scale, 0.5, kMaxScale); }
bool Window::full_screen() const { return state_->full_screen; }

void Window::set_full_screen(bool on) {
  if (on == state_->full_screen) return;
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (on && !mode) return;
  auto& [x, y, width, height] = state_->windowed;
  if (on) {
    glfwGetWindowPos(state_->window, &x, &y);
    glfwGetWindowSize(state_->window, &width, &height);
    glfwSetWindowMonitor(state_->window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
  } else {
    glfwSetWindowMonitor(state_->window, nullptr, x, y, width, height, GLFW_DONT_CARE);
  }
  state_->full_screen = on;
}

void Window::wait(double seconds) { seconds > 0 ? glfwWaitEventsTimeout(seconds) : glfwPollEvents(); }

void Window::begin_frame() {
  if (state_->wanted_scale != state_->scale) state_->show_font();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Window::end_frame() {
  ImGui::Render();
  paint(width(), height());
  glfwSwapBuffers(state_->window);
}

std::vector<Window::KeyPress> Window::take_keys() {
  std::vector<KeyPress> keys = std::exchange(state_->pressed, {});
  if (ImGui::GetIO().WantTextInput) std::erase_if(keys, [](const KeyPress& press) { return !acts_on_text(press.key); });
  return keys;
}

std::vector<std::filesystem::path> Window::take_dropped() { return std::exchange(state_->dropped, {}); }

bool Window::is_down(std::string_view key) const { return !ImGui::GetIO().WantTextInput && state_->down.contains(key); }

// Draws the frame once more into a framebuffer of its own, because the picture of a hidden window cannot be read.
Image Window::read_pixels() const {
  Image image{width(), height(), {}};
  ImDrawData* drawn = ImGui::GetDrawData();
  if (!drawn) return image;
  std::uint32_t framebuffer = 0, colour = 0;
  glGenFramebuffers(1, &framebuffer);
  glGenRenderbuffers(1, &colour);
  glBindRenderbuffer(GL_RENDERBUFFER, colour);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, image.width, image.height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
  paint(image.width, image.height);
  const auto row = static_cast<std::size_t>(4 * image.width), rows = static_cast<std::size_t>(image.height);
  std::vector<std::uint8_t> upside_down(row * rows);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteRenderbuffers(1, &colour);
  image.rgba.resize(upside_down.size());
  for (std::size_t y = 0; y < rows; ++y) {
    std::copy_n(upside_down.data() + (rows - 1 - y) * row, row, image.rgba.data() + y * row);
  }
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return image;
}

}  // namespace ringdown::viewer
