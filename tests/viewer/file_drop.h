// Drops a file onto a window as a file manager does, by XDND, the protocol of X11's desktops. Another thread serves the
// window's questions, so frames may go on meanwhile.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace ringdown::viewer {

class FileDrop {
 public:
  // Drops the file onto the window of this name, which must be on the display.
  FileDrop(const std::string& window, const std::filesystem::path& file);
  // Drops it onto the window of this number.
  FileDrop(unsigned long window, const std::filesystem::path& file);
  ~FileDrop();
  FileDrop(const FileDrop&) = delete;
  FileDrop& operator=(const FileDrop&) = delete;

  // Returns whether the window has said that it took the file.
  [[nodiscard]] bool is_taken() const;

 private:
  struct Source;  // keeps the names of Xlib away
  std::unique_ptr<Source> source_;
};

}  // namespace ringdown::viewer
