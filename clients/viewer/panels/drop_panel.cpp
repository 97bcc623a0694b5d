#include "clients/viewer/panels/drop_panel.h"

#include "clients/viewer/material_choice.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"

#include <algorithm>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr float kDropWidth_em = 26;

Result<std::filesystem::path> needed(const Result<std::filesystem::path>& program) {
  if (program) return program;
  return fail(ErrorKind::refused, "dropped meshes need ringdown-bake (Debian's package ringdown-bake): {}",
              program.error().message);
}

}  // namespace

DropPanel::DropPanel(const Result<std::filesystem::path>& program, std::filesystem::path materials)
    : baker_(needed(program), own_bank_folder()), folder_(std::move(materials)) {}

void DropPanel::bake(const std::filesystem::path& file) {
  if (kind_of_drop(file) == Dropped::object) return baker_.add(file, "");
  meshes_.push_back(file);
}

void DropPanel::refuse(const std::filesystem::path& file, const std::string& others) {
  refusals_.push_back(file.filename().string() + " is neither " + others + " nor a mesh; meshes are " +
                      endings_of_bodies());
}

void DropPanel::ask_for_material() {
  if (materials_.empty()) {
    for (const modal::Material& material : known_materials(folder_)) materials_.push_back(material.name);
  }
  ImGui::TextWrapped("%s: of which material is it?", meshes_.front().filename().c_str());
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x / 2);
  if (ImGui::BeginCombo("##material", material_.c_str(), ImGuiComboFlags_HeightLarge)) {
    for (const std::string& name : materials_) {
      if (ImGui::Selectable(name.c_str(), name == material_)) material_ = name;
    }
    ImGui::EndCombo();
  }
  ImGui::SameLine();
  const bool bakes = ImGui::Button("Bake");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Checks the mesh, computes its modes and loads them as an object");
  ImGui::SameLine();
  const bool discards = ImGui::Button("Discard");
  if (bakes) baker_.add(meshes_.front(), material_);
  if (bakes || discards) meshes_.erase(meshes_.begin());
}

void DropPanel::draw_jobs(const Skin& skin) {
  const std::vector<MeshBaker::Job> jobs = baker_.jobs();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const MeshBaker::Job& job = jobs[i];
    const std::string name = job.file.filename().string();
    ImGui::PushID(static_cast<int>(i));
    if (job.failure.empty()) {
      const std::string label = name + ": " + job.stage;
      const float button = ImGui::CalcTextSize("Cancel").x + 2 * ImGui::GetStyle().FramePadding.x;
      ImGui::ProgressBar(static_cast<float>(job.fraction),
                         {ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemSpacing.x, 0},
                         label.c_str());
      ImGui::SameLine();
      if (ImGui::Button("Cancel")) baker_.remove(i);
    } else {
      ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
      ImGui::TextWrapped("%s is not baked: %s", name.c_str(), job.failure.c_str());
      ImGui::PopStyleColor();
      if (ImGui::SmallButton("Close")) baker_.remove(i);
    }
    ImGui::PopID();
  }
}

std::vector<std::filesystem::path> DropPanel::draw(const Skin& skin, ImVec2 origin, ImVec2 size) {
  std::vector<std::filesystem::path> banks = baker_.take_banks();
  if (meshes_.empty() && refusals_.empty() && baker_.jobs().empty()) return banks;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({origin.x + size.x / 2, origin.y + size.y - 2.5f * em}, 0, {0.5f, 1});
  ImGui::SetNextWindowSize({std::min(kDropWidth_em * em, size.x - 2 * em), 0});
  ImGui::Begin("Dropped files", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  if (!meshes_.empty()) ask_for_material();
  draw_jobs(skin);
  if (!refusals_.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
    ImGui::TextWrapped("%s", refusals_.front().c_str());
    ImGui::PopStyleColor();
    if (ImGui::SmallButton("Close##refusal")) refusals_.erase(refusals_.begin());
  }
  ImGui::End();
  return banks;
}

}  // namespace ringdown::viewer
