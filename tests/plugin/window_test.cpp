// The window of the built plug-ins, in all formats, in real windows of a display without a screen.
#include "tests/plugin/score.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewer/file_drop.h"
#include "tests/support/heap_meter.h"
#include "tests/support/virtual_display.h"

#include <gtest/gtest.h>

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace {

std::atomic<int> pictures = 0;

}  // namespace

// Counts pictures on their way to the display. The modules call this function in place of libGL's, because a program's
// own symbols come first.
extern "C" __attribute__((visibility("default"))) void glXSwapBuffers(Display* display, unsigned long drawable) {
  using Function = void (*)(Display*, unsigned long);
  static void* const library = dlopen("libGL.so.1", RTLD_NOW | RTLD_LOCAL);
  static const auto real = reinterpret_cast<Function>(dlsym(library, "glXSwapBuffers"));
  ++pictures;
  real(display, drawable);
}

namespace {

using namespace ringdown::test;

constexpr int kWidth = 1100, kHeight = 680;
constexpr std::uint32_t kFrames = 512;
constexpr int kObjectX = 480, kObjectY = 266;                       // a place at which the object is seen
constexpr int kMalletsX = 246, kMalletWidth = 78, kMalletsY = 545;  // the middles of the pictures
constexpr int kScaleX = 500, kScaleY = 18, kScaleChoiceY = 84;      // the list of scales, and 150 % in it
constexpr int kBakeX = 578, kBakeY = 624;                           // the button "Bake" for a dropped mesh
constexpr const char* kPoint = " vibraphone-key";                   // in a session: of a strike point
constexpr std::size_t kObject = 1, kRootKey = 3, kMallet = 20;      // numbers of parameters
constexpr double kVibraphoneKey = 9;                                // value of the parameter Object

// A host's window, in which the plug-in's is opened.
class Desktop {
 public:
  Desktop() : display_(XOpenDisplay(nullptr)) {
    if (!display_) return;
    parent_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, kWidth, kHeight, 0, 0, 0);
    XMapWindow(display_, parent_);
    XSync(display_, False);
  }
  ~Desktop() {
    if (display_) XCloseDisplay(display_);
  }
  [[nodiscard]] bool works() const { return display_ != nullptr; }
  [[nodiscard]] Window parent() const { return parent_; }
  // Returns the plug-in's window; 0 if there is none.
  [[nodiscard]] Window child() const {
    Window root = 0, parent = 0, *children = nullptr;
    unsigned count = 0;
    XQueryTree(display_, parent_, &root, &parent, &children, &count);
    const Window first = count > 0 ? children[0] : 0;
    if (children) XFree(children);
    return first;
  }
  void wait() const { XSync(display_, False); }
  // Presses or releases a button as a user would, with modifiers of X11.
  void button(bool press, int x, int y, unsigned modifiers = 0) const {
    XEvent event{};
    event.xbutton.type = press ? ButtonPress : ButtonRelease;
    event.xbutton.display = display_;
    event.xbutton.window = child();
    event.xbutton.root = DefaultRootWindow(display_);
    event.xbutton.button = Button1;
    event.xbutton.state = modifiers | (press ? 0 : Button1Mask);
    event.xbutton.x = event.xbutton.x_root = x;
    event.xbutton.y = event.xbutton.y_root = y;
    event.xbutton.same_screen = True;
    XSendEvent(display_, child(), True, ButtonPressMask | ButtonReleaseMask, &event);
    XSync(display_, False);
  }
  // Returns a part of the plug-in's picture, row by row: 0xrrggbb.
  [[nodiscard]] std::vector<unsigned long> pixels(int x, int y, int width, int height) const {
    std::vector<unsigned long> found;
    XImage* const image = XGetImage(display_, child(), x, y, static_cast<unsigned>(width),
                                    static_cast<unsigned>(height), AllPlanes, ZPixmap);
    for (int row = 0; image && row < height; ++row) {
      for (int column = 0; column < width; ++column) found.push_back(XGetPixel(image, column, row) & 0xffffff);
    }
    if (image) XDestroyImage(image);
    return found;
  }
  // Writes the whole picture as a PPM file, for docs/figures/plot_plugin_window.py.
  void write(const std::string& path) const {
    std::ofstream file(path, std::ios::binary);
    file << "P6 " << kWidth << ' ' << kHeight << " 255\n";
    for (const unsigned long pixel : pixels(0, 0, kWidth, kHeight)) {
      for (const int shift : {16, 8, 0}) file.put(static_cast<char>(pixel >> shift));
    }
  }

 private:
  Display* display_;
  Window parent_ = 0;
};

struct Format {
  const char* name;
  std::unique_ptr<PluginHost> (*open)();
};

