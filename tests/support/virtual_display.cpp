#include "tests/support/virtual_display.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace ringdown::test {
namespace {

// The number that Xvfb writes in a line of its own once it listens, among what it may complain of.
std::string display_number(const std::string& output) {
  std::istringstream lines(output.substr(0, output.rfind('\n') + 1));
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && std::all_of(line.begin(), line.end(), [](unsigned char c) { return std::isdigit(c); }))
      return line;
  }
  return {};
}

}  // namespace

VirtualDisplay::VirtualDisplay() {
  if (const char* before = std::getenv("DISPLAY")) name_before_ = before;
  if (!installed("Xvfb")) return;
  server_ = std::make_unique<Process>(std::vector<std::string>{"Xvfb", "-displayfd", "1", "-screen", "0", "1280x800x24",
                                                               "+extension", "GLX", "-noreset", "-nolisten", "tcp"});
  std::string number;
  for (int tries = 0; number.empty() && tries < 12000 && !server_->wait(std::chrono::milliseconds(10)); ++tries)
    number = display_number(server_->output());
  if (number.empty()) throw std::runtime_error("Xvfb does not come up: " + server_->output());
  name_ = ":" + number;
  setenv("DISPLAY", name_.c_str(), 1);
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
}

VirtualDisplay::~VirtualDisplay() {
  if (works()) setenv("DISPLAY", name_before_.c_str(), 1);
}

}  // namespace ringdown::test
