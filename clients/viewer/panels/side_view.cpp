#include "clients/viewer/panels/side_view.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace ringdown::viewer {
namespace {

using protocol::ObjectRef;

bool contains(const std::string& text, const char* part) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return std::search(text.begin(), text.end(), part, part + std::strlen(part), same) != text.end();
}

// A logarithmic slider. Returns true while the user moves it.
bool factor_slider(const char* label, double& value, double least, double most) {
  auto shown = static_cast<float>(value);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - 6 * ImGui::GetFontSize());
  const bool moved = ImGui::SliderFloat(label, &shown, static_cast<float>(least), static_cast<float>(most), "%.3g",
                                        ImGuiSliderFlags_Logarithmic);
  if (moved) value = std::clamp(static_cast<double>(shown), least, most);
  return moved;
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
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The daemon to talk to; Enter connects");
  const bool connected = state.kind == Kind::connected;
  ImGui::PushStyleColor(ImGuiCol_Text, connected ? skin.good : state.kind == Kind::away ? skin.bad : skin.warning);
  ImGui::TextWrapped("%s %s", connected ? "\xE2\x86\x92" : "!", state.sentence.c_str());
  ImGui::PopStyleColor();
  if (const auto lost = state.lost_replies + state.lost_requests; lost > 0) {
    ImGui::TextDisabled("%llu messages were lost here", static_cast<unsigned long long>(lost));
  }
  return entered ? std::string(url_.data()) : std::string();
}

void SideView::draw_browser(Model& model, Commands& commands) {
  if (!ImGui::CollapsingHeader("Load", ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - 4 * ImGui::GetFontSize());
  ImGui::InputTextWithHint("##filter", "search", filter_.data(), filter_.size());
  ImGui::SameLine();
  if (ImGui::SmallButton("again")) model.files().browse_again();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Ask the daemon once more what there is");
  const float height = 9 * ImGui::GetTextLineHeightWithSpacing();
  if (!ImGui::BeginChild("files", {0, height}, false, ImGuiWindowFlags_NavFlattened)) return ImGui::EndChild();
  const auto list = [&](const char* heading, const std::vector<std::string>& files, auto load) {
    ImGui::TextDisabled("%s", heading);
    for (const std::string& file : files) {
      const std::string name = std::filesystem::path(file).stem().string();
      if (!contains(name, filter_.data())) continue;
      if (ImGui::Selectable((name + "##" + file).c_str())) load(file);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", file.c_str());
    }
  };
  list("Scenes", model.files().scenes(), [&](const std::string& file) { commands.load_scene(file); });
  list("Objects", model.files().banks(), [&](const std::string& file) { commands.load_bank(file); });
  ImGui::EndChild();
}

void SideView::draw_objects(const Skin& skin, Model& model, Commands& commands) const {
  if (!ImGui::CollapsingHeader("Objects", ImGuiTreeNodeFlags_DefaultOpen)) return;
  std::size_t number = 0;
  const auto rows = static_cast<float>(std::clamp<std::size_t>(model.objects().size(), 1, 8));
  if (!ImGui::BeginChild("objects", {0, rows * ImGui::GetTextLineHeightWithSpacing()}, false,
                         ImGuiWindowFlags_NavFlattened))
    return ImGui::EndChild();
  if (model.objects().empty()) ImGui::TextDisabled("none loaded");
  for (const auto& [name, object] : model.objects()) {
    ImGui::PushStyleColor(ImGuiCol_Text, series_colour(number++));
    ImGui::TextUnformatted("\xE2\x80\xA2");
    ImGui::PopStyleColor();
    ImGui::SameLine();
    if (ImGui::Selectable(name.c_str(), name == commands.choice().object)) commands.choose_object(name);
    if (!object.bank_fault.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", object.bank_fault.c_str());
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - 5 * ImGui::GetFontSize());
    if (!object.bank_fault.empty()) {
      ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
      ImGui::TextUnformatted("no bank");
      ImGui::PopStyleColor();
    } else if (object.bank) {
      ImGui::TextDisabled("%d modes", object.modes);
    } else {
      ImGui::TextDisabled("%.0f %%", 100 * object.bank_progress);
    }
  }
  ImGui::EndChild();
}

void SideView::draw_sliders(const KnownObject& object, Commands& commands) {
  if (!ImGui::CollapsingHeader("Material", ImGuiTreeNodeFlags_DefaultOpen)) return;
  Adjustment a = commands.edits().adjustment_of(object);
  const ObjectRef ref{object.name, std::nullopt};
  if (object.bank && object.bank->bank.material) ImGui::TextDisabled("%s", object.bank->bank.material->name.c_str());
  const auto material = [&](const char* label, double& factor, double least, double most) {
    if (factor_slider(label, factor, least, most))
      commands.edits().change(object, protocol::SetMaterial{ref, a.scale}, label);
  };
  material("alpha1", a.scale.alpha, 0.05, 20);
  material("alpha2", a.scale.beta, 0.05, 20);
  material("density", a.scale.density, 0.1, 10);
  material("Lam\xC3\xA9", a.scale.stiffness, 0.05, 20);
  material("size", a.scale.size, 0.25, 4);
  if (factor_slider("gain", a.gain, 0.001, 100))
    commands.edits().change(object, protocol::SetGain{ref, a.gain, 0.02}, "gain");
  auto pan = static_cast<float>(a.pan);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - 6 * ImGui::GetFontSize());
  if (ImGui::SliderFloat("pan", &pan, -1, 1, "%.2f"))
    commands.edits().change(object, protocol::SetPan{ref, pan}, "pan");
  if (ImGui::SmallButton("As baked")) commands.edits().change(object, protocol::SetMaterial{ref, {}}, "as baked");
}

void SideView::draw_strike(Commands& commands, Settings& settings) {
  if (!ImGui::CollapsingHeader("Test force", ImGuiTreeNodeFlags_DefaultOpen)) return;
  factor_slider("N s", commands.choice().impulse_ns, 1e-4, 10);
  double ms = 1e3 * commands.choice().contact_time_s;
  if (factor_slider("ms long", ms, 0.01, 20)) commands.choice().contact_time_s = ms / 1e3;
  ImGui::Checkbox("Held longer, harder", &settings.strength_by_time);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("A click that is held for 1/4 s strikes as strongly as the slider says");
}

void SideView::draw_session(const Skin& skin, const Model& model, Commands& commands) {
  const bool recording = model.recording();
  if (recording) ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
  if (ImGui::Button(recording ? "End recording" : "Record")) commands.toggle_recording();
  if (recording) ImGui::PopStyleColor();
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
  ImGui::Separator();
  std::size_t shown = 0;
  for (auto message = model.messages().rbegin(); message != model.messages().rend() && shown < 6; ++message) {
    if (!message->failed) continue;
    ImGui::PushStyleColor(ImGuiCol_Text, shown == 0 ? skin.bad : skin.faint);
    ImGui::TextWrapped("%s", message->sentence.c_str());
    ImGui::PopStyleColor();
    ++shown;
  }
}

std::string SideView::draw(const Skin& skin, const ConnectionState& state, Model& model, Commands& commands,
                           Settings& settings) {
  std::string go_to = draw_daemon(skin, state);
  draw_session(skin, model, commands);
  draw_browser(model, commands);
  draw_objects(skin, model, commands);
  if (const KnownObject* object = model.object(commands.choice().object)) draw_sliders(*object, commands);
  draw_strike(commands, settings);
  draw_messages(skin, model);
  return go_to;
}

}  // namespace ringdown::viewer
