// A window on a display of its own, a daemon on a JACK server of its own, and a relay between them that overhears.
#pragma once

#include "clients/viewer/app.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/virtual_display.h"
#include "tests/viewer/lossy_relay.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::viewer {

using namespace ringdown::test;
using namespace std::chrono_literals;

inline const std::string kPresets = RINGDOWN_SOURCE_DIR "/presets";

// A bell that hangs in the middle of the picture, a silent block on the ground.
inline std::string scene_text() {
  return R"([scene]
[[object]]
name = "bell"
bank = ")" +
         kPresets + R"(/banks/bronze-bell.glb"
[camera]
position_m = [0, -1.5, 0.6]
target_m = [0, 0, 0.5]
field_of_view_degrees = 40
[[static]]
name = "floor"
shape = "plane"
[[body]]
name = "bell"
object = "bell"
shape = "convex"
position_m = [0, 0, 0.45]
fixed = true
[[body]]
name = "block"
shape = "box"
size_m = [0.1, 0.1, 0.1]
density_kg_m3 = 2000
position_m = [0.4, 0, 0.05]
)";
}

inline std::string at(std::uint16_t port) { return "osc.udp://127.0.0.1:" + std::to_string(port); }

// A window on a display of its own and a daemon on a JACK server of its own.
class Studio {
 public:
  Studio()
      : scene_(folder_.write("scene.toml", scene_text())),
        jack_runs_(jack_.runs()),
        daemon_({"--scene", scene_.string()}, jack_.environment()),
        relay_(daemon_.port(), 0) {
    setenv("XDG_DATA_HOME", (folder_ / "data").c_str(), 1);  // for banks of dropped files
    auto window = Window::open({900, 520, true, 1});
    if (!window) throw std::runtime_error(window.error().message);
    auto renderer = SceneRenderer::create();
    if (!renderer) throw std::runtime_error(renderer.error().message);
    app_.emplace(std::move(*window), std::move(*renderer), Settings{},
                 App::Options{at(relay_.port()), std::nullopt, Pane::any, std::nullopt});
  }

  App& app() { return *app_; }
  Daemon& daemon() { return daemon_; }
  LossyRelay& relay() { return relay_; }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }  // where the daemon may write

  // Draws frames until it holds; false after the limit.
  template <class Condition>
  bool until(Condition holds, std::chrono::seconds limit = kPatience) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!holds()) {
      if (std::chrono::steady_clock::now() > end) return false;
      app_->frame();
    }
    return true;
  }
  bool ready() {
    return jack_runs_ && daemon_.ready() && until([&] {
             const Model& model = app_->model();
             const KnownObject* bell = model.object("bell");
             return bell && bell->bank && app_->scene_view().stage().contents().items.size() == 2;
           });
  }

  // For a failure's message.
  std::string condition() {
    const Model& model = app_->model();
    std::string text = app_->client().state().sentence + " " +
                       std::to_string(app_->scene_view().stage().contents().items.size()) + " bodies are shown, of " +
                       std::to_string(model.scene().bodies().size()) + "; objects:";
    for (const auto& [name, object] : model.objects()) {
      text += " " + name + (object.bank ? " with" : " without") + " bank" + object.bank_fault;
    }
    for (const KnownMessage& message : model.messages()) text += "; " + message.sentence;
    return text + "\n" + daemon_.process().output();
  }

  // Runs xdotool, while frames go on.
  void act(std::vector<std::string> words) {
    words.insert(words.begin(), "xdotool");
    Process tool(words);
    EXPECT_TRUE(until([&] { return tool.wait(0ms).has_value(); })) << words[1];
    EXPECT_EQ(tool.wait(0ms), 0) << tool.output();
  }
  void take_focus() { act({"search", "--sync", "--name", "^Ringdown$", "windowfocus", "--sync"}); }
  void press(const std::string& key) { act({"key", key}); }

  // A key or button, down for a few frames, as a hand does it: ImGui looks at what is down once a frame.
  void hold(const std::vector<std::string>& key_or_click) {
    const std::string kind = key_or_click[0] == "key" ? "key" : "mouse";
    for (const char* way : {"down", "up"}) {
      act({kind + way, key_or_click[1]});
      for (int i = 0; i < 3; ++i) app_->frame();
    }
  }

  // Drags with the left button, in steps, while `modifier` is down, if there is one. Each input is seen by a frame
  // before the next one is made, so that a slow machine cannot merge them.
  void drag(const std::string& x, const std::string& y, int steps, int step_x, int step_y,
            const std::string& modifier = "") {
    const ImGuiIO& io = ImGui::GetIO();
    const auto shown = [&](const std::vector<std::string>& input, auto seen) {
      act(input);
      EXPECT_TRUE(until(seen)) << input[0] << " is not seen; " << condition();
    };
    take_focus();
    const auto modified = [&] { return io.KeyShift || io.KeyCtrl || io.KeyAlt; };
    if (!modifier.empty()) shown({"keydown", modifier}, modified);
    shown({"mousemove", x, y},
          [&] { return std::abs(io.MousePos.x - std::stof(x)) < 2 && std::abs(io.MousePos.y - std::stof(y)) < 2; });
    shown({"mousedown", "1"}, [&] { return io.MouseDown[0]; });
    for (int i = 0; i < steps; ++i) {
      const ImVec2 before = io.MousePos;
      shown({"mousemove_relative", "--", std::to_string(step_x), std::to_string(step_y)},
            [&] { return io.MousePos.x != before.x || io.MousePos.y != before.y; });
    }
    shown({"mouseup", "1"}, [&] { return !io.MouseDown[0]; });
    if (!modifier.empty()) shown({"keyup", modifier}, [&] { return !modified(); });
  }

  template <class Kind>
  bool asks() {
    return until([&] { return !relay_.asked<Kind>().empty(); });
  }
  // The daemon's own word.
  protocol::StatusReply status() {
    const auto reply = daemon_.ask(protocol::format(protocol::Request(protocol::Status{})));
    const auto* status = reply ? reply->get_if<protocol::StatusReply>() : nullptr;
    return status ? *status : protocol::StatusReply{.objects = -1, .bodies = -1};
  }
  protocol::ObjectReply bell() {
    const auto reply = daemon_.ask(protocol::format(protocol::Request(protocol::DescribeObject{{"bell", {}}})));
    const auto* object = reply ? reply->get_if<protocol::ObjectReply>() : nullptr;
    return object ? *object : protocol::ObjectReply{};
  }
  // A key of the pane that has the focus, and what the daemon then says of the bell.
  template <class Holds>
  ::testing::AssertionResult changes_bell(const std::string& key, Holds holds) {
    press(key);
    if (until([&] { return holds(bell()); })) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "key " << key;
  }

 private:
  TemporaryFolder folder_;
  VirtualDisplay display_;
  std::filesystem::path scene_;
  JackServer jack_;
  bool jack_runs_;
  Daemon daemon_;
  LossyRelay relay_;
  std::optional<App> app_;
};

#define OPEN_STUDIO(studio)                                                                            \
  if (!installed("Xvfb") || !installed("xdotool")) GTEST_SKIP() << "Xvfb or xdotool is not installed"; \
  if (!installed("jackd")) GTEST_SKIP() << "jackd is not installed";                                   \
  Studio studio;                                                                                       \
  ASSERT_TRUE(studio.ready()) << studio.condition();                                                   \
  studio.take_focus()

}  // namespace ringdown::viewer
