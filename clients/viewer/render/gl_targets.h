// What is drawn into: the shadow map, the multisampled picture, the mask of what is selected, and the last texture.
// Inside this folder only; in the thread of the context.
#pragma once

#include "clients/viewer/render/gl_object.h"

namespace ringdown::viewer {

// Depth as seen from the light; read with a comparison, filtered between its texels, and 1 outside.
struct ShadowMap {
  static constexpr int kSide = 1024;
  ShadowMap();
  GlObject depth = make_texture(), framebuffer = make_framebuffer();
};

// All of one size.
struct PictureTargets {
  static constexpr GLint kSamples = 4;  // at most
  PictureTargets(int width, int height);

  int width, height;
  bool complete = false;
  GlObject colour = make_renderbuffer(), depth = make_renderbuffer(),
           many = make_framebuffer();                                     // multisampled, half float
  GlObject linear_texture = make_texture(), linear = make_framebuffer();  // the same, resolved
  GlObject mask_texture = make_texture(), mask = make_framebuffer();      // one byte
  GlObject last_texture = make_texture(), last = make_framebuffer();      // sRGB as bytes
};

}  // namespace ringdown::viewer
