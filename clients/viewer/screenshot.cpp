#include "clients/viewer/screenshot.h"

#include "clients/viewer/app.h"
#include "engine/base/process/child_process.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>

namespace ringdown::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPatience_s = 60;
constexpr int kAttempts = 3;

constexpr std::string_view kReady = "ready: OSC on ";

// A daemon that the viewer starts for itself, without a sound card, and ends with the object. A thread reads its log.
class LocalDaemon {
 public:
  // Starts the `ringdownd` beside this program on a free port, and waits until it is ready. The daemon may read `scene`
  // and the files that `scene` names. Fails with the last line of the daemon's log.
  static Result<std::unique_ptr<LocalDaemon>> start(const std::filesystem::path& scene) {
    const auto program = find_beside("ringdownd");
    if (!program) return fail(program);
    auto daemon = std::make_unique<LocalDaemon>();
    auto ready = daemon->ready_.get_future();
    daemon->thread_ = std::jthread([&own = *daemon, program = *program, scene] { own.run(program, scene); });
    auto url = ready.get();
    if (!url) return fail(url);
    daemon->url_ = *url;
    return daemon;
  }
  LocalDaemon() = default;
  LocalDaemon(const LocalDaemon&) = delete;
  LocalDaemon& operator=(const LocalDaemon&) = delete;
  ~LocalDaemon() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] const std::string& url() const { return url_; }

 private:
  void report(Result<std::string> outcome) {
    if (!std::exchange(reported_, true)) ready_.set_value(std::move(outcome));
  }

  void take_line(std::string_view line) {
    last_line_ = line;
    const auto at = line.find(kReady);
    if (at == line.npos) return;
    const std::string_view rest = line.substr(at + kReady.size());
    report("osc.udp://" + std::string(rest.substr(0, rest.find(','))));
  }

  void run(const std::filesystem::path& program, const std::filesystem::path& scene) {
    // The daemon logs to standard error, but run_child() hands out lines of standard output.
    const auto done = run_child({.command = {"/bin/sh", "-c", "exec \"$0\" \"$@\" 2>&1", program.string(), "--driver",
                                             "null", "--port", "0", "--scene", scene.string()},
                                 .on_line = [this](std::string_view line) { take_line(line); },
                                 .keep_going = [this] { return !stop_; }});
    report(done ? fail(ErrorKind::refused, last_line_) : fail(done));
  }

  std::string url_;
  std::atomic<bool> stop_ = false;
  std::promise<Result<std::string>> ready_;
  bool reported_ = false;  // the thread's, like last_line_
  std::string last_line_;
  std::jthread thread_;
};

// The sentence with which the daemon refused something about the scene.
std::optional<std::string> refusal(const Model& model) {
  const auto failed = std::ranges::find_if(model.messages(), [](const KnownMessage& message) {
    return message.failed && message.address.starts_with("/scene/");
  });
  return failed == model.messages().end() ? std::nullopt : std::optional(failed->sentence);
}

// Draws frames until `holds` returns true. Fails when the user cancels, the daemon refuses, or `patience_s` have
// passed.
Result<void> draw_until(App& app, const ScreenshotRequest& request, double patience_s, const char* what,
                        const std::function<bool()>& holds) {
  const auto end = Clock::now() + std::chrono::duration<double>(patience_s);
  while (!holds()) {
    if (!request.keep_going()) return fail(ErrorKind::cancelled, "cancelled: no picture was written");
    if (const auto why = refusal(app.model())) return fail(ErrorKind::refused, *why);
    if (Clock::now() > end) return fail(ErrorKind::refused, std::string("no picture was written: ") + what);
    app.frame();
  }
  return {};
}

bool connected(const App& app) { return app.client().state().kind == ConnectionState::Kind::connected; }

// Loads the scene, waits in it at time 0 until everything that should be visible is here, and plays it until `at_s`.
Result<void> play_until_then(App& app, const ScreenshotRequest& request, const std::filesystem::path& scene) {
  if (auto good = draw_until(app, request, kPatience_s, "no daemon answers", [&] { return connected(app); }); !good) {
    return good;
  }
  app.client().send(protocol::SceneLoad{scene.string(), true});
  const auto paused = [&] {
    const Model& model = app.model();
    return model.has_whole_scene() && !model.scene().bodies().empty() && model.scene().paused();
  };
  if (auto good = draw_until(app, request, kPatience_s, "the scene was not loaded in time", paused); !good) return good;
  app.client().send(protocol::ScenePause{false});
  const auto arrived = [&] { return app.model().scene().reported_time_s() >= request.at_s; };
  return draw_until(app, request, request.at_s + kPatience_s, "the scene did not reach the time of the picture",
                    arrived);
}

}  // namespace

Result<void> take_screenshot(const ScreenshotRequest& request, const Settings& settings) {
  std::error_code error;
  if (!request.daemon && !std::filesystem::is_regular_file(request.scene, error)) {
    return fail(ErrorKind::bad_input, "there is no scene " + request.scene.string());
  }
  std::unique_ptr<LocalDaemon> own;
  if (!request.daemon) {
    auto started = LocalDaemon::start(request.scene);
    if (!started) return fail(started);
    own = std::move(*started);
  }
  auto window = Window::open({static_cast<int>(settings.width), static_cast<int>(settings.height), false,
                              settings.scale > 0 ? settings.scale : 1});
  if (!window) return fail(window);
  auto renderer = SceneRenderer::create();
  if (!renderer) return fail(renderer);
  App app(std::move(*window), std::move(*renderer), settings,
          {own ? own->url() : *request.daemon, std::nullopt, request.only, std::nullopt});
  // A daemon that was already running resolves the path itself, perhaps on another computer.
  const auto scene = own ? std::filesystem::absolute(request.scene) : request.scene;
  // On a machine that is too busy the daemon may seem to have gone; the model then starts empty.
  bool complete = false;
  for (int attempt = 0; attempt < kAttempts && !complete; ++attempt) {
    app.show_at(std::nullopt);
    if (auto good = play_until_then(app, request, scene); !good) return good;
    app.show_at(request.at_s);
    app.draw();
    complete = connected(app) && app.model().has_whole_scene();
  }
  if (!complete) return fail(ErrorKind::refused, "no picture was written: the daemon stopped answering");
  return write_png(app.window().read_pixels(), request.output);
}

}  // namespace ringdown::viewer
