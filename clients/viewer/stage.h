// Turns the model into the bodies, statics and flashes that are drawn and picked. Bodies of the scene stand in their
// poses; objects that no body plays stand side by side on the ground, beside the scene. Meshes are made once. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/link/model.h"
#include "clients/viewer/render/picking.h"
#include "clients/viewer/render/scene_frame.h"
#include "clients/viewer/render/scene_renderer.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

// A drawn item: a body of the scene, or an object that no body plays.
struct StageItem {
  std::optional<std::int32_t> body;  // the body's number; nothing for an object without a body
  std::string object;                // empty: silent
  double mass_kg = 0;                // approximate
};

// The meshes of banks and of simple shapes. Each is uploaded to the renderer once.
class MeshStore {
 public:
  struct Mesh {
    MeshId id = 0;
    DrawnMesh shape;
  };
  const Mesh& of_bank(const std::shared_ptr<const KnownBank>& bank, SceneRenderer& renderer);
  // The surface of an object's liquid at a level of the bank; 0 where there is none.
  MeshId of_liquid(const KnownObject& object, double level_m, SceneRenderer& renderer);
  const Mesh& of_shape(const std::string& shape, Vec3 size_m, SceneRenderer& renderer);
  // Removes the meshes of banks that are not in use any more.
  void collect(SceneRenderer& renderer);

 private:
  struct OfBank {
    std::shared_ptr<const KnownBank> bank;
    Mesh mesh;
  };
  std::map<const KnownBank*, OfBank> banks_;
  struct OfLiquid {
    std::weak_ptr<const KnownBank> bank;
    double level_m = 0;
    MeshId id = 0;
  };
  std::map<std::string, Mesh> shapes_;
  std::map<std::string, OfLiquid> liquids_;  // by object
};

class Stage {
 public:
  // Everything to draw and to pick. `items` and `picked` are in the order of frame.bodies, behind which
  // the surfaces of liquids stand. Bodies name meshes of the
  // renderer, and picked bodies point into the stage; both are valid until the next update().
  struct Contents {
    SceneFrame frame;
    std::vector<StageItem> items;
    std::vector<PickedBody> picked;
  };
  // Fills the stage for one picture. `at_s` is the scene time to show; nothing means the time of the model's display
  // clock.
  const Contents& update(Model& model, const Commands& commands, SceneRenderer& renderer, bool dark, double now_s,
                         std::optional<double> at_s = std::nullopt);
  [[nodiscard]] const Contents& contents() const { return contents_; }

  // Returns the initial camera: the scene's own, or one that shows everything.
  [[nodiscard]] Camera home(const Model& model, float aspect) const;

 private:
  void add_body(const KnownBody& body, const Pose& pose, Model& model, const Commands& commands, double now_s);
  void add_bodiless(Model& model, const Commands& commands, double now_s);
  [[nodiscard]] glm::vec3 beside_scene(const Model& model);
  void add(const MeshStore::Mesh& mesh, const glm::mat4& pose, float size, const KnownObject* object, StageItem item,
           const Commands& commands, double now_s);
  void add_statics(const Model& model);
  [[nodiscard]] float lowest_fixed_m(const Model& model) const;
  void add_flashes(const Model& model, double now_s);
  void add_liquids(const Model& model, const Commands& commands);
  void find_interest();
  Displacement displacement_of(const std::shared_ptr<const KnownBank>& bank, std::uint32_t rank);

  MeshStore meshes_;
  SceneRenderer* renderer_ = nullptr;  // valid during update()
  Contents contents_;
  std::optional<Sphere> interest_;
  std::string edge_of_;            // the scene's file
  std::optional<glm::vec2> edge_;  // largest x and smallest y of the scene's bodies so far [m]
  std::shared_ptr<const KnownBank> displaced_;
  std::uint32_t displaced_mode_ = 0;
  Displacement displacement_;
};

// Returns the brightness of a body whose object had the level `peak`, `age_s` ago: 0 at -70 dB, 1 at full scale.
float glow_of(double peak, double age_s);

}  // namespace ringdown::viewer
