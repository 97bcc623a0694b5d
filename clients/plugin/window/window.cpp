// The window as DPF wants it, compiled once for every plug-in format: passes events to ImGui, draws MainPanel, and
// carries its edits to the host.
//
// The plug-in and its window share no memory, because LV2 hosts may run them in two processes. Parameters, the states
// "file", "point", "second_point" and "window_scale", and notes are all that passes between them.
//
// DRAWING. A picture is drawn when something has changed: after an event or an edit, while something rings, and while a
// held peak is to fall. A silent window that nobody touches draws nothing.
#include "clients/plugin/vst3_notes.h"
#include "clients/plugin/window/file_drops.h"
#include "clients/plugin/window/main_panel.h"
#include "clients/viewer/panels/font.h"
#include "clients/viewer/panels/skin.h"
#include "engine/base/formatted.h"
#include "engine/base/result.h"

#include <DistrhoPluginUtils.hpp>
#include <DistrhoUI.hpp>

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

START_NAMESPACE_DISTRHO

namespace {

using ringdown::plugin::HostLink;
using ringdown::plugin::kPointStates;
using ringdown::plugin::MainPanel;
using ringdown::plugin::Parameter;
using ringdown::plugin::Which;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kButtons = 3;        // left, right, middle
constexpr int kSettling = 3;               // pictures after an event, until ImGui shows all that follows from it
constexpr double kMovingPeriod_s = 0.033;  // between pictures while something rings
constexpr std::uint64_t kNoteDelay = 2;    // idle calls, in which a state reaches the plug-in before the note
constexpr double kMinScale = 0.5, kMaxScale = 4;
constexpr const char* kScaleState = "window_scale";
constexpr uint kMinWidth = 700, kMinHeight = 380;

// ImGui has room for 512 numbers of keys: ASCII, and from 256 on DPF's special keys.
int number_of(uint key) {
  if (key < 128) return static_cast<int>(key);
  const uint special = key - kKeyF1;
  return key >= kKeyF1 && special < 256 ? static_cast<int>(256 + special) : -1;
}

void name_keys(ImGuiIO& io) {
  constexpr std::array<std::pair<ImGuiKey, uint>, 19> kNames = {{{ImGuiKey_Tab, '\t'},
                                                                 {ImGuiKey_LeftArrow, kKeyLeft},
                                                                 {ImGuiKey_RightArrow, kKeyRight},
                                                                 {ImGuiKey_UpArrow, kKeyUp},
                                                                 {ImGuiKey_DownArrow, kKeyDown},
                                                                 {ImGuiKey_PageUp, kKeyPageUp},
                                                                 {ImGuiKey_PageDown, kKeyPageDown},
                                                                 {ImGuiKey_Home, kKeyHome},
                                                                 {ImGuiKey_End, kKeyEnd},
                                                                 {ImGuiKey_Delete, kKeyDelete},
                                                                 {ImGuiKey_Backspace, kKeyBackspace},
                                                                 {ImGuiKey_Enter, '\r'},
                                                                 {ImGuiKey_Escape, kKeyEscape},
                                                                 {ImGuiKey_A, 'a'},
                                                                 {ImGuiKey_C, 'c'},
                                                                 {ImGuiKey_V, 'v'},
                                                                 {ImGuiKey_X, 'x'},
                                                                 {ImGuiKey_Y, 'y'},
                                                                 {ImGuiKey_Z, 'z'}}};
  for (const auto& [name, key] : kNames) io.KeyMap[name] = number_of(key);
}

// The class collects what the mouse does between two pictures, because ImGui sees one change of each button in a
// picture.
class Mouse {
 public:
  using Point = DGL_NAMESPACE::Point<double>;  // in pixels

  void move(const Point& to) { at_ = to; }
  void click(const UI::MouseEvent& event) {
    clicks_.push_back({event.button - 1, event.press, (event.mod & kModifierShift) != 0, event.pos});
  }
  // Gives ImGui the clicks up to the second change of a button; the rest waits for the next picture. Returns whether
  // there were any.
  bool give_to(ImGuiIO& io) {
    const bool any = !clicks_.empty();
    Point at = at_;
    std::array<bool, kButtons> has_changed{};
    for (; !clicks_.empty() && !has_changed[clicks_.front().button]; clicks_.pop_front()) {
      const Click& click = clicks_.front();
      has_changed[click.button] = true;
      io.MouseDown[click.button] = click.press;
      // The key, too: ImGui 1.90 forgets modifiers for as long as no key has ever been down.
      io.KeyShift = io.KeysDown[number_of(kKeyShift)] = click.shift;
      at = click.at;
    }
    io.MousePos = {static_cast<float>(at.getX()), static_cast<float>(at.getY())};
    return any;
  }

