// From what the model knows to what is drawn and picked: bodies in their poses, objects without a body in a row, meshes
// made once. [UI]
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

// What stands on the stage: a body of the scene, or an object that has none.
struct Staged {
  std::optional<std::int32_t> body;  // its number; nothing for an object of the row
  std::string object;                // empty: silent
  double mass_kg = 0;                // about
};

// Meshes by what they were made from; each is uploaded once.
class MeshStore {
 public:
  struct Mesh {
    MeshId id = 0;
    DrawnMesh shape;
  };
  const Mesh& of_bank(const std::shared_ptr<const KnownBank>& bank, SceneRenderer& renderer);
  const Mesh& of_shape(const std::string& shape, Vec3 size_m, SceneRenderer& renderer);
  // Drops those of banks that nobody else has any more.
  void collect(SceneRenderer& renderer);

 private:
  struct OfBank {
    std::shared_ptr<const KnownBank> bank;
    Mesh mesh;
  };
  std::map<const KnownBank*, OfBank> banks_;
  std::map<std::string, Mesh> shapes_;
};

class Stage {
 public:
  // `frame` is what to draw; `staged` and `picked` stand in the order of frame.bodies. The frame's bodies name meshes
  // of the renderer, picked ones point into this stage: both until the next set().
  struct Set {
    SceneFrame frame;
    std::vector<Staged> staged;
    std::vector<PickedBody> picked;
  };
  // `at_s` is the scene time to show; nothing: that of the model's clock. Scene colours are dark or light.
  const Set& set(Model& model, const Commands& commands, SceneRenderer& renderer, bool dark, double now_s,
                 std::optional<double> at_s = std::nullopt);
  [[nodiscard]] const Set& last() const { return set_; }

  // Where to look from at first: the scene's own camera, or one that shows it all.
  [[nodiscard]] Camera home(const Model& model, float aspect) const;

 private:
  struct Look {
    bool selected;
    float glow;
  };
  void add_body(const KnownBody& body, const Pose& pose, Model& model, const Commands& commands, double now_s);
  void add_row(Model& model, const Commands& commands, double now_s);
  void add(const MeshStore::Mesh& mesh, const glm::mat4& pose, float size, const KnownObject* object, Staged staged,
           const Commands& commands, double now_s);
  void add_statics(const Model& model);
  [[nodiscard]] float lowest_fixed_m(const Model& model) const;
  void add_flashes(const Model& model, double now_s);
  void find_interest();
  Displacement displacement_of(const std::shared_ptr<const KnownBank>& bank, std::uint32_t rank);

  MeshStore meshes_;
  SceneRenderer* renderer_ = nullptr;  // during set()
  Set set_;
  std::optional<Sphere> interest_;
  std::shared_ptr<const KnownBank> displaced_;
  std::uint32_t displaced_mode_ = 0;
  Displacement displacement_;
};

// How bright an object is whose peak was `peak`, `age_s` ago: 0 at -70 dB, 1 at full scale.
float glow_of(double peak, double age_s);

}  // namespace ringdown::viewer
