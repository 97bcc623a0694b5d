#include "clients/viewer/panels/side_view.h"

#include "clients/viewer/panels/object_list.h"
#include "clients/viewer/panels/view_panel.h"

#include "engine/modal/levels/liquid_levels.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace ringdown::viewer {
namespace {

using protocol::ObjectRef;

constexpr float kMinFiles = 3.5f;  // lines of the list of scenes and objects; half a line shows that there are more

bool contains(const std::string& text, const char* part) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return std::search(text.begin(), text.end(), part, part + std::strlen(part), same) != text.end();
}

}  // namespace

void SideView::set_url(const std::string& url) {
  url_.fill(0);
  std::copy_n(url.begin(), std::min(url.size(), url_.size() - 1), url_.begin());
}

std::string SideView::draw_daemon(const Skin& skin, const ConnectionState& state) {
  using Kind = ConnectionState::Kind;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool entered = ImGui::InputText("##daemon", url_.data(), url_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The daemon's address; Enter connects");
  const bool connected = state.kind == Kind::connected;
  ImGui::PushStyleColor(ImGuiCol_Text, connected ? skin.good : state.kind == Kind::away ? skin.bad : skin.warning);
  if (connected) {
    ImGui::TextUnformatted("\xE2\x86\x92 connected");
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", state.sentence.c_str());
  } else {
    ImGui::TextWrapped("! %s", state.sentence.c_str());
  }
  ImGui::PopStyleColor();
  if (const auto lost = state.lost_replies + state.lost_requests; lost > 0) {
    ImGui::TextDisabled("%llu messages were lost here", static_cast<unsigned long long>(lost));
  }
  return entered ? std::string(url_.data()) : std::string();
}

void SideView::draw_browser(Model& model, Commands& commands) {
  if (!ImGui::CollapsingHeader("Load", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const ImGuiStyle& style = ImGui::GetStyle();
  const float button_width = ImGui::CalcTextSize("Refresh").x + 2 * style.FramePadding.x;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - button_width - style.ItemSpacing.x);
  ImGui::InputTextWithHint("##filter", "search", filter_.data(), filter_.size());
  ImGui::SameLine();
  if (ImGui::Button("Refresh")) model.files().browse_again();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Ask the daemon again for scenes and banks");
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const auto rows = static_cast<float>(2 + model.files().scenes().size() + model.files().banks().size());
  const float height = std::min(rows * line, std::max(kMinFiles * line, ImGui::GetWindowHeight() - others_height_));
  files_height_ = height;
  if (!ImGui::BeginChild("files", {0, height}, false, ImGuiWindowFlags_NavFlattened)) return ImGui::EndChild();
  const auto list = [&](const char* heading, const std::vector<std::string>& files, auto load) {
    ImGui::TextDisabled("%s", heading);
    const std::vector<std::string> names = names_of(files);
    for (std::size_t i = 0; i < files.size(); ++i) {
      const std::string& file = files[i];
      if (!contains(names[i], filter_.data())) continue;
      if (ImGui::Selectable((names[i] + "##" + file).c_str())) load(file);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", file.c_str());
    }
  };
  list("Scenes", model.files().scenes(), [&](const std::string& file) { commands.load_scene(file); });
  list("Objects", model.files().banks(), [&](const std::string& file) { commands.load_bank(file); });
  ImGui::EndChild();
}

void SideView::draw_sliders(const KnownObject& object, Commands& commands) {
  if (!ImGui::CollapsingHeader("Material", ImGuiTreeNodeFlags_DefaultOpen)) return;
  Adjustment a = commands.edits().adjustment_of(object);
  const ObjectRef ref{object.name, std::nullopt};
  materials_.draw(object, commands);
  const auto material = [&](const char* label, const char* tip, double& factor, SliderRange range) {
    if (slider(label, tip, factor, range, "\xC3\x97 %.3g"))
      commands.edits().change(object, protocol::SetMaterial{ref, a.scale}, label);
  };
  material("Stiffness", "Factor on the Lam\xC3\xA9 constants (M and , keys). Four times as stiff is an octave higher",
           a.scale.stiffness, {0.05, 20});
  material("Density", "Factor on the mass density (B and N keys). Four times as dense is an octave lower",
           a.scale.density, {0.1, 10});
  material("Material loss",
           "Factor on the loss to the material (C and V keys). More loss shortens all modes by the same share",
           a.scale.beta, {0.05, 20});
  material("Heat loss",
           "Factor on the loss by heat that flows through bent walls. More loss shortens the low modes of thin metal",
           a.scale.heat, {0.05, 20});
  material("Air loss",
           "Factor on the loss to the air. More loss shortens the modes that sound loudest, mostly high ones",
           a.scale.air, {0.05, 20});
  material("Support loss", "Factor on the loss to cords, felt or a hand (Z and X keys). A free object has no such loss",
           a.scale.alpha, {0.05, 20});
  material("Size", "Factor on all lengths. Twice the size is an octave lower, with eight times the mass", a.scale.size,
           {0.25, 4});
  if (object.bank && object.bank->bank.levels) {
    const Range range = object.bank->bank.levels->range_m();
    double level_mm = 1e3 * a.level_m;
    if (slider("Liquid", "The height of the liquid's surface in the object. A higher level sounds lower", level_mm,
               {1e3 * a.scale.size * range.low, 1e3 * a.scale.size * range.high, false}, "%.1f mm"))
      commands.edits().change(object, protocol::SetFill{ref, level_mm / 1e3}, "liquid");
  }
  double level_db = 20 * std::log10(std::max(a.gain, 1e-3));
  if (slider("Level", "The object's gain. 0 dB is a factor of 1, +20 dB a factor of 10", level_db, {-60, 40, false},
             "%.1f dB"))
    commands.edits().change(object, protocol::SetGain{ref, {std::pow(10, level_db / 20), 0.02}}, "level");
  if (slider("Pan", "-1 is left, 1 is right", a.pan, {-1, 1, false}, "%.2f"))
    commands.edits().change(object, protocol::SetPan{ref, {a.pan}}, "pan");
  if (ImGui::SmallButton("As baked")) commands.edits().change(object, protocol::SetMaterial{ref, {}}, "as baked");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Restores the material and size of the bank's file");
}

void SideView::draw_strike(Commands& commands, Settings& settings) {
  if (!ImGui::CollapsingHeader("Test force", ImGuiTreeNodeFlags_DefaultOpen)) return;
  slider("Strength", "The impulse of a blow: force times time (L and K keys)", commands.choice().impulse_ns, {1e-4, 10},
         "%.3g N s");
  double ms = 1e3 * commands.choice().contact_time_s;
  if (slider("Contact", "How long the blow lasts: shorter is harder, and excites higher modes", ms, {0.01, 20},
             "%.3g ms")) {
    commands.choice().contact_time_s = ms / 1e3;
  }
  ImGui::Checkbox("Hold longer to strike harder", &settings.strength_by_time);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("A click that is held for 1/4 s strikes as strongly as the slider says");
}

void SideView::draw_session(const Skin& skin, const Model& model, Commands& commands) {
  const bool recording = model.recording();
  if (recording) ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
  if (ImGui::Button(recording ? "End strikes" : "Record strikes")) commands.toggle_recording();
  if (recording) ImGui::PopStyleColor();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("A score of all strikes, which `ringdown render --events` plays again");
  ImGui::SameLine();
  const auto button = [](const char* label, const std::string& what) {
    if (what.empty()) ImGui::BeginDisabled();
    const bool pressed = ImGui::Button(label);
    if (what.empty()) ImGui::EndDisabled();
    if (!what.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", what.c_str());
    return pressed;
  };
  if (button("Undo", commands.edits().history().undoes())) commands.perform(Action::undo);
  ImGui::SameLine();
  if (button("Redo", commands.edits().history().redoes())) commands.perform(Action::redo);
}

void SideView::draw_messages(const Skin& skin, const Model& model) {
  std::size_t shown = 0;
  for (auto message = model.messages().rbegin(); message != model.messages().rend() && shown < 6; ++message) {
    if (!message->failed) continue;
    if (shown == 0) ImGui::Separator();
    ImGui::PushStyleColor(ImGuiCol_Text, shown == 0 ? skin.bad : skin.faint);
    ImGui::TextWrapped("%s", message->sentence.c_str());
    ImGui::PopStyleColor();
    ++shown;
  }
}

std::string SideView::draw(const Skin& skin, const ConnectionState& state, Model& model, Commands& commands,
                           Settings& settings, Camera& camera) {
  std::string go_to = draw_daemon(skin, state);
  draw_session(skin, model, commands);
  save_.draw(skin, model, commands);
  files_height_ = 0;
  draw_browser(model, commands);
  if (ImGui::CollapsingHeader("Objects", ImGuiTreeNodeFlags_DefaultOpen)) draw_object_list(skin, model, commands);
  if (const KnownObject* object = model.object(commands.choice().object)) draw_sliders(*object, commands);
  draw_strike(commands, settings);
  draw_view(camera, commands, settings.listen);
  draw_messages(skin, model);
  others_height_ = ImGui::GetCursorPosY() + ImGui::GetStyle().WindowPadding.y - files_height_;
  return go_to;
}

}  // namespace ringdown::viewer
