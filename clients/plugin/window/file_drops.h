// Files that are dropped onto the plug-in's windows, by XDND, the protocol of X11's desktops, which DPF does not speak.
// pugl.cpp is compiled with ringdown_next_event() in place of Xlib's XNextEvent() (CMakeLists.txt), so the messages of
// a drag are answered on the connection on which they come.
//
// A file manager looks for the outermost window that takes drops. If the host's own window takes some, the host gets
// the file. [UI]
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace ringdown::plugin {

// Returns the files that were dropped onto a window since the last call.
std::vector<std::filesystem::path> take_dropped_files(std::uintptr_t window);

}  // namespace ringdown::plugin
