#include "clients/plugin/window/material_row.h"

#include "clients/viewer/material_choice.h"
#include "engine/base/formatted.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::plugin {
namespace {

constexpr double kSame = 1e-3;  // hosts round parameters

bool stands_at(const Values& values, const MaterialFactors& factors) {
  const auto is = [&](Parameter parameter, double factor) {
    return std::abs(static_cast<double>(values[parameter]) / factor - 1) < kSame;
  };
  return is(Parameter::stiffness, factors.stiffness) && is(Parameter::density, factors.density) &&
         is(Parameter::loss, factors.loss);
}

void hint(const std::string& sentences) {
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", sentences.c_str());
}

}  // namespace

MaterialFactors factors_of(const modal::Material& bank, const modal::Material& wanted) {
  const viewer::MaterialChoice choice = viewer::choice_of(bank, wanted);
  MaterialFactors factors{choice.scale.stiffness, choice.scale.density, choice.scale.beta, choice.obstacle};
  for (const auto& [parameter, factor] : {std::pair{Parameter::stiffness, factors.stiffness},
                                          {Parameter::density, factors.density},
                                          {Parameter::loss, factors.loss}}) {
    const ParameterInfo& info = kParameterInfo[static_cast<std::size_t>(parameter)];
    const auto min = static_cast<double>(info.min), max = static_cast<double>(info.max);
    if (factors.obstacle.empty() && !(factor >= min && factor <= max))
      factors.obstacle =
          formatted("{} would be {:.3g}, and its range is {:.3g} to {:.3g}.", info.name, factor, min, max);
  }
  return factors;
}

void MaterialRow::choose(const modal::Material& bank, Edits& edits) {
  for (const modal::Material& wanted : *known_) {
    const MaterialFactors factors = factors_of(bank, wanted);
    const auto flags = factors.obstacle.empty() ? ImGuiSelectableFlags_None : ImGuiSelectableFlags_Disabled;
    const bool is_chosen = factors.obstacle.empty() && stands_at(edits.values(), factors);
    if (ImGui::Selectable(wanted.name.c_str(), is_chosen, flags)) {
      edits.set({{Parameter::stiffness, factors.stiffness},
                 {Parameter::density, factors.density},
                 {Parameter::loss, factors.loss}});
    }
    hint(factors.obstacle.empty() ? viewer::describe(bank, wanted) : factors.obstacle);
  }
}

void MaterialRow::draw(const ShownBody& body, Edits& edits) {
  if (!known_) known_ = viewer::known_materials(folder_);
  const auto bank = std::ranges::find(*known_, body.material, &modal::Material::name);
  if (body.is_note_map || bank == known_->end()) {
    ImGui::TextDisabled("Material: %s", body.material.empty() ? "unknown" : body.material.c_str());
    hint(body.is_note_map ? "The objects of a note map keep their materials; the sliders below scale them."
                          : "The catalogue does not have the bank's material; the sliders below scale it.");
    return;
  }
  const auto present = std::ranges::find_if(*known_, [&](const modal::Material& wanted) {
    const MaterialFactors factors = factors_of(*bank, wanted);
    return factors.obstacle.empty() && stands_at(edits.values(), factors);
  });
  ImGui::SetNextItemWidth(0.5F * ImGui::GetContentRegionAvail().x);
  const std::string name = stands_at(edits.values(), {}) ? bank->name
                           : present != known_->end()    ? present->name
                                                         : bank->name + ", changed";
  if (!ImGui::BeginCombo("Material", name.c_str(), ImGuiComboFlags_HeightLarge))
    return hint("Sets stiffness, density and loss. Baked in " + bank->name + ".");
  choose(*bank, edits);
  ImGui::EndCombo();
}

}  // namespace ringdown::plugin