class PluginWindow : public testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    setenv("RINGDOWN_PRESETS", RINGDOWN_SOURCE_DIR "/presets", 1);
    static const VirtualDisplay server;  // until the end, because the plug-in keeps its connections
    if (!server.works()) GTEST_SKIP() << "Xvfb is not installed";
    desktop_ = std::make_unique<Desktop>();
    ASSERT_TRUE(desktop_->works());
    host_ = GetParam().open();
    host_->activate(48000);
  }
  void open() { ASSERT_TRUE(host_->open_window(desktop_->parent())); }
  // Lets blocks and the window's timer run by turns. Returns the peak of the sound.
  double run(int turns) {
    double peak = 0;
    for (int i = 0; i < turns; ++i) {
      std::vector<float> left(kFrames), right(kFrames);
      host_->render({}, left.data(), right.data(), kFrames);
      for (const float sample : left) peak = std::max(peak, static_cast<double>(std::abs(sample)));
      host_->idle_window();
    }
    return peak;
  }
  // Waits until the display has told all it has to tell, in its own time, and nothing more is drawn. Returns the number
  // of pictures so far.
  int settle() {
    int before = 0;
    for (int quiet = 0, tries = 0; quiet < 100 && tries < 5000; ++tries) {
      desktop_->wait();
      host_->idle_window();
      quiet = pictures > 0 && pictures == before ? quiet + 1 : 0;
      before = pictures;
    }
    return before;
  }

  std::unique_ptr<Desktop> desktop_;
  std::unique_ptr<PluginHost> host_;
};

INSTANTIATE_TEST_SUITE_P(, PluginWindow,
                         testing::Values(Format{"clap", open_clap}, Format{"lv2", open_lv2}, Format{"vst3", open_vst3}),
                         [](const auto& format) { return std::string(format.param.name); });

TEST_P(PluginWindow, ShowsTheObjectItsControlsAndItsModes) {
  open();
  run(1);
  settle();
  ASSERT_NE(desktop_->child(), 0U);
  for (const auto& [name, x, y] :
       {std::tuple{"browser", 10, 60}, {"object", 400, 200}, {"modes", 300, 590}, {"controls", 800, 100}}) {
    const auto seen = desktop_->pixels(x, y, 150, 80);
    EXPECT_GT(std::set<unsigned long>(seen.begin(), seen.end()).size(), 3U) << name;
  }
  host_->close_window();
}

TEST_P(PluginWindow, AClickStrikesTheObjectWhereItIsSeenAndSetsTheStrikePoint) {
  open();
  EXPECT_EQ(run(3), 0);
  settle();
  EXPECT_EQ(host_->save().find(" vibraphone-key"), std::string::npos) << "no point yet";
  desktop_->button(true, kObjectX, kObjectY);
  double peak = 0;
  for (int tries = 0; tries < 1000 && peak == 0; ++tries) {
    desktop_->wait();
    peak = run(1);
  }
  peak = std::max(peak, run(6));
  if (const char* const path = std::getenv("RINGDOWN_WINDOW_PICTURE")) {
    for (int i = 0; i < 12; ++i) {  // as long as it takes until a picture of the sound is drawn
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      run(1);
    }
    desktop_->write(path);
  }
  desktop_->button(false, kObjectX, kObjectY);
  EXPECT_GT(peak, 1e-3);
  const std::string session = host_->save();
  EXPECT_NE(session.find(" vibraphone-key"), std::string::npos) << "the point belongs to the object";
  const auto other = GetParam().open();
  EXPECT_TRUE(other->load(session));
  EXPECT_NE(other->save().find(" vibraphone-key"), std::string::npos) << "sessions keep it";
  host_->close_window();
}

TEST_P(PluginWindow, AClickWithShiftSetsTheSecondStrikePoint) {
  open();
  run(3);
  settle();
  const auto points = [&] {
    const std::string session = host_->save();
    int count = 0;
    for (std::size_t at = session.find(kPoint); at != session.npos; at = session.find(kPoint, at + 1)) ++count;
    return count;
  };
  for (const unsigned modifier : {unsigned{ShiftMask}, 0U}) {
    for (const bool press : {true, false}) desktop_->button(press, kObjectX, kObjectY, modifier);
  }
  for (int tries = 0; tries < 1000 && points() < 2; ++tries) {
    desktop_->wait();
    run(1);
  }
  EXPECT_EQ(points(), 2) << "no click is lost between two pictures";
  host_->close_window();
}

TEST_P(PluginWindow, AClickOnAPictureChoosesTheMallet) {
  open();
  run(1);
  settle();
  for (const auto& [mallet, x] : {std::pair{6, kMalletsX + 6 * kMalletWidth}, {1, kMalletsX + kMalletWidth}}) {
    desktop_->button(true, x, kMalletsY);
    settle();
    desktop_->button(false, x, kMalletsY);
    settle();
    run(1);
    EXPECT_EQ(host_->parameter(kMallet), mallet);
  }
  host_->close_window();
}

