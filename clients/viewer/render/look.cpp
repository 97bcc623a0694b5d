#include "clients/viewer/render/look.h"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

namespace ringdown::viewer {
namespace {

// Okabe and Ito's palette.
constexpr glm::vec3 kOrange{0.902F, 0.624F, 0}, kSkyBlue{0.337F, 0.706F, 0.914F}, kBluishGreen{0, 0.620F, 0.451F},
    kYellow{0.941F, 0.894F, 0.259F}, kBlue{0, 0.447F, 0.698F}, kVermilion{0.835F, 0.369F, 0},
    kReddishPurple{0.800F, 0.475F, 0.655F};

constexpr glm::vec3 mix(glm::vec3 a, glm::vec3 b, float share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z)};
}
constexpr glm::vec3 kWhite{1, 1, 1}, kBlack{0, 0, 0};
constexpr glm::vec3 kWood = mix(kOrange, kBlack, 0.35F), kGold = mix(kYellow, kOrange, 0.4F),
                    kSteel = mix(kBlue, kWhite, 0.35F), kGlass = mix(kSkyBlue, kWhite, 0.35F),
                    kStone = mix(kBluishGreen, kWhite, 0.2F), kPorcelain = mix(kBluishGreen, kWhite, 0.65F);

// Materials whose names contain `part`.
struct Family {
  std::string_view part;
  glm::vec3 colour;
};
constexpr std::array kFamilies = {
    Family{"bronze", kVermilion},
    Family{"copper", kVermilion},
    Family{"brass", kOrange},
    Family{"gold", kGold},
    Family{"steel", kSteel},
    Family{"iron", mix(kBlue, kBlack, 0.25F)},
    Family{"alumini", kSkyBlue},
    Family{"titanium", kSteel},
    Family{"silver", kSkyBlue},
    Family{"nickel", kSteel},
    Family{"tin", kSkyBlue},
    Family{"zinc", kSkyBlue},
    Family{"lead", kBlue},
    Family{"metal", kSteel},
    Family{"glass", kGlass},
    Family{"silica", kGlass},
    Family{"ice", kGlass},
    Family{"porcelain", kPorcelain},
    Family{"ceramic", kPorcelain},
    Family{"alumina", kPorcelain},
    Family{"stone", kStone},
    Family{"granite", kStone},
    Family{"marble", kStone},
    Family{"slate", kStone},
    Family{"concrete", kStone},
    Family{"brick", kStone},
    Family{"wood", kWood},
    Family{"maple", kWood},
    Family{"spruce", kWood},
    Family{"bamboo", kWood},
    Family{"plastic", kReddishPurple},
    Family{"acrylic", kReddishPurple},
    Family{"polycarbonate", kReddishPurple},
};
constexpr std::array kOthers = {kOrange, kSkyBlue, kBluishGreen, kYellow, kBlue, kVermilion, kReddishPurple};

glm::vec4 colour(glm::vec3 srgb, float w = 1) { return {linear_from_srgb(srgb), w}; }

void set_colours(FrameBlock& block, Theme theme) {
  block.key = glm::vec4(glm::vec3(1.0F, 0.965F, 0.91F) * (theme == Theme::dark ? 0.95F : 0.85F), 1);
  if (theme == Theme::dark) {
    block.sky = {0.30F, 0.33F, 0.38F, 1};
    block.earth = {0.10F, 0.095F, 0.09F, 1};
    block.ground = colour({0.215F, 0.225F, 0.245F}, 0.085F);
    block.high = colour({0.125F, 0.133F, 0.150F});
    block.low = colour({0.165F, 0.175F, 0.195F});
    block.ink = colour({0.93F, 0.95F, 0.98F});
    block.flash = {1.5F, 1.25F, 0.85F, 1};
  } else {
    block.sky = {0.42F, 0.44F, 0.47F, 1};
    block.earth = {0.24F, 0.235F, 0.23F, 1};
    block.ground = colour({0.86F, 0.87F, 0.88F}, 0.14F);
    block.high = colour({0.80F, 0.825F, 0.855F});
    block.low = colour({0.90F, 0.91F, 0.92F});
    block.ink = colour({0.10F, 0.11F, 0.13F});
    block.flash = {0.66F, 0.11F, 0.0F, 0};
  }
}

// Scene -> shadow map, 0 ... 1 along each axis: the cube about the sphere of interest, seen from the light.
glm::mat4 light_matrix(Sphere interest, glm::vec3 to_light) {
  const float r = interest.radius_m;
  const glm::mat4 view = glm::lookAt(interest.centre + to_light * r, interest.centre, glm::vec3(0, 1, 0));
  const glm::mat4 cube = glm::ortho(-r, r, -r, r, 0.0F, 2 * r);
  return glm::translate(glm::mat4(1), glm::vec3(0.5F)) * glm::scale(glm::mat4(1), glm::vec3(0.5F)) * cube * view;
}

}  // namespace

glm::vec3 material_colour(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  // If several families match, the one with the longest part decides: it is the most specific.
  const Family* best = nullptr;
  for (const Family& family : kFamilies) {
    if (lower.find(family.part) != std::string::npos && (!best || family.part.size() > best->part.size()))
      best = &family;
  }
  if (best) return best->colour;
  std::uint32_t hash = 2166136261U;  // FNV-1a: the same on every machine, which std::hash need not be
  for (const unsigned char c : lower) hash = (hash ^ c) * 16777619U;
  return kOthers[hash % kOthers.size()];
}

glm::vec3 linear_from_srgb(glm::vec3 srgb) {
  glm::vec3 linear;
  for (int i = 0; i < 3; ++i) {
    const float s = std::clamp(srgb[i], 0.0F, 1.0F);
    linear[i] = s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F);
  }
  return linear;
}

glm::vec3 static_colour(Theme theme) {
  return theme == Theme::dark ? glm::vec3(0.36F, 0.375F, 0.40F) : glm::vec3(0.78F, 0.79F, 0.80F);
}

FrameBlock frame_block(const SceneFrame& frame, const Camera& camera, float aspect) {
  FrameBlock block;
  Sphere interest = frame.interest;
  interest.radius_m = std::max(interest.radius_m, 1e-4F);
  block.view_projection = camera.projection(aspect, interest) * camera.view();
  block.light = light_matrix(interest, towards_light());
  block.eye = glm::vec4(camera.position_m, 1);
  block.to_light = glm::vec4(towards_light(), 0);
  block.interest = glm::vec4(interest.centre, interest.radius_m);
  set_colours(block, frame.theme);
  return block;
}

float grid_spacing(float radius_m) {
  return std::pow(10.0F, std::floor(std::log10(std::max(radius_m, 1e-4F) / 0.5F))) * 0.1F;
}

}  // namespace ringdown::viewer
