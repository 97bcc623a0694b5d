#include "engine/scene/gltf/surface.h"

#include "engine/scene/gltf/document.h"

#include <algorithm>
#include <array>
#include <utility>

namespace ringdown::scene {
namespace {

bool equal(const std::optional<modal::SurfaceTrack>& a, const std::optional<modal::SurfaceTrack>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->length_m() == b->length_m() && std::ranges::equal(a->heights_m(), b->heights_m());
}

}  // namespace

using modal::JsonPlace;

void read_friction(GltfDocument& document, const JsonPlace& material, FrictionSurface& surface) {
  surface.friction = document.number(material["staticFriction"], 0.6);
  surface.sliding_friction = document.number(material["dynamicFriction"], 0.6);
  surface.restitution = document.number(material["restitution"], 0);
  const auto combine = [&](const char* key) {
    constexpr std::array kWays = {"average", "minimum", "maximum", "multiply"};
    const JsonPlace field = material[key];
    if (!field.present()) return Combine::average;
    const auto found = std::ranges::find(kWays, field.text_or(""));
    if (found == kWays.end()) document.refuse(field.wrong("average, minimum, maximum or multiply"));
    return static_cast<Combine>(found - kWays.begin());
  };
  surface.friction_combine = combine("frictionCombine");
  surface.restitution_combine = combine("restitutionCombine");
  if (surface.restitution > 1) document.notes.add("a restitution above 1 is 1");
  surface.restitution = std::min(surface.restitution, 1.0);
  const double rolling_m = document.number(material["extras"]["ringdown"]["rolling_m"], surface.rolling_m);
  surface.rolling_m = std::clamp(rolling_m, range::kRolling_m.low, range::kRolling_m.high);
  if (surface.rolling_m != rolling_m) document.notes.add("a rolling_m outside 0 to 0.1 m is the nearest of the two");
}

void read_finish(GltfDocument& document, const JsonPlace& finish, FrictionSurface& surface) {
  constexpr double kUsualWaviness_m = 2e-6, kUsualWavinessLength_m = 2e-3;
  synth::Texture& texture = surface.texture;
  texture.roughness_m = document.number(finish["roughness"], texture.roughness_m);
  texture.correlation_m = document.number(finish["correlationLength"], texture.correlation_m);
  texture.spectral_slope = document.number(finish["spectralSlope"], texture.spectral_slope);
  texture.shortest_m = document.number(finish["shortWavelength"], 0);
  if (texture.shortest_m > texture.correlation_m)
    document.notes.add("a shortWavelength above the correlation length leaves one wavelength, the correlation length");
  const double waviness_m = document.number(finish["waviness"], kUsualWaviness_m);
  const double length_m = document.number(finish["wavinessLength"], kUsualWavinessLength_m);
  if (waviness_m < 0) return document.refuse(finish["waviness"].wrong("at least 0"));
  if (!(length_m > 0)) return document.refuse(finish["wavinessLength"].wrong("more than 0"));
  surface.waviness = waviness_m / length_m;
  const bool is_longer = length_m > texture.correlation_m;
  const bool is_gentler = waviness_m * texture.correlation_m < texture.roughness_m * length_m;
  if (finish["waviness"].present() && waviness_m > 0 && !(is_longer && is_gentler))
    document.notes.add("the waviness of an acoustic surface should be longer and gentler than its finish");
}

std::optional<modal::SurfaceTrack> read_profile(GltfDocument& document, const JsonPlace& finish) {
  const JsonPlace profile = finish["profile"];
  if (!profile.present()) return {};
  const auto heights = modal::read_floats(document.glb(), profile, 1, modal::kMaxTrackSamples);
  const auto spacing_m = finish["sampleSpacing"].number();
  if (!heights) document.refuse(fail(heights));
  if (!spacing_m) document.refuse(fail(spacing_m));
  if (!heights || !spacing_m) return {};
  auto track = modal::SurfaceTrack::make(*heights, *spacing_m);
  if (!track) {
    document.refuse(fail(ErrorKind::bad_input, profile.path() + ": " + track.error().message));
    return {};
  }
  return *std::move(track);
}

Result<void> Reliefs::keep(SceneDescription& scene) {
  std::vector<std::shared_ptr<const modal::SurfaceRelief>*> used;
  for (BodyDescription& body : scene.bodies) used.push_back(&body.surface.relief);
  for (StaticDescription& item : scene.statics) used.push_back(&item.surface.relief);
  for (EmitterDescription& emitter : scene.emitters) used.push_back(&emitter.body.surface.relief);
  for (auto* relief : used) {
    if (!*relief) continue;
    const auto same = [&](const auto& kept) {
      return kept == *relief ||
             (equal(kept->profile, (*relief)->profile) && equal(kept->mesoscale, (*relief)->mesoscale));
    };
    if (const auto found = std::ranges::find_if(kept_, same); found != kept_.end()) {
      *relief = *found;
    } else if (kept_.size() < kMax) {
      kept_.push_back(*relief);
    } else {
      return fail(ErrorKind::too_large,
                  "more than {} surfaces with profiles or normal maps were played; restart the program", kMax);
    }
  }
  return {};
}

}  // namespace ringdown::scene
