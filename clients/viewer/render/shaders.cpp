#include "clients/viewer/render/shaders.h"

namespace ringdown::viewer {
namespace {

const std::string kFrame = R"(
layout(std140) uniform Frame {
  mat4 view_projection, light;
  vec4 eye, to_light, interest, key, sky, earth, ground, high, low, ink, flash;
};
)";

// lit() is the share of the key light that reaches a point. It samples the shadow map at the points of a wide disc,
// with the depth bias following the plane of the receiver, so that a surface does not shadow itself. If all outer
// points agree, the inner ones are not sampled.
const std::string kShadow = R"(
uniform sampler2DShadow shadow_map;
float lit(vec3 place, vec3 normal) {
  const float width = 0.0045;
  const int outer = 5, inner = 11;
  vec3 at = (light * vec4(place + normal * interest.w * 0.0012, 1.0)).xyz;
  if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
  vec3 n = normalize(mat3(light) * normal);
  vec2 slope = clamp(-n.xy / (abs(n.z) > 0.05 ? n.z : 0.05), -4.0, 4.0);
  float bias = 0.0006 + 0.5 * (abs(slope.x) + abs(slope.y)) / float(textureSize(shadow_map, 0).x), sum = 0.0;
  for (int i = 0; i < outer; ++i) {
    float turn = 6.2831853 * float(i) / float(outer);
    vec2 tap = width * vec2(cos(turn), sin(turn));
    sum += texture(shadow_map, vec3(at.xy + tap, min(at.z + dot(slope, tap) - bias, 1.0)));
  }
  if (sum < 0.001) return 0.0;
  if (sum > float(outer) - 0.001) return 1.0;
  for (int i = 0; i < inner; ++i) {
    float turn = 2.3999632 * float(i);
    vec2 tap = width * sqrt((float(i) + 0.5) / float(inner)) * vec2(cos(turn), sin(turn));
    sum += texture(shadow_map, vec3(at.xy + tap, min(at.z + dot(slope, tap) - bias, 1.0)));
  }
  return smoothstep(0.0, 1.0, sum / float(outer + inner));
}
)";

}  // namespace

const std::string& body_vertex_shader() {
  static const std::string source = kFrame + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 move;
layout(location = 3) in vec3 normal_change;
uniform mat4 pose;
uniform float size, displacement;
uniform mat4 to_clip;
out vec3 place, outwards;
void main() {
  place = (pose * vec4(size * (position + displacement * move), 1.0)).xyz;
  outwards = mat3(pose) * (normal + displacement * normal_change);
  gl_Position = to_clip * vec4(place, 1.0);
}
)";
  return source;
}

const std::string& body_shader() {
  static const std::string source = kFrame + kShadow + R"(
in vec3 place, outwards;
uniform vec3 colour;
uniform float glow;
out vec4 seen;
void main() {
  vec3 n = normalize(outwards);
  vec3 v = normalize(eye.xyz - place);
  if (!gl_FrontFacing) n = -n;
  vec3 l = to_light.xyz, h = normalize(l + v);
  float facing = max(dot(n, v), 0.0);
  float direct = max(dot(n, l), 0.0);
  if (direct > 0.0) direct *= lit(place, n);
  float up = 0.5 + 0.5 * n.z;
  vec3 ambient = mix(earth.rgb, sky.rgb, up);
  vec3 light_in = key.rgb * direct + ambient;
  float fresnel = 0.04 + 0.96 * pow(1.0 - facing, 5.0);
  float shine = pow(max(dot(n, h), 0.0), 36.0) * 0.4 * direct;
  vec3 r = reflect(-v, n);
  vec3 mirrored = mix(earth.rgb, sky.rgb * 1.4, smoothstep(-0.3, 0.9, r.z));
  vec3 c = colour * light_in + key.rgb * shine + mirrored * fresnel * 0.6;
  float rim = pow(1.0 - facing, 2.5);
  c += glow * (colour * 0.6 + vec3(0.13, 0.12, 0.10) + vec3(1.5, 1.35, 1.1) * rim);
  seen = vec4(c, 1.0);
}
)";
  return source;
}

const std::string& flat_shader() {
  static const std::string source = R"(
out vec4 seen;
void main() { seen = vec4(1.0); }
)";
  return source;
}

