#include "clients/viewer/panels/save_panel.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>

namespace ringdown::viewer {
namespace {

constexpr const char* kWhere =
    "The daemon writes the file, on its computer; a name without a folder is relative to the folder in which the "
    "daemon was started";

void set(std::array<char, 256>& name, const std::string& text) {
  name.fill(0);
  std::copy_n(text.begin(), std::min(text.size(), name.size() - 1), name.begin());
}

void hint(const char* sentence) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", sentence);
}

// A field for the name of a file, and a button. True when the name was confirmed, with Enter or the button.
bool draw_name(std::array<char, 256>& name, const char* button) {
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(24 * ImGui::GetFontSize());
  const bool entered = ImGui::InputText("##name", name.data(), name.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  hint(kWhere);
  const bool pressed = ImGui::Button(button);
  if (!entered && !pressed) return false;
  ImGui::CloseCurrentPopup();
  return name[0] != 0;
}

}  // namespace

void SavePanel::draw_capture(const Skin& skin, const Model& model, Commands& commands) {
  const auto& status = model.status();
  const bool captures = status && status->capture;
  if (captures) ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
  if (ImGui::Button(captures ? "End sound" : "Record sound")) {
    if (captures) {
      commands.capture_to(std::nullopt);
    } else {
      set(sound_, "ringdown-" + time_of_day() + ".wav");
      ImGui::OpenPopup("record sound");
    }
  }
  if (captures) ImGui::PopStyleColor();
  hint(captures ? "Completes the WAV file" : "Writes the mix from now on to a WAV file (32-bit float, stereo)");
  if (ImGui::BeginPopup("record sound")) {
    if (draw_name(sound_, "Record")) commands.capture_to(sound_.data());
    ImGui::EndPopup();
  }
}

void SavePanel::draw_scene(const Model& model, Commands& commands) {
  if (ImGui::Button("Save scene")) {
    const auto& file = model.scene().description().file;
    const std::string stem = file ? std::filesystem::path(*file).stem().string() : "scene";
    set(scene_, stem + "-" + time_of_day() + ".toml");
    replace_ = false;
    ImGui::OpenPopup("save scene");
  }
  hint(
      "Writes the present state as a scene file: objects with their materials, sizes, levels and\nplaces, and the "
      "dropped bodies. Mutes and solos are not saved.");
  if (!ImGui::BeginPopup("save scene")) return;
  ImGui::Checkbox("Replace a scene that was saved under this name", &replace_);
  hint("Only scenes that were saved here are replaced, never one that was written by hand");
  if (draw_name(scene_, "Save")) commands.save_scene(scene_.data(), replace_);
  ImGui::EndPopup();
}

// While sound is captured: how long, how loud, and where. Afterwards, for a moment, what became of the last file.
void SavePanel::draw_outcome(const Skin& skin, const Model& model) {
  const auto& status = model.status();
  if (!status || !status->capture) {
    if (capture_.empty()) return;
    ImGui::TextDisabled("sound: %s", std::filesystem::path(capture_).filename().c_str());
    hint(capture_.c_str());
    return;
  }
  capture_ = *status->capture;
  if (status->captured_s != reported_s_) {
    reported_s_ = status->captured_s;
    reported_at_s_ = ImGui::GetTime();
  }
  const double seconds = reported_s_ + std::min(ImGui::GetTime() - reported_at_s_, 2.0);
  const double level_db = 20 * std::log10(std::max(model.peak().held, 1e-6));
  ImGui::PushStyleColor(ImGuiCol_Text, level_db > 0 ? skin.bad : skin.text);
  ImGui::Text("%d:%04.1f  %.0f dB%s", static_cast<int>(seconds / 60), std::fmod(seconds, 60), level_db,
              level_db > 0 ? "  too loud" : "");
  ImGui::PopStyleColor();
  hint((capture_ + "\nThe level is the largest sample of the last second; 0 dB is full scale").c_str());
}

void SavePanel::draw(const Skin& skin, const Model& model, Commands& commands) {
  draw_capture(skin, model, commands);
  ImGui::SameLine();
  draw_scene(model, commands);
  draw_outcome(skin, model);
}

}  // namespace ringdown::viewer
