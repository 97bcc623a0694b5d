#include "clients/viewer/screenshot.h"

#include "clients/viewer/app.h"
#include "clients/viewer/local_daemon.h"

#include <algorithm>
#include <chrono>

namespace ringdown::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPatience_s = 60;

bool has_bank(const KnownObject* object) { return object && (object->bank || !object->bank_fault.empty()); }

// The scene is described, and the bank of every object that a body plays is here or will never be.
bool is_complete(const Model& model) {
  const auto is_seen = [&](const auto& entry) {
    const std::string& object = entry.second.object;
    return object.empty() || has_bank(model.object(object));
  };
  const KnownScene& scene = model.scene();
  return scene.described() && scene.description().file && !scene.bodies().empty() &&
         std::ranges::all_of(scene.bodies(), is_seen);
}

std::optional<std::string> refusal(const Model& model) {
  const auto failed = std::ranges::find_if(model.messages(), [](const KnownMessage& message) {
    return message.failed && message.address.starts_with("/scene/");
  });
  return failed == model.messages().end() ? std::nullopt : std::optional(failed->sentence);
}

// Draws frames until `holds`; an error when the user, the daemon or the clock ends that.
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

}  // namespace

Result<void> take_screenshot(const ScreenshotRequest& request, const Settings& settings) {
  std::error_code error;
  if (!request.daemon && !std::filesystem::is_regular_file(request.scene, error)) {
    return fail(ErrorKind::bad_input, "there is no scene " + request.scene.string());
  }
  std::optional<LocalDaemon> own;
  if (!request.daemon) {
    auto started = LocalDaemon::start(request.scene);
    if (!started) return fail(started.error());
    own.emplace(std::move(*started));
  }
  auto window = Window::open({static_cast<int>(settings.width), static_cast<int>(settings.height), false,
                              settings.scale > 0 ? settings.scale : 1});
  if (!window) return fail(window.error());
  auto renderer = SceneRenderer::create();
  if (!renderer) return fail(renderer.error());
  App app(std::move(*window), std::move(*renderer), settings,
          {own ? own->url() : *request.daemon, std::nullopt, request.only, std::nullopt});

  const auto connected = [&] { return app.client().state().kind == ConnectionState::Kind::connected; };
  if (auto good = draw_until(app, request, kPatience_s, "no daemon answers", connected); !good) return good;
  // It waits at its beginning until everything that is to be seen is here.
  // A daemon that runs already finds it where it was started, perhaps on another computer.
  app.commands().load_scene((own ? std::filesystem::absolute(request.scene) : request.scene).string());
  app.client().send(protocol::ScenePause{true});
  const auto paused = [&] { return is_complete(app.model()) && app.model().scene().paused(); };
  if (auto good = draw_until(app, request, kPatience_s, "the scene did not come", paused); !good) return good;
  app.client().send(protocol::ScenePause{false});
  const auto arrived = [&] { return app.model().scene().told_time_s() >= request.at_s; };
  if (auto good = draw_until(app, request, request.at_s + kPatience_s, "the scene did not get that far", arrived);
      !good) {
    return good;
  }
  app.show_at(request.at_s);
  app.draw();
  return write_png(app.window().read_pixels(), request.output);
}

}  // namespace ringdown::viewer
