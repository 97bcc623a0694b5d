// Shapes that the renderer draws from vertex buffers: meshes of bodies, and the flashes of contacts. Only files of this
// folder include this header. Every call needs the renderer's context to be current. [context thread]
#pragma once

#include "clients/viewer/render/drawn_mesh.h"
#include "clients/viewer/render/gl.h"
#include "clients/viewer/render/scene_frame.h"

#include <vector>

namespace ringdown::viewer {

// A mesh on the graphics card, at rest and displaced by modes. Vertex attributes: 0 position, 1 normal, 2 displacement,
// 3 the change of the normal under a displacement of 1.
class GlMesh {
 public:
  explicit GlMesh(const DrawnMesh& mesh);

  // Draws the mesh at rest for an empty displacement. Any other displacement is uploaded when it is first drawn, and
  // kept for as long as every frame draws it.
  void draw(const Displacement& displacement);

  // Frees the displacements that were not drawn since the last call.
  void end_frame();

 private:
  struct Displaced {
    Displacement what;
    GlObject buffer, array;
    bool drawn = false;
  };
  void describe_corners() const;
  Displaced upload(const Displacement& displacement) const;

  DrawnMesh mesh_;
  GlObject corners_ = make_buffer(), indices_ = make_buffer(), array_ = make_vertex_array();
  std::vector<Displaced> displaced_;
};

// Contacts drawn as light: each is a spot that faces the camera, and a ring around the contact normal.
class FlashQuads {
 public:
  FlashQuads();

  // Draws all flashes of the frame by the program in use.
  void draw(const SceneFrame& frame, const Camera& camera);

 private:
  GlObject buffer_ = make_buffer(), array_ = make_vertex_array();
};

}  // namespace ringdown::viewer
