// A panel for the files that were dropped onto the window: asks for the material of a mesh, and shows how far each bake
// is. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/mesh_baker.h"
#include "clients/viewer/panels/skin.h"
#include "engine/base/folders.h"

#include <imgui.h>

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::viewer {

class DropPanel {
 public:
  // Loads a bank or a scene, bakes an object file, and asks for the material of a mesh.
  void take(const std::filesystem::path& file, Commands& commands);

  // Draws a panel at the bottom of the scene's pane if there is something to show, and loads the banks that are ready.
  void draw(const Skin& skin, ImVec2 origin, ImVec2 size, Commands& commands);

  [[nodiscard]] const MeshBaker& baker() const { return baker_; }

 private:
  void ask_for_material();
  void draw_jobs(const Skin& skin);

  MeshBaker baker_{find_bake(), own_bank_folder()};
  std::vector<std::filesystem::path> meshes_;  // without a material yet
  std::vector<std::string> refusals_;
  std::vector<std::string> materials_;  // the catalogue's names, read at first use
  std::string material_ = "steel";      // chosen last
  static Result<std::filesystem::path> find_bake();
};

}  // namespace ringdown::viewer