// By the protocol by which a file manager of a desktop drops files. A blank in a path is "%20" in a URI.
TEST_P(PluginWindow, ADroppedBankIsPlayed) {
  const TemporaryFolder folder;
  const std::filesystem::path bank = folder / "my bell.glb";
  std::filesystem::copy_file(RINGDOWN_SOURCE_DIR "/presets/banks/coin.glb", bank);
  open();
  run(1);
  settle();
  host_->set_parameter(kObject, kVibraphoneKey);
  std::string uri = bank.string();
  uri.replace(uri.find(' '), 1, "%20");
  {
    const ringdown::viewer::FileDrop drop(desktop_->child(), uri);
    for (int tries = 0; tries < 20000 && !drop.is_taken(); ++tries) {
      desktop_->wait();
      host_->idle_window();
    }
    EXPECT_TRUE(drop.is_taken());
  }
  for (int tries = 0; tries < 100 && host_->save().find(bank.string()) == std::string::npos; ++tries) run(1);
  EXPECT_NE(host_->save().find(bank.string()), std::string::npos);
  EXPECT_EQ(host_->parameter(kObject), 0) << "the file is chosen";
  host_->close_window();
}

constexpr const char* kBrick = R"(v 0 0 0
v 0.1 0 0
v 0.1 0.05 0
v 0 0.05 0
v 0 0 0.03
v 0.1 0 0.03
v 0.1 0.05 0.03
v 0 0.05 0.03
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

class MeshOnPluginWindow : public PluginWindow {};
INSTANTIATE_TEST_SUITE_P(, MeshOnPluginWindow, testing::Values(Format{"clap", open_clap}),
                         [](const auto& format) { return std::string(format.param.name); });

TEST_P(MeshOnPluginWindow, IsBakedInTheMaterialThatTheWindowAsksForAndPlayed) {
  const TemporaryFolder folder;
  setenv("XDG_DATA_HOME", (folder / "data").c_str(), 1);
  const std::filesystem::path mesh = folder.write("brick.obj", kBrick);
  open();
  run(1);
  settle();
  {
    const ringdown::viewer::FileDrop drop(desktop_->child(), mesh);
    for (int tries = 0; tries < 20000 && !drop.is_taken(); ++tries) {
      desktop_->wait();
      host_->idle_window();
    }
    ASSERT_TRUE(drop.is_taken());
  }
  settle();
  if (const char* const path = std::getenv("RINGDOWN_DROP_PICTURE")) desktop_->write(path);
  desktop_->button(true, kBakeX, kBakeY);
  settle();
  desktop_->button(false, kBakeX, kBakeY);
  const std::string bank = (folder / "data/ringdown/banks/brick-steel-").string();
  for (int tries = 0; tries < 6000 && host_->save().find(bank) == std::string::npos; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    run(1);
  }
  EXPECT_NE(host_->save().find(bank), std::string::npos);
  EXPECT_EQ(host_->parameter(kObject), 0) << "the file is chosen";
  host_->close_window();
}

TEST_P(PluginWindow, LetsGoOfTheKeyThatTheMouseHoldsWhenItCloses) {
  open();
  run(3);
  settle();
  desktop_->button(true, kObjectX, kObjectY);
  double peak = 0;
  for (int tries = 0; tries < 1000 && peak == 0; ++tries) {
    desktop_->wait();
    peak = run(1);
  }
  EXPECT_GT(peak, 0);
  host_->close_window();
  desktop_->button(false, kObjectX, kObjectY);
  std::vector<float> left(kFrames), right(kFrames);
  for (int block = 0; block < 48; ++block) host_->render({}, left.data(), right.data(), kFrames);  // 0.5 s
  EXPECT_EQ(*std::ranges::max_element(left), 0) << "it is damped within 0.4 s";
}

// If a host does not let the window grow, its text and controls grow.
TEST_P(PluginWindow, KeepsItsScaleWhenItIsOpenedAgain) {
  const auto toolbar = [&] {
    run(3);
    settle();
    return desktop_->pixels(200, 0, 400, 60);
  };
  open();
  const auto plain = toolbar();
  for (const int y : {kScaleY, kScaleChoiceY}) {
    desktop_->button(true, kScaleX, y);
    settle();
    desktop_->button(false, kScaleX, y);
    settle();
  }
  const auto chosen = toolbar();
  EXPECT_NE(chosen, plain);
  host_->close_window();
  const auto comes_back = [&] {
    for (int tries = 0; tries < 20; ++tries) {  // until the window has grown, too
      if (toolbar() == chosen) return true;
    }
    return false;
  };
  open();
  EXPECT_TRUE(comes_back());
  host_->close_window();
  const std::string session = host_->save();
  host_ = GetParam().open();
  EXPECT_TRUE(host_->load(session));
  host_->activate(48000);
  open();
  EXPECT_TRUE(comes_back()) << "sessions keep it";
  host_->close_window();
}