 private:
  struct Click {
    std::size_t button;
    bool press, shift;
    Point at;
  };
  std::deque<Click> clicks_;
  Point at_{-1.0, -1.0};  // outside until it moves
};

class RingdownWindow : public UI, private HostLink {
 public:
  RingdownWindow() : panel_(*this, getBinaryFilename()), scale_(std::clamp(getScaleFactor(), kMinScale, kMaxScale)) {
    setGeometryConstraints(kMinWidth, kMinHeight);
    if (scale_ != 1) resize_by(scale_);
    imgui_ = ImGui::CreateContext();
    enter();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.ConfigInputTextCursorBlink = false;
    name_keys(io);
    windows().push_back(this);
    ringdown::plugin::let_go_of_keys() = [] {
      for (RingdownWindow* window : windows()) window->let_go();
    };
  }
  ~RingdownWindow() override {
    let_go();
    std::erase(windows(), this);
    enter();
    if (has_renderer_) ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext(imgui_);
  }

 protected:
  // Events from the host

  void parameterChanged(std::uint32_t index, float value) override {
    if (index == static_cast<std::uint32_t>(Parameter::level)) return panel_.on_level(static_cast<double>(value));
    panel_.edits().on_parameter(index, value);
    wake();
  }
  void stateChanged(const char* key, const char* value) override {
    for (std::size_t i = 0; i < kPointStates.size(); ++i) {
      if (std::string_view(key) == kPointStates[i]) panel_.edits().on_point(static_cast<Which>(i), value);
    }
    if (std::string_view(key) == "file") panel_.edits().on_file(ringdown::plugin::file_of_state(value));
    if (std::string_view(key) == kScaleState) kept_scale_ = std::strtod(value, nullptr);
    wake();
  }
  void uiScaleFactorChanged(double scale) override {
    scale_ = std::clamp(scale, kMinScale, kMaxScale);
    wake();
  }
  void uiFileBrowserSelected(const char* path) override {
    if (path) panel_.edits().play_file(path);
    wake();
  }

  void uiIdle() override {
    ++idles_;
    for (; !notes_.empty() && notes_.front().at <= idles_; notes_.pop_front()) {
      sendNote(0, notes_.front().key, notes_.front().velocity);
    }
    if (drawn_at_s_ >= 0) scale_to(std::exchange(kept_scale_, 0));
    for (const auto& file : ringdown::plugin::take_dropped_files(getWindow().getNativeWindowHandle())) {
      panel_.drop(file);
      wake();
    }
    const bool is_due = panel_.is_moving() && now_s() - drawn_at_s_ >= kMovingPeriod_s;
    if (settling_ > 0 || is_due) repaint();
  }

  void onResize(const ResizeEvent& event) override {
    UI::onResize(event);
    wake();
  }

  void onDisplay() override {
    enter();
    prepare_renderer();
    const double time_s = now_s();
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(getWidth()), static_cast<float>(getHeight())};
    io.DeltaTime = static_cast<float>(std::clamp(time_s - drawn_at_s_, 1e-3, 0.1));
    drawn_at_s_ = time_s;
    settling_ = std::max(0, settling_ - 1);
    if (mouse_.give_to(io)) wake();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    panel_.draw(io.DisplaySize.x, io.DisplaySize.y, scale_, time_s);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }

  // Events from the user

