#include "clients/viewer/render/gl_targets.h"

#include <algorithm>
#include <array>

namespace ringdown::viewer {
namespace {

void filter(GLint how, GLint edge) {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, how);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, how);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, edge);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, edge);
}

bool attach(const GlObject& framebuffer, const GlObject& texture, GLint format, GLenum layout, GLenum type, int width,
            int height) {
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, format, width, height, 0, layout, type, nullptr);
  filter(GL_LINEAR, GL_CLAMP_TO_EDGE);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name(), 0);
  return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

}  // namespace

ShadowMap::ShadowMap() {
  glBindTexture(GL_TEXTURE_2D, depth.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kSide, kSide, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  filter(GL_LINEAR, GL_CLAMP_TO_BORDER);
  constexpr std::array<float, 4> kFarthest = {1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, kFarthest.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth.name(), 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
}

PictureTargets::PictureTargets(int w, int h) : width(w), height(h) {
  GLint most = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  const GLint samples = std::min(most, kSamples);
  glBindRenderbuffer(GL_RENDERBUFFER, colour.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA16F, w, h);
  glBindRenderbuffer(GL_RENDERBUFFER, depth.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, w, h);
  glBindFramebuffer(GL_FRAMEBUFFER, many.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth.name());
  complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  complete = attach(linear, linear_texture, GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, w, h) && complete;
  complete = attach(mask, mask_texture, GL_R8, GL_RED, GL_UNSIGNED_BYTE, w, h) && complete;
  complete = attach(last, last_texture, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, w, h) && complete;
}

}  // namespace ringdown::viewer