// Returns the second strike point of a session: the last seven numbers before the object's name.
Rig::Place second_point_of(const std::string& session) {
  const std::size_t end = session.rfind(kPoint);
  const std::size_t before = end == session.npos ? end : session.find_last_not_of("0123456789.e+- ", end);
  if (before == session.npos) return {};
  std::istringstream text(session.substr(before + 1, end - before - 1));
  const std::vector<double> numbers{std::istream_iterator<double>(text), {}};
  if (numbers.size() < 7) return {};
  const double* const at = &numbers[numbers.size() - 7];
  return {{at[0], at[1], at[2]}, {at[3], at[4], at[5]}};
}

TEST_P(PluginWindow, TheSoundIsTheLibrarysWhileItIsOpenAndAfterItHasClosed) {
  open();
  run(3);
  settle();
  desktop_->button(true, kObjectX, kObjectY, ShiftMask);
  for (int tries = 0; tries < 1000 && host_->save().find(kPoint) == std::string::npos; ++tries) {
    desktop_->wait();
    run(1);
  }
  desktop_->button(false, kObjectX, kObjectY, ShiftMask);
  settle();
  run(20);
  const Rig::Place second = second_point_of(host_->save());
  EXPECT_NE(second.direction, Rig::Place{}.direction);
  std::vector<Rig> rigs;
  for (const int mallet : {0, 2, 5, 6}) rigs.push_back({kVibraphoneKey, "vibraphone-key", 72, mallet, second});
  rigs.push_back({});  // another object, to which the points do not belong
  rigs.push_back(rigs.front());
  host_->deactivate();
  set_plain(*host_);
  host_->set_parameter(kObject, kVibraphoneKey);
  host_->set_parameter(kRootKey, 72);
  host_->activate(48000);  // silent
  EXPECT_LT(largest_difference_db(*host_, rigs, [&] { host_->idle_window(); }), -120) << "open";
  host_->close_window();
  host_->activate(48000);
  EXPECT_LT(largest_difference_db(*host_, rigs), -120) << "closed";
}

TEST_P(PluginWindow, ThatIsSilentDrawsNothingAndCostsLittle) {
  open();
  const int before = settle();
  EXPECT_GT(before, 0);
  constexpr int kIdles = 600;  // of a host's timer of 16 ms: 9.6 s
  const std::clock_t begin = std::clock();
  for (int i = 0; i < kIdles; ++i) host_->idle_window();
  const double cost_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  EXPECT_EQ(pictures - before, 0);
  EXPECT_LT(cost_s / (kIdles * 0.016), 0.01) << "of a core";
  std::printf("%s costs %.2f %% of a core\n", GetParam().name, 100 * cost_s / (kIdles * 0.016));
  host_->close_window();
}

// Drivers and libraries keep what they make once, and their tables grow now and then, so the lower quartile over the
// openings counts: a window that keeps something of its own keeps it each time. Each is closed when everything is
// drawn, so that all openings do the same on a busy machine, too. libGL and Mesa's compiler keep some 170 bytes.
// RINGDOWN_WINDOW_OPENINGS=1000 is the long form, in which the mean counts, too.
TEST_P(PluginWindow, OpensAndClosesWithoutKeepingMemory) {
  const char* const wanted = std::getenv("RINGDOWN_WINDOW_OPENINGS");
  const int openings = wanted ? std::max(8, std::atoi(wanted)) : 8;
  if (bytes_from_malloc() == 0) GTEST_SKIP() << "a sanitizer's malloc is not counted";
  std::vector<double> in_use;
  for (int i = 0; i < 3 + openings; ++i) {
    open();
    settle();
    host_->close_window();
    if (i >= 2) in_use.push_back(static_cast<double>(bytes_from_malloc()));
  }
  std::vector<double> kept;
  for (std::size_t i = 1; i < in_use.size(); ++i) kept.push_back(in_use[i] - in_use[i - 1]);
  std::ranges::nth_element(kept, kept.begin() + openings / 4);
  const double quartile = kept[static_cast<std::size_t>(openings / 4)];
  const double mean = (in_use.back() - in_use.front()) / openings;
  EXPECT_LT(quartile, 512) << "bytes at each opening";
  if (wanted) {
    EXPECT_LT(mean, 512) << "bytes at each opening";
  }
  std::printf("%s keeps %.0f bytes at each opening, %.0f in the mean\n", GetParam().name, quartile, mean);
  EXPECT_EQ(desktop_->child(), 0U);
}

}  // namespace
