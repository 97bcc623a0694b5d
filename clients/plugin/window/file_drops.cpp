#include "clients/plugin/window/file_drops.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace ringdown::plugin {
namespace {

constexpr long kVersion = 5;           // of XDND
constexpr long kMaxWords = 16 * 1024;  // of a list of files or types, 4 bytes each

using Files = std::vector<std::filesystem::path>;

std::map<Window, Files>& dropped() {
  static std::map<Window, Files> files;
  return files;
}

// The drag that is over a window. A pointer drags one thing at a time.
struct Drag {
  Window source = None;
  bool has_files = false;
};
Drag& drag() {
  static Drag present;
  return present;
}

// While one exists, an error of X11 does nothing: a source may be gone, and Xlib would end the host.
class Tolerance {
 public:
  explicit Tolerance(Display* display) : display_(display) { XSync(display, False); }
  ~Tolerance() {
    XSync(display_, False);
    XSetErrorHandler(before_);
  }
  Tolerance(const Tolerance&) = delete;
  Tolerance& operator=(const Tolerance&) = delete;

 private:
  Display* display_;
  XErrorHandler before_ = XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
};

Atom atom(Display* display, const char* name) { return XInternAtom(display, name, False); }

// Returns the items of a property; none if it is not of this type and format.
template <class Item>
std::vector<Item> property_of(Display* display, Window window, Atom name, Atom type, int format) {
  const Tolerance tolerance(display);
  Atom found_type = None;
  int found_format = 0;
  unsigned long count = 0, left = 0;
  unsigned char* data = nullptr;
  std::vector<Item> items;
  if (XGetWindowProperty(display, window, name, 0, kMaxWords, False, type, &found_type, &found_format, &count, &left,
                         &data) == Success &&
      found_type == type && found_format == format) {
    items.assign(reinterpret_cast<const Item*>(data), reinterpret_cast<const Item*>(data) + count);
  }
  if (data) XFree(data);
  return items;
}

void answer(const XClientMessageEvent& message, const char* what, long takes) {
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = drag().source;
  event.xclient.message_type = atom(message.display, what);
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(message.window);
  event.xclient.data.l[1] = takes;
  // XdndStatus has the action in its fifth number, after a rectangle; XdndFinished in its third.
  event.xclient.data.l[takes != 0 && std::string_view(what) == "XdndFinished" ? 2 : 4] =
      takes != 0 ? static_cast<long>(atom(message.display, "XdndActionCopy")) : 0;
  const Tolerance tolerance(message.display);
  XSendEvent(message.display, drag().source, False, NoEventMask, &event);
}

// More than three types stand in a property of the source.
void begin(const XClientMessageEvent& enter) {
  const Atom uris = atom(enter.display, "text/uri-list");
  drag() = {static_cast<Window>(enter.data.l[0]), false};
  std::vector<Atom> types(enter.data.l + 2, enter.data.l + 5);
  if ((enter.data.l[1] & 1) != 0)
    types = property_of<Atom>(enter.display, drag().source, atom(enter.display, "XdndTypeList"), XA_ATOM, 32);
  drag().has_files = std::ranges::find(types, uris) != types.end();
}

int hex_digit(char c) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const std::size_t at = kDigits.find(static_cast<char>(c >= 'A' && c <= 'F' ? c - 'A' + 'a' : c));
  return at == kDigits.npos ? -1 : static_cast<int>(at);
}

// Returns the files of this computer that a list of URIs names, one in each line: file:///a%20b or file://host/a%20b.
Files files_of(std::string_view uris) {
  constexpr std::string_view kScheme = "file://";
  Files files;
  while (!uris.empty()) {
    const std::string_view line = uris.substr(0, uris.find_first_of("\r\n"));
    uris.remove_prefix(std::min(uris.size(), line.size() + 1));
    const std::size_t begin = line.starts_with(kScheme) ? line.find('/', kScheme.size()) : line.npos;
    if (begin == line.npos) continue;
    std::string path;
    for (std::size_t i = begin; i < line.size(); ++i) {
      const int high = line[i] == '%' && i + 2 < line.size() ? hex_digit(line[i + 1]) : -1;
      const int low = high >= 0 ? hex_digit(line[i + 2]) : -1;
      path += low >= 0 ? static_cast<char>(16 * high + low) : line[i];
      if (low >= 0) i += 2;
    }
    files.emplace_back(std::move(path));
  }
  return files;
}

// Returns whether the message belongs to a drag.
bool follow(const XClientMessageEvent& message) {
  const auto is = [&](const char* name) { return message.message_type == atom(message.display, name); };
  if (is("XdndEnter")) {
    begin(message);
  } else if (is("XdndPosition")) {
    answer(message, "XdndStatus", drag().has_files ? 1 : 0);
  } else if (is("XdndLeave")) {
    drag() = {};
  } else if (is("XdndDrop")) {
    if (!drag().has_files) return answer(message, "XdndFinished", 0), true;
    const Atom selection = atom(message.display, "XdndSelection");
    XConvertSelection(message.display, selection, atom(message.display, "text/uri-list"), selection, message.window,
                      static_cast<Time>(message.data.l[2]));
    XFlush(message.display);
  } else {
    return false;
  }
  return true;
}

bool take(const XSelectionEvent& event) {
  Display* const display = event.display;
  if (event.selection != atom(display, "XdndSelection")) return false;
  const auto text = event.property == None
                        ? std::vector<char>()
                        : property_of<char>(display, event.requestor, event.property, event.target, 8);
  XDeleteProperty(display, event.requestor, event.selection);
  const Files files = files_of({text.data(), text.size()});
  Files& all = dropped()[event.requestor];
  all.insert(all.end(), files.begin(), files.end());
  XClientMessageEvent drop{};
  drop.display = display;
  drop.window = event.requestor;
  answer(drop, "XdndFinished", files.empty() ? 0 : 1);
  drag() = {};
  return true;
}

}  // namespace

std::vector<std::filesystem::path> take_dropped_files(std::uintptr_t window) {
  const auto found = dropped().find(static_cast<Window>(window));
  if (found == dropped().end()) return {};
  Files files = std::move(found->second);
  dropped().erase(found);
  return files;
}

}  // namespace ringdown::plugin

// Reads an event. Those of drags are hidden from pugl: they belong to no window of its own any more.
extern "C" int ringdown_next_event(Display* display, XEvent* event) {
  using namespace ringdown::plugin;
  const int result = XNextEvent(display, event);
  if (event->type == MapNotify) {
    const Atom version = kVersion;
    XChangeProperty(display, event->xmap.window, atom(display, "XdndAware"), XA_ATOM, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(&version), 1);
  }
  if ((event->type == ClientMessage && follow(event->xclient)) ||
      (event->type == SelectionNotify && take(event->xselection)))
    event->xany.window = None;
  return result;
}
