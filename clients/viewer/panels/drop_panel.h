// A panel for files that were dropped onto a window and have to be baked: asks for the material of a mesh, and shows
// how far each bake is. The windows of viewer and plug-in have one each. [UI]
//
//   panel.bake("mug.stl");
//   for (const auto& bank : panel.draw(skin, origin, size)) load(bank);  // at every frame
#pragma once

#include "clients/viewer/mesh_baker.h"
#include "clients/viewer/panels/skin.h"

#include <imgui.h>

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::viewer {

class DropPanel {
 public:
  // `program` is ringdown-bake. `materials` is the folder of the catalogue; empty: that of the presets.
  explicit DropPanel(const Result<std::filesystem::path>& program, std::filesystem::path materials = {});

  // Bakes an object file, and asks for the material of a mesh.
  void bake(const std::filesystem::path& file);
  // Says that the file is neither a mesh nor what `others` names: "a bank or a scene".
  void refuse(const std::filesystem::path& file, const std::string& others);

  // Draws a panel at the bottom of a picture if there is something to show. Returns the banks that have become ready.
  [[nodiscard]] std::vector<std::filesystem::path> draw(const Skin& skin, ImVec2 origin, ImVec2 size);

  [[nodiscard]] const MeshBaker& baker() const { return baker_; }

 private:
  void ask_for_material();
  void draw_jobs(const Skin& skin);

  MeshBaker baker_;
  const std::filesystem::path folder_;         // of materials
  std::vector<std::filesystem::path> meshes_;  // without a material yet
  std::vector<std::string> refusals_;
  std::vector<std::string> materials_;  // the catalogue's names, read at first use
  std::string material_ = "steel";      // chosen last
};

}  // namespace ringdown::viewer
