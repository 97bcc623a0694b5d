// An OpenGL context of a test's own: a hidden window on a virtual display.
#pragma once

#include "tests/support/virtual_display.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace ringdown::test {

class PictureWindow {
 public:
  PictureWindow(int major = 3, int minor = 3) {
    if (!display_.works() || !glfwInit()) return;
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, major);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, minor);
    if (major > 3 || (major == 3 && minor >= 2)) glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(64, 64, "test", nullptr, nullptr);
    if (window_ != nullptr) glfwMakeContextCurrent(window_);
  }
  ~PictureWindow() { glfwTerminate(); }
  PictureWindow(const PictureWindow&) = delete;
  PictureWindow& operator=(const PictureWindow&) = delete;

  [[nodiscard]] const VirtualDisplay& display() const { return display_; }
  [[nodiscard]] bool works() const { return window_ != nullptr; }

 private:
  VirtualDisplay display_;
  GLFWwindow* window_ = nullptr;
};

}  // namespace ringdown::test
