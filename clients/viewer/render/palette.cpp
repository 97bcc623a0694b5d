#include "clients/viewer/render/palette.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace ringdown::viewer {
namespace {

// Okabe & Ito.
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

struct Family {
  std::string_view part;  // of the name
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

}  // namespace

glm::vec3 material_colour(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  // The longest part counts: porcelain is not tin, nor alumina aluminium.
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

}  // namespace ringdown::viewer
