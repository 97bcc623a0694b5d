// A display of a test's own, without a screen: an Xvfb with GLX, 1280 x 800, ended by its id.
//
//   const VirtualDisplay display;
//   if (!display.works()) GTEST_SKIP() << "Xvfb is not installed";
//   glfwInit();  // DISPLAY names it, for this process and those it starts
#pragma once

#include "tests/integration/process.h"

#include <memory>
#include <string>

namespace ringdown::test {

class VirtualDisplay {
 public:
  // Starts it, waits until it takes clients, and sets DISPLAY and LIBGL_ALWAYS_SOFTWARE. Throws when it does not come
  // up although it is installed: after a failure that is not fatal, GoogleTest would go on.
  VirtualDisplay();
  ~VirtualDisplay();  // puts DISPLAY back
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  [[nodiscard]] bool works() const { return !name_.empty(); }
  [[nodiscard]] const std::string& name() const { return name_; }  // ":7"

 private:
  std::unique_ptr<Process> server_;
  std::string name_, name_before_;
};

}  // namespace ringdown::test
