#include "clients/viewer/app.h"

#include "clients/viewer/panels/overlays.h"
#include "engine/base/process/child_process.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::viewer {
namespace {

using namespace std::chrono_literals;

constexpr auto kFramePeriod = std::chrono::microseconds(16600);
constexpr double kMinimised_s = 0.2;
constexpr double kMaxStep_s = 0.1;  // the longest time that a held key acts for in one frame

// Minimum widths of the panes, in heights of the text: no text of the side panes is cut at these widths. In a window
// too narrow for all three, the side panes become narrower still.
constexpr float kMinSide_em = 17, kMinSound_em = 20, kMinScene_em = 8;

}  // namespace

App::App(Window window, SceneRenderer renderer, const Settings& settings, Options options)
    : window_(std::move(window)),
      settings_(settings),
      options_(std::move(options)),
      skin_(make_skin(settings.dark)),
      client_(options_.daemon, kNotices_hz),
      model_(kNotices_hz),
      commands_(model_, [this](protocol::Request request) { client_.send(std::move(request)); }),
      scene_(std::move(renderer)),
      side_(options_.daemon),
      drops_(find_beside("ringdown-bake")) {
  commands_.choice().impulse_ns = settings.impulse_ns;
  commands_.choice().contact_time_s = settings.contact_time_s;
  focused_ = options_.only == Pane::sound ? Pane::sound : Pane::scene;
  focus_next_ = focused_;
}

double App::now_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

Settings App::settings() const {
  Settings settings = settings_;
  settings.daemon = options_.daemon;
  settings.impulse_ns = commands_.choice().impulse_ns;
  settings.contact_time_s = commands_.choice().contact_time_s;
  if (!window_.full_screen() && !window_.minimised()) {
    const auto natural = [&](int pixels, std::uint64_t min) {
      const auto size = static_cast<std::uint64_t>(std::lround(pixels / window_.display_scale()));
      return std::clamp(size, min, Settings::kMaxPixels);
    };
    settings.width = natural(window_.width(), Settings::kMinWidth);
    settings.height = natural(window_.height(), Settings::kMinHeight);
  }
  return settings;
}

void App::talk() {
  const double now = now_s();
  Batch batch = client_.take();
  if (batch.connection != connection_) {
    connection_ = batch.connection;
    model_.restart();
    commands_.restart();
    if (const auto scene = std::exchange(options_.scene, std::nullopt)) commands_.load_scene(*scene);
  }
  for (const protocol::Reply& reply : batch.replies) model_.apply(reply, now);
  model_.watch_sound(options_.only != Pane::scene);
  commands_.update(now);
  for (protocol::Request& request : model_.wants(now)) client_.send(std::move(request));
}

void App::perform(Action action) {
  switch (action) {
    case Action::quit:
      if (!std::exchange(help_, false)) runs_ = false;
      return;
    case Action::help:
      help_ = !help_;
      return;
    case Action::full_screen:
      return window_.set_full_screen(!window_.full_screen());
    case Action::theme:
      settings_.dark = !settings_.dark;
      skinned_scale_ = 0;
      return;
    case Action::listen:
      settings_.listen = !settings_.listen;
      return;
    case Action::next_pane:
      if (options_.only != Pane::any) return;
      focus_next_ = focused_ == Pane::scene ? Pane::sound : focused_ == Pane::sound ? Pane::side : Pane::scene;
      return;
    case Action::larger:
    case Action::smaller:
      settings_.scale = window_.scale() * (action == Action::larger ? 1.125 : 1 / 1.125);
      return window_.set_scale(settings_.scale);
    default:
      if (!scene_.perform(action, model_, commands_)) commands_.perform(action);
  }
}

void App::handle_keys(double seconds) {
  for (const auto& [key, repeated] : window_.take_keys()) {
    if (key == "escape" && popup_) continue;  // ImGui closes the popup
    const auto binding = binding_for(focused_, key);
    if (!binding || binding->while_down == WhileDown::continues || (repeated && binding->while_down == WhileDown::once))
      continue;
    perform(binding->action);
  }
  if (focused_ != Pane::scene) return;
  for (const Binding& binding : bindings()) {
    if (binding.while_down == WhileDown::continues && window_.is_down(binding.key))
      scene_.move(binding.action, std::min(seconds, kMaxStep_s));
  }
}

template <class Draw>
void App::pane(const char* name, Pane which, float x, float width, Draw draw) {
  ImGui::SetNextWindowPos({x, 0});
  ImGui::SetNextWindowSize({width, ImGui::GetIO().DisplaySize.y});
  auto flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
               ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing;
  if (which != Pane::side) flags |= ImGuiWindowFlags_NoNavInputs;
  const bool bare = which == Pane::scene;
  if (bare) ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin(name, nullptr, which == Pane::side ? flags & ~ImGuiWindowFlags_NoScrollbar : flags);
  if (bare) ImGui::PopStyleVar();
  if (focus_next_ == which) {
    ImGui::SetWindowFocus();
    focus_next_.reset();
  }
  if (ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows)) focused_ = which;
  draw();
  if (focused_ == which && options_.only == Pane::any) {
    const float height = ImGui::GetIO().DisplaySize.y, line = std::max(2.0f, ImGui::GetFontSize() / 7);
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->PushClipRect({x, 0}, {x + width, height});
    list->AddRect({x + line / 2, line / 2}, {x + width - line / 2, height - line / 2}, skin_.focus, 0, 0, line);
    list->PopClipRect();
  }
  ImGui::End();
}

