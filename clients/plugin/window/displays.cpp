// Connections to the X server for DPF, which opens one for each window, and closes it with the window. Libraries below
// keep some 12 kB at each turn: when the last connection closes, Mesa's driver is unloaded, and the C library keeps
// what the driver registered to be done at exit; libGL keeps what it knew of the connection's pixel formats. So a
// connection that DPF closes is kept here for the next window. A process has as many as it ever had windows at a time.
// They end with the process.
//
// pugl.cpp is compiled with these functions in place of Xlib's (CMakeLists.txt). [UI]
#include <algorithm>
#include <string_view>
#include <vector>

#include <X11/Xlib.h>

namespace {

struct Connection {
  Display* display;
  std::vector<Colormap> colormaps;  // DPF leaves them to the end of the connection
  bool is_used = true;
};

std::vector<Connection>& connections() {
  static std::vector<Connection> all;
  return all;
}

}  // namespace

extern "C" {

Display* ringdown_open_display(const char* name) {
  for (Connection& connection : connections()) {
    if (connection.is_used || std::string_view(DisplayString(connection.display)) != XDisplayName(name)) continue;
    connection.is_used = true;
    return connection.display;
  }
  Display* const display = XOpenDisplay(name);
  if (display) connections().push_back({display, {}});
  return display;
}

Colormap ringdown_create_colormap(Display* display, Window window, Visual* visual, int kind) {
  const Colormap made = XCreateColormap(display, window, visual, kind);
  const auto connection = std::ranges::find(connections(), display, &Connection::display);
  if (connection != connections().end()) connection->colormaps.push_back(made);
  return made;
}

int ringdown_close_display(Display* display) {
  const auto connection = std::ranges::find(connections(), display, &Connection::display);
  if (connection == connections().end()) return XCloseDisplay(display);
  for (const Colormap colormap : connection->colormaps) XFreeColormap(display, colormap);
  connection->colormaps.clear();
  XSync(display, True);  // nothing for the old window is left
  connection->is_used = false;
  return 0;
}

}  // extern "C"