const std::string& ground_vertex_shader() {
  static const std::string source = kFrame + R"(
uniform mat4 pose;
uniform float reach;
out vec3 place;
out vec2 along;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec3 middle = (transpose(mat3(pose)) * (interest.xyz - pose[3].xyz));
  along = middle.xy + corner * reach;
  place = (pose * vec4(along, 0.0, 1.0)).xyz;
  gl_Position = view_projection * vec4(place, 1.0);
}
)";
  return source;
}

const std::string& ground_shader() {
  static const std::string source = kFrame + kShadow + R"(
in vec3 place;
in vec2 along;
uniform mat4 pose;
uniform float spacing;
out vec4 seen;
float lines(float step) {
  vec2 at = along / step, wide = max(fwidth(at), vec2(1e-6));
  vec2 near = abs(fract(at - 0.5) - 0.5) / wide;
  vec2 line = clamp(1.2 - near, 0.0, 1.0) * (1.0 - smoothstep(0.15, 0.45, wide));
  return max(line.x, line.y);
}
void main() {
  vec3 n = pose[2].xyz;
  if (dot(eye.xyz - place, n) < 0.0) n = -n;
  float away = distance(place, interest.xyz) / interest.w;
  float direct = max(dot(n, to_light.xyz), 0.0) * lit(place, n);
  vec3 light_in = key.rgb * direct + mix(earth.rgb, sky.rgb, 0.5 + 0.5 * n.z);
  vec3 c = ground.rgb * light_in;
  float grid = max(lines(spacing) * 0.45, lines(spacing * 10.0)) * ground.w;
  grid *= 1.0 - smoothstep(1.2, 4.5, away);
  c = mix(c, ink.rgb, grid);
  seen = vec4(c, 1.0 - smoothstep(1.0, 6.0, away));
}
)";
  return source;
}

const std::string& whole_vertex_shader() {
  static const std::string source = R"(
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(at * 2.0 - 1.0, 0.0, 1.0);
}
)";
  return source;
}

const std::string& background_shader() {
  static const std::string source = kFrame + R"(
in vec2 at;
out vec4 seen;
void main() {
  float corner = dot(at - 0.5, at - 0.5);
  seen = vec4(mix(low.rgb, high.rgb, smoothstep(0.0, 1.0, at.y)) * (1.0 - 0.25 * corner), 1.0);
}
)";
  return source;
}

const std::string& flash_vertex_shader() {
  static const std::string source = kFrame + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 square;
layout(location = 2) in vec2 looks;
out vec2 at, look;
void main() {
  at = square;
  look = looks;
  gl_Position = view_projection * vec4(position, 1.0);
}
)";
  return source;
}

const std::string& flash_shader() {
  static const std::string source = kFrame + R"(
in vec2 at, look;
out vec4 seen;
void main() {
  float away = length(at);
  float spot = exp(-9.0 * away * away) * (1.0 - smoothstep(0.7, 1.0, away));
  float ring = exp(-pow((away - look.y) / 0.05, 2.0)) + 0.35 * exp(-pow((away - look.y) / 0.14, 2.0));
  float strength = look.x * (look.y > 0.0 ? ring * (1.0 - smoothstep(0.92, 1.0, away)) : spot);
  seen = vec4(flash.rgb * strength, clamp(strength, 0.0, 1.0) * (1.0 - flash.w));
}
)";
  return source;
}

const std::string& last_shader() {
  static const std::string source = kFrame + R"(
in vec2 at;
uniform sampler2D picture, mask;
uniform int outlined;
out vec4 seen;
float edge() {
  vec2 pixel = 1.0 / vec2(textureSize(mask, 0));
  float most = 0.0, inside = texture(mask, at).r;
  for (int i = 0; i < 16; ++i) {
    float turn = 0.39269908 * float(i);
    most = max(most, texture(mask, at + pixel * 2.0 * vec2(cos(turn), sin(turn))).r);
  }
  return most * (1.0 - inside);
}
void main() {
  vec3 c = texture(picture, at).rgb;
  c = mix(c, 0.8 + 0.2 * (1.0 - exp((0.8 - c) / 0.2)), step(0.8, c));
  if (outlined != 0) c = mix(c, ink.rgb, edge());
  vec3 encoded = mix(12.92 * c, 1.055 * pow(max(c, 0.0031308), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  float grain = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  seen = vec4(encoded + grain / 255.0, 1.0);
}
)";
  return source;
}

}  // namespace ringdown::viewer
