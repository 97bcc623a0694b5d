#include "clients/viewer/panels/material_picker.h"

#include "clients/viewer/material_choice.h"

#include <imgui.h>

namespace ringdown::viewer {
namespace {

void hint(const std::string& sentences) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", sentences.c_str());
}

}  // namespace

void MaterialPicker::draw(const KnownObject& object, Commands& commands) {
  if (!object.bank) return;
  if (!object.bank->bank.material) {
    ImGui::TextDisabled("material unknown");
    hint("The bank does not name its material, so no other can be chosen; the sliders work.");
    return;
  }
  const modal::Material& bank = *object.bank->bank.material;
  if (!known_) known_ = known_materials();
  const modal::MaterialScale scale = commands.edits().adjustment_of(object).scale;
  std::string present = material_name(bank, scale, *known_);
  if (present.empty()) present = bank.name + ", changed";
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool open = ImGui::BeginCombo("##material", present.c_str(), ImGuiComboFlags_HeightLarge);
  if (!open) {
    return hint("The object's material. Baked in " + bank.name + "; a choice sets stiffness, density and damping.\n" +
                "Another Poisson's ratio needs a new bake.");
  }
  const auto choose = [&](modal::MaterialScale wanted) {
    wanted.size = scale.size;
    commands.edits().change(object, protocol::SetMaterial{{object.name, std::nullopt}, wanted}, "material");
  };
  if (ImGui::Selectable((bank.name + " (as baked)").c_str(), present == bank.name)) choose({});
  for (const modal::Material& material : *known_) {
    const MaterialChoice choice = choice_of(bank, material);
    const auto flags = choice.obstacle.empty() ? ImGuiSelectableFlags_None : ImGuiSelectableFlags_Disabled;
    const bool same = material.name == present;
    if (ImGui::Selectable((material.name + "##known").c_str(), same && scale != modal::MaterialScale{}, flags)) {
      choose(choice.scale);
    }
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
      ImGui::SetTooltip("%s", describe(bank, material).c_str());
    }
  }
  ImGui::EndCombo();
}

}  // namespace ringdown::viewer