  bool onMouse(const MouseEvent& event) override {
    enter();
    if (event.button < 1 || event.button > kButtons) return false;
    move_mouse(event.pos);
    mouse_.click(event);
    return true;
  }
  bool onMotion(const MotionEvent& event) override {
    enter();
    move_mouse(event.pos);
    return true;
  }
  bool onScroll(const ScrollEvent& event) override {
    enter();
    move_mouse(event.pos);
    ImGui::GetIO().MouseWheel += static_cast<float>(event.delta.getY());
    ImGui::GetIO().MouseWheelH += static_cast<float>(event.delta.getX());
    return true;
  }
  bool onKeyboard(const KeyboardEvent& event) override {
    enter();
    ImGuiIO& io = ImGui::GetIO();
    io.KeyCtrl = (event.mod & kModifierControl) != 0;
    io.KeyShift = (event.mod & kModifierShift) != 0;
    io.KeyAlt = (event.mod & kModifierAlt) != 0;
    if (const int number = number_of(event.key); number >= 0) io.KeysDown[number] = event.press;
    wake();
    return io.WantCaptureKeyboard || io.KeyCtrl;  // what the window does not use is the host's: space starts it
  }
  bool onCharacterInput(const CharacterInputEvent& event) override {
    enter();
    if ((event.mod & (kModifierControl | kModifierAlt)) == 0) ImGui::GetIO().AddInputCharactersUTF8(event.string);
    wake();
    return ImGui::GetIO().WantTextInput;
  }

 private:
  // Requests of the panel

  void begin_edit(std::size_t parameter) override { editParameter(static_cast<std::uint32_t>(parameter), true); }
  void set_parameter(std::size_t parameter, float value) override {
    setParameterValue(static_cast<std::uint32_t>(parameter), value);
  }
  void end_edit(std::size_t parameter) override { editParameter(static_cast<std::uint32_t>(parameter), false); }
  void set_point(Which which, const std::string& text) override {
    setState(kPointStates[static_cast<std::size_t>(which)], text.c_str());
  }
  void set_file(const std::string& path) override { setState("file", path.c_str()); }
  void press_key(std::uint8_t key, std::uint8_t velocity) override {
    notes_.push_back({idles_ + kNoteDelay, key, velocity});
  }
  void release_key(std::uint8_t key) override { notes_.push_back({idles_ + kNoteDelay, key, 0}); }
  void browse_files() override {
    FileBrowserOptions options;
    options.title = "A bank (.glb) or a note map (.toml)";
    openFileBrowser(options);
  }
  void set_scale(double scale) override {
    scale_to(scale);
    setState(kScaleState, ringdown::formatted("{}", scale).c_str());
  }

  struct Note {
    std::uint64_t at;
    std::uint8_t key, velocity;
  };

  static std::vector<RingdownWindow*>& windows() {
    static std::vector<RingdownWindow*> open;
    return open;
  }
  // Releases the key that the mouse holds. Once: the host may be gone after the first call.
  void let_go() {
    panel_.release_key();
    for (const Note& note : notes_) {
      if (note.velocity == 0) sendNote(0, note.key, 0);
    }
    notes_.clear();
  }

  void enter() { ImGui::SetCurrentContext(imgui_); }
  void wake() { settling_ = kSettling; }
  [[nodiscard]] double now_s() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  // Ignores a scale that nobody chose, which is 0.
  void scale_to(double scale) {
    if (!(scale >= kMinScale && scale <= kMaxScale) || scale == scale_) return;
    resize_by(scale / scale_);
    scale_ = scale;
    wake();
  }
  void resize_by(double factor) {
    setSize(static_cast<uint>(std::lround(getWidth() * factor)), static_cast<uint>(std::lround(getHeight() * factor)));
  }
  void move_mouse(const DGL_NAMESPACE::Point<double>& place) {
    mouse_.move(place);
    wake();
  }
  void prepare_renderer() {
    if (!has_renderer_) {
      ImGui_ImplOpenGL3_Init("#version 130");
      has_renderer_ = true;
    }
    if (shown_scale_ == scale_) return;
    shown_scale_ = scale_;
    ringdown::viewer::load_font(scale_);
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
    ringdown::viewer::apply(ringdown::viewer::make_skin(true), static_cast<float>(scale_));
  }

  MainPanel panel_;
  ImGuiContext* imgui_ = nullptr;
  bool has_renderer_ = false;
  double scale_, shown_scale_ = 0;  // of text and controls; that of the loaded font
  Mouse mouse_;
  std::deque<Note> notes_;
  std::uint64_t idles_ = 0;
  int settling_ = kSettling;
  double kept_scale_ = 0;  // of the session, which is to come
  Clock::time_point begin_ = Clock::now();
  double drawn_at_s_ = -1;

  DISTRHO_DECLARE_NON_COPYABLE_WITH_LEAK_DETECTOR(RingdownWindow)
};

}  // namespace

UI* createUI() { return new RingdownWindow; }

END_NAMESPACE_DISTRHO
