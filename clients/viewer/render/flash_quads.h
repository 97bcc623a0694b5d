// Contacts as light: for each a spot that faces the camera and a ring across the normal. Inside this folder only; in
// the thread of the context.
#pragma once

#include "clients/viewer/render/gl_object.h"
#include "clients/viewer/render/scene_frame.h"

namespace ringdown::viewer {

class FlashQuads {
 public:
  FlashQuads();
  // All of the frame's, by the program in use.
  void draw(const SceneFrame& frame, const Camera& camera);

 private:
  GlObject buffer_ = make_buffer(), array_ = make_vertex_array();
};

}  // namespace ringdown::viewer
