#include "clients/plugin/window/main_panel.h"

#include "clients/plugin/parameter_text.h"
#include "clients/plugin/window/mallet_row.h"
#include "clients/viewer/panels/skin.h"
#include "engine/base/file_format.h"
#include "engine/base/formatted.h"
#include "engine/base/note.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <system_error>

namespace ringdown::plugin {
namespace {

constexpr float kBrowser = 190, kControls = 330, kModes = 90, kMeter = 14;  // pixels at a scale of 1
constexpr double kSwing_hz = 1.2;                                           // slow enough to follow by eye
constexpr double kLowest_hz = 20, kHighest_hz = 20000;
constexpr std::array kScales = {1.0, 1.25, 1.5, 1.75, 2.0};

bool begin_column(const char* name, float width) { return ImGui::BeginChild(name, {width, 0}); }

// Returns $RINGDOWN_BAKE; otherwise bin/ringdown-bake in the folder of the plug-in or one of those above it, as it lies
// in a prefix and in a build; otherwise the name, which is then searched in PATH.
std::filesystem::path bake_near(const std::filesystem::path& binary) {
  if (const char* const given = std::getenv("RINGDOWN_BAKE")) return given;
  for (std::filesystem::path above = binary.parent_path(); above.has_relative_path(); above = above.parent_path()) {
    std::error_code error;
    const auto program = above / "bin" / "ringdown-bake";
    if (std::filesystem::exists(program, error)) return program;
  }
  return "ringdown-bake";
}

}  // namespace

MainPanel::MainPanel(HostLink& host, std::filesystem::path binary)
    : host_(host),
      binary_(std::move(binary)),
      edits_(host),
      material_(presets_near(binary_) / "materials"),
      drops_(bake_near(binary_), presets_near(binary_) / "materials") {}

void MainPanel::drop(const std::filesystem::path& file) {
  if (has_ending(file, ".glb") || has_ending(file, ".toml")) return edits_.play_file(file.string());
  if (viewer::kind_of_drop(file) == viewer::Dropped::mesh) return drops_.bake(file);
  drops_.refuse(file, "a bank, a note map");
}

void MainPanel::on_level(double level_db) { level_db_ = level_db; }

bool MainPanel::is_moving() const {
  return std::max(level_db_, drawn_level_db_) > ModeGlow::kDark_db || meter_.is_moving() || drops_.baker().is_working();
}

// Reads the object again if another one is played.
void MainPanel::update_body() {
  if (!tried_view_) {
    tried_view_ = true;
    auto view = BodyView::create();
    if (view) view_.emplace(std::move(*view));
    if (!view) complaint_ = view.error().message;
  }
  const auto choice = static_cast<std::size_t>(edits_.values()[Parameter::object]);
  Source wanted = find_source(choice, edits_.values().file, binary_);
  const auto key = static_cast<std::size_t>(key_);
  const bool is_key = !body_ || !body_->is_note_map || key == read_key_;
  const bool same =
      wanted == source_ && (is_key || ImGui::IsMouseDown(ImGuiMouseButton_Left));  // until the key is chosen
  if (!view_ || same) return;
  auto body = read_body(wanted, key);
  source_ = std::move(wanted);
  read_key_ = key;
  complaint_ = body ? "" : body.error().message;
  body_ = body ? std::make_shared<const ShownBody>(std::move(*body)) : nullptr;
  glow_ = body_ ? ModeGlow(body_->decays_per_s) : ModeGlow();
  blow_.clear();
  if (body_) view_->show(body_);
}

void MainPanel::update_glow(double now_s) {
  meter_.follow(level_db_, now_s);
  drawn_level_db_ = level_db_;
  if (!body_) return;
  const double percent = static_cast<double>(edits_.values()[Parameter::strike_point]);
  const double contact_s = 1e-3 * static_cast<double>(edits_.values()[Parameter::contact_time]);
  const Body::Station& station = body_->body.stations[static_cast<std::size_t>(std::lround(percent))];
  const auto point = edits_.point_on(body_->source);
  const Vec3 at = point ? point->point_m : station.position_m, way = point ? point->direction : station.direction;
  if (std::string blow = formatted("{} {} {} {}", at.x, at.y, at.z, contact_s); blow != blow_) {
    glow_.set_blow(struck_pa(body_->bank.get(), at, way, contact_s));
    blow_ = std::move(blow);
  }
  glow_.follow(level_db_, now_s - glow_at_s_, static_cast<double>(edits_.values()[Parameter::loss]));
  glow_at_s_ = now_s;
}

void MainPanel::draw(float width, float height, double scale, double now_s) {
  const auto ratio = static_cast<float>(scale);
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::Begin("Ringdown", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  if (begin_column("browser", ratio * kBrowser)) browser_.draw(edits_, host_);
  ImGui::EndChild();
  update_body();
  update_glow(now_s);
  ImGui::SameLine();
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float middle = std::max(50.0F, ImGui::GetContentRegionAvail().x - ratio * kControls - gap);
  if (begin_column("object", middle)) {
    draw_toolbar(scale);
    const float below = ratio * kModes + mallet_row_height() + 2 * ImGui::GetStyle().ItemSpacing.y;
    draw_body(middle, std::max(50.0F, ImGui::GetContentRegionAvail().y - below), now_s);
    draw_mallet_row(middle, edits_);
    draw_modes(middle, ratio * kModes);
  }
  ImGui::EndChild();
  ImGui::SameLine();
  if (begin_column("controls", 0)) {
    meter_.draw(ImGui::GetContentRegionAvail().x, ratio * kMeter);
    if (body_) material_.draw(*body_, edits_);
    sliders_.draw(edits_);
  }
  ImGui::EndChild();
  ImGui::End();
  for (const auto& bank : drops_.draw(viewer::make_skin(true), {0, 0}, {width, height}))
    edits_.play_file(bank.string());
  take_shortcuts();
}

void MainPanel::draw_toolbar(double scale) {
  ImGui::BeginDisabled(!edits_.history().can_undo());
  if (ImGui::Button("Undo")) edits_.undo();
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!edits_.history().can_redo());
  if (ImGui::Button("Redo")) edits_.redo();
  ImGui::EndDisabled();
  const float unit = ImGui::GetFontSize();
  ImGui::SameLine();
  ImGui::SetNextItemWidth(5 * unit);
  ImGui::SliderInt("##key", &key_, 0, kKeys - 1, key_name(key_).c_str(), ImGuiSliderFlags_NoInput);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The key that a click on the object plays");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(5 * unit);
  ImGui::SliderInt("##velocity", &velocity_, 1, 127, "vel. %d", ImGuiSliderFlags_NoInput);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The velocity of a click");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(5 * unit);
  if (ImGui::BeginCombo("##scale", formatted("{:.0f} %", 100 * scale).c_str())) {
    for (const double choice : kScales) {
      const bool chosen = std::abs(choice - scale) < 0.01;
      if (ImGui::Selectable(formatted("{:.0f} %", 100 * choice).c_str(), chosen)) host_.set_scale(choice);
    }
    ImGui::EndCombo();
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The size of the window's text and controls");
}

void MainPanel::draw_body(float width, float height, double now_s) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  std::uint32_t texture = 0;
  if (view_ && body_) {
    const std::size_t mode = glow_.leading();
    const float bright = glow_.brightness(mode);
    const double turn = 2 * std::numbers::pi * kSwing_hz * now_s;
    texture = view_->draw({.glow = bright, .mode = mode, .swing = bright * static_cast<float>(std::sin(turn))},
                          static_cast<int>(width), static_cast<int>(height));
  }
  if (texture == 0) {
    ImGui::BeginChild("complaint", {width, height});
    ImGui::TextWrapped("The object is not shown: %s",
                       complaint_.empty() ? "the driver has no room for a picture of this size" : complaint_.c_str());
    ImGui::EndChild();
    return;
  }
  ImGui::InvisibleButton("picture", {width, height},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  // NOLINTNEXTLINE(performance-no-int-to-ptr): ImGui keeps the names of textures in pointers.
  const auto picture = reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
  ImGui::GetWindowDrawList()->AddImage(picture, corner, {corner.x + width, corner.y + height}, {0, 1}, {1, 0});
  point_at_body(corner.x, corner.y);
  draw_strike_points(corner.x, corner.y);
}

// The left button strikes the object, and beside it turns it, as the right one does everywhere. x, y: the picture's
// corner in the window.
void MainPanel::point_at_body(float x, float y) {
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemHovered() && io.MouseWheel != 0) view_->zoom(io.MouseWheel);
  if (ImGui::IsItemActivated()) {
    const auto hit = view_->hit(io.MousePos.x - x, io.MousePos.y - y);
    turns_ = !ImGui::IsMouseClicked(ImGuiMouseButton_Left) || !hit;
    if (!turns_) {
      if (!body_->is_note_map) {
        const auto percent = static_cast<double>(edits_.values()[Parameter::strike_point]);
        const auto to_vec3 = [](const glm::vec3& v) {
          return Vec3{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
        };
        edits_.set_point({to_vec3(hit->object_point_m), to_vec3(-hit->normal), percent, body_->source},
                         io.KeyShift ? Which::second : Which::first);
      }
      pressed_ = static_cast<std::uint8_t>(body_->is_note_map ? body_->key : static_cast<std::size_t>(key_));
      host_.press_key(*pressed_, static_cast<std::uint8_t>(velocity_of_click(io.KeyShift)));
    }
  }
  if (ImGui::IsItemActive() && turns_) view_->turn(io.MouseDelta.x, io.MouseDelta.y);
  if (!ImGui::IsItemActive()) release_key();
}

void MainPanel::release_key() {
  if (pressed_) host_.release_key(*pressed_);
  pressed_.reset();
}

// Returns the velocity that strikes the point which the click has set.
int MainPanel::velocity_of_click(bool is_second) const {
  if (body_->is_note_map) return velocity_;
  if (is_second) return std::max<int>(velocity_, kSecondFrom);
  return edits_.point_on(body_->source, Which::second) ? std::min<int>(velocity_, kSecondFrom - 1) : velocity_;
}

void MainPanel::draw_strike_points(float x, float y) {
  if (body_->is_note_map) return;
  const auto percent = static_cast<double>(edits_.values()[Parameter::strike_point]);
  const auto point = edits_.point_on(body_->source);
  const viewer::Skin skin = viewer::make_skin(true);
  const float radius = 0.4F * ImGui::GetFontSize();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto draw_ring = [&](const Vec3& point_m, bool is_second) {
    const auto pixel = view_->pixel_of(point_m);
    if (!pixel) return;
    const ImVec2 middle{x + pixel->x, y + pixel->y};
    list.AddCircle(middle, radius, skin.paper, 0, 4);
    list.AddCircle(middle, radius, skin.text, 0, 2);
    if (is_second) list.AddCircleFilled(middle, 0.4F * radius, skin.text);
  };
  draw_ring(point ? point->point_m : body_->body.stations[static_cast<std::size_t>(std::lround(percent))].position_m,
            false);
  if (const auto second = edits_.point_on(body_->source, Which::second)) draw_ring(second->point_m, true);
}

// One bar for each audible mode, by its frequency in the object's own size; its height and colour are its level.
void MainPanel::draw_modes(float width, float height) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const viewer::Skin skin = viewer::make_skin(true);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float bottom = corner.y + height;
  const auto place = [&](double frequency_hz) {
    return corner.x +
           width * static_cast<float>(std::log(frequency_hz / kLowest_hz) / std::log(kHighest_hz / kLowest_hz));
  };
  list.AddRectFilled(corner, {corner.x + width, bottom}, skin.paper);
  for (const double hz : {100.0, 1000.0, 10000.0}) {
    list.AddLine({place(hz), corner.y}, {place(hz), bottom}, skin.grid);
    list.AddText({place(hz) + 3, corner.y}, skin.faint, hz < 1000 ? "100 Hz" : hz < 10000 ? "1 kHz" : "10 kHz");
  }
  for (std::size_t mode = 0; body_ && mode < body_->frequencies_hz.size(); ++mode) {
    const double hz = body_->frequencies_hz[mode];
    if (hz < kLowest_hz || hz > kHighest_hz) continue;
    const float bright = glow_.brightness(mode);
    const float top = bottom - std::max(2.0F, bright * height);
    const ImU32 glow = IM_COL32(255, 170 + static_cast<int>(70 * bright), 60 + static_cast<int>(120 * bright), 255);
    list.AddLine({place(hz), bottom}, {place(hz), top}, bright > 0 ? glow : skin.faint, bright > 0 ? 2.0F : 1.0F);
  }
  ImGui::Dummy({width, height});
}

void MainPanel::take_shortcuts() {
  const ImGuiIO& io = ImGui::GetIO();
  if (!io.KeyCtrl || io.WantTextInput) return;
  const auto pressed = [](ImGuiKey key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); };
  const bool z = pressed(ImGuiKey_Z), y = pressed(ImGuiKey_Y);
  if (y || (z && io.KeyShift))
    edits_.redo();
  else if (z)
    edits_.undo();
}

}  // namespace ringdown::plugin