void App::draw_panes() {
  const float width = ImGui::GetIO().DisplaySize.x;
  const bool all = options_.only == Pane::any;
  float left = 0, right = options_.only == Pane::sound ? width : 0;
  if (all) {
    const float em = ImGui::GetFontSize();
    left = std::max(width * static_cast<float>(settings_.side_share), kMinSide_em * em);
    right = std::max(width * static_cast<float>(settings_.sound_share), kMinSound_em * em);
    const float max = width - std::min(kMinScene_em * em, width / 3);
    const float shrink = std::min(1.0f, max / (left + right));
    left = std::floor(left * shrink);
    right = std::floor(right * shrink);  // ImGui puts windows at whole pixels
  }
  const double now = now_s();
  if (options_.only != Pane::sound) {
    pane("Scene", Pane::scene, left, width - left - right, [&] {
      scene_.draw(skin_, model_, commands_, settings_.strength_by_time, now, options_.shown_at_s);
      draw_notes(skin_, scene_.origin(), scene_.size(), model_.scene(), options_.shown_at_s);
      const ConnectionState state = client_.state();
      draw_welcome(skin_, scene_.origin(), scene_.size(), model_, state.kind == ConnectionState::Kind::connected);
      draw_connection(skin_, scene_.origin(), scene_.size(), state);
      for (const auto& bank : drops_.draw(skin_, scene_.origin(), scene_.size())) commands_.load_bank(bank.string());
    });
  }
  if (options_.only != Pane::scene) {
    pane("Sound", Pane::sound, width - right, right, [&] {
      sound_.draw(skin_, model_, commands_, !all);
      if (!all) draw_connection(skin_, {0, 0}, ImGui::GetIO().DisplaySize, client_.state());
    });
  }
  if (!all) return;
  pane("Side", Pane::side, 0, left, [&] {
    const std::string url = side_.draw(skin_, client_.state(), model_, commands_, settings_, scene_.camera());
    if (url.empty()) return;
    options_.daemon = url;
    client_.connect_to(url);
  });
  if (const auto share = drag_splitter("left splitter", left, left / width, 1)) settings_.side_share = *share;
  if (const auto share = drag_splitter("right splitter", width - right, right / width, -1)) {
    settings_.sound_share = *share;
  }
}

void App::take(const std::filesystem::path& dropped) {
  switch (kind_of_drop(dropped)) {
    case Dropped::bank:
      return commands_.load_bank(dropped.string());
    case Dropped::scene:
      return commands_.load_scene(dropped.string());
    case Dropped::object:
    case Dropped::mesh:
      return drops_.bake(dropped);
    case Dropped::unknown:
      return drops_.refuse(dropped, "a bank, a scene, an object file");
  }
}

void App::draw() {
  const double seconds = std::chrono::duration<double>(Clock::now() - last_frame_).count();
  last_frame_ = Clock::now();
  talk();
  if (skinned_scale_ != window_.scale()) {
    skin_ = make_skin(settings_.dark);
    apply(skin_, static_cast<float>(window_.scale()));
    skinned_scale_ = window_.scale();
  }
  window_.begin_frame();
  auto& flags = ImGui::GetIO().ConfigFlags;
  flags =
      focused_ == Pane::side ? flags | ImGuiConfigFlags_NavEnableKeyboard : flags & ~ImGuiConfigFlags_NavEnableKeyboard;
  handle_keys(seconds);
  for (const auto& file : window_.take_dropped()) take(file);
  const bool live = !options_.shown_at_s;
  scene_.set_detail(live ? detail_.detail() : 1);
  draw_panes();
  popup_ = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
  if (help_) help_ = draw_help(skin_);
  window_.end_frame();
  if (live) detail_.observe(std::chrono::duration<double>(Clock::now() - last_frame_).count());
}

void App::frame() {
  const auto due = last_frame_ + kFramePeriod;
  window_.wait(window_.minimised() ? kMinimised_s : 0);
  while (Clock::now() < due) {
    window_.wait(std::max(1e-4, std::chrono::duration<double>(due - Clock::now()).count()));
  }
  if (window_.minimised()) return talk();
  draw();
  if (connection_ == 0 || options_.only == Pane::sound) return;
  auto heard = listener_.update(scene_.camera(), settings_.listen, now_s(), commands_.edits().listener());
  if (heard) client_.send(std::move(*heard));
}

}  // namespace ringdown::viewer
