// A mesh on the graphics card, at rest and in the modes that are shown of it. Inside this folder only; in the thread of
// the context.
#pragma once

#include "clients/viewer/render/drawn_mesh.h"
#include "clients/viewer/render/gl_object.h"

#include <vector>

namespace ringdown::viewer {

// Vertex attributes: 0 position, 1 normal, 2 displacement, 3 what a displacement of 1 adds to the normal.
class GlMesh {
 public:
  explicit GlMesh(const DrawnMesh& mesh);

  // At rest for an empty displacement. Another one is uploaded the first time, and kept while it is drawn.
  void draw(const Displacement& displacement);
  // Frees displacements that were not drawn since the last call.
  void end_frame();

 private:
  struct Moved {
    Displacement what;
    GlObject buffer, array;
    bool drawn = false;
  };
  void describe_corners() const;
  Moved upload(const Displacement& displacement) const;

  DrawnMesh mesh_;
  GlObject corners_ = make_buffer(), indices_ = make_buffer(), array_ = make_vertex_array();
  std::vector<Moved> moved_;
};

}  // namespace ringdown::viewer
