#include "tests/viewer/file_drop.h"

#include <atomic>
#include <thread>

#include <X11/Xatom.h>
#include <X11/Xlib.h>

namespace ringdown::viewer {

struct FileDrop::Source {
  Source(const std::string& name, Window window, const std::filesystem::path& file)
      : name_(name), text_("file://" + file.string() + "\r\n"), target_(window), thread_([this] { run(); }) {}
  ~Source() {
    ends_ = true;
    thread_.join();
  }
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }
  Window find() {
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count);
    for (unsigned i = 0; i < count; ++i) {
      char* name = nullptr;
      if (XFetchName(display_, children[i], &name) != 0 && name_ == name) found = children[i];
      if (name) XFree(name);
    }
    if (children) XFree(children);
    return found;
  }
  void tell(const char* what, long a, long b, long c) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.display = display_;
    event.xclient.window = target_;
    event.xclient.message_type = atom(what);
    event.xclient.format = 32;
    const long numbers[] = {static_cast<long>(own_), a, b, c, static_cast<long>(atom("XdndActionCopy"))};
    for (int i = 0; i < 5; ++i) event.xclient.data.l[i] = numbers[i];
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }
  void give(const XSelectionRequestEvent& asked) {
    XChangeProperty(display_, asked.requestor, asked.property, asked.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text_.data()), static_cast<int>(text_.size()));
    XEvent event{};
    event.xselection = {SelectionNotify, 0,         True, display_, asked.requestor, asked.selection, asked.target,
                        asked.property,  asked.time};
    XSendEvent(display_, asked.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }
  void run() {
    display_ = XOpenDisplay(nullptr);
    if (!display_) return;
    if (target_ == 0) target_ = find();
    own_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display_, atom("XdndSelection"), own_, CurrentTime);
    tell("XdndEnter", 5L << 24, static_cast<long>(atom("text/uri-list")), 0);
    tell("XdndPosition", 0, 300L << 16 | 200, CurrentTime);
    while (!ends_ && !is_taken_) {
      if (XPending(display_) == 0) {
        std::this_thread::yield();
        continue;
      }
      XEvent event{};
      XNextEvent(display_, &event);
      if (event.type == SelectionRequest) give(event.xselectionrequest);
      if (event.type != ClientMessage) continue;
      if (event.xclient.message_type == atom("XdndStatus")) tell("XdndDrop", 0, CurrentTime, 0);
      if (event.xclient.message_type == atom("XdndFinished")) is_taken_ = true;
    }
    XCloseDisplay(display_);
  }

  const std::string name_, text_;
  Display* display_ = nullptr;
  Window target_, own_ = 0;
  std::atomic<bool> is_taken_ = false, ends_ = false;
  std::thread thread_;  // last: it uses all of these
};

FileDrop::FileDrop(const std::string& window, const std::filesystem::path& file)
    : source_(std::make_unique<Source>(window, 0, file)) {}
FileDrop::FileDrop(unsigned long window, const std::filesystem::path& file)
    : source_(std::make_unique<Source>("", window, file)) {}
FileDrop::~FileDrop() = default;
bool FileDrop::is_taken() const { return source_->is_taken_; }

}  // namespace ringdown::viewer
