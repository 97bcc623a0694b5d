#include "engine/scene/silence.h"

#include "engine/base/formatted.h"
#include "engine/base/quote.h"
#include "engine/modal/hearing/masking.h"
#include "engine/modal/material_scale.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace ringdown::scene {
namespace {

// Bodies as they are described, those of emitters with them.
std::vector<const BodyDescription*> all_bodies(const SceneDescription& scene) {
  std::vector<const BodyDescription*> all;
  for (const BodyDescription& body : scene.bodies) all.push_back(&body);
  for (const EmitterDescription& emitter : scene.emitters) all.push_back(&emitter.body);
  return all;
}

std::string named(const std::vector<const BodyDescription*>& bodies) {
  constexpr std::size_t kFew = 3;
  std::string names;
  for (std::size_t k = 0; k < std::min(bodies.size(), kFew); ++k) names += (k > 0 ? ", " : "") + quote(bodies[k]->name);
  return bodies.size() > kFew ? formatted("{} and {} more", names, bodies.size() - kFew) : names;
}

// The lowest frequency that an object has in the scene's material and size; nothing where it has a mode that is heard.
std::optional<double> lowest_above_hearing(const ObjectDescription& object, std::span<const SoundingObject> objects) {
  const auto found = std::ranges::find(objects, object.name, &SoundingObject::name);
  if (found == objects.end() || !found->bank || found->bank->mode_count() == 0) return {};
  const double lowest_hz = std::ranges::min(found->bank->frequency_hz) * std::sqrt(lambda_factor(object.material));
  return lowest_hz > modal::kHighestHeard_hz ? std::optional(lowest_hz) : std::nullopt;
}

std::optional<double> lowest_above_hearing(const BodyDescription& body, const SceneDescription& scene,
                                           std::span<const SoundingObject> objects) {
  const auto object = std::ranges::find(scene.objects, body.object, &ObjectDescription::name);
  return object == scene.objects.end() ? std::nullopt : lowest_above_hearing(*object, objects);
}

}  // namespace

std::vector<std::string> above_hearing(const SceneDescription& scene, std::span<const SoundingObject> objects) {
  std::vector<std::string> sentences;
  std::size_t count = 0;
  for (const BodyDescription* body : all_bodies(scene)) {
    const auto lowest_hz = lowest_above_hearing(*body, scene, objects);
    if (!lowest_hz || ++count > kMaxNamed) continue;
    const std::string lowest = formatted("{:.4g} kHz", *lowest_hz / 1000);
    sentences.push_back("body " + quote(body->name) + " rings above hearing: its lowest mode is at " + lowest +
                        (scene.contact.clicks ? "; only the click of its blows is heard"
                                              : ", and the scene has no clicks; it stays silent"));
  }
  if (count > kMaxNamed) sentences.push_back(formatted("{} more bodies ring above hearing", count - kMaxNamed));
  return sentences;
}

std::optional<std::string> why_silent(const SceneDescription& scene, std::span<const SoundingObject> objects,
                                      const std::string& cure) {
  const std::vector<const BodyDescription*> bodies = all_bodies(scene);
  if (bodies.empty() && !scene.objects.empty()) return {};  // objects for requests to play
  if (bodies.empty())
    return "nothing in it can sound: it has no bodies (in glTF files, nodes with a motion or a collider)";
  std::vector<const BodyDescription*> sounding;
  for (const BodyDescription* body : bodies) {
    if (!body->object.empty()) sounding.push_back(body);
  }
  if (sounding.empty()) {
    return formatted(
        "nothing in it can sound: {} no bank; {}",
        bodies.size() == 1 ? "its body " + named(bodies) + " has" : "its bodies " + named(bodies) + " have", cure);
  }
  const bool moves = scene.foley && std::ranges::any_of(bodies, [](const auto* body) { return body->path != nullptr; });
  if (!moves && std::ranges::all_of(bodies, &BodyDescription::fixed)) {
    return "nothing in it sounds by itself: no body is free to move, and bodies that are fixed or follow keyframes do "
           "not strike each other; give one body a motion that is not kinematic";
  }
  if (!scene.contact.clicks && std::ranges::all_of(sounding, [&](const BodyDescription* body) {
        return lowest_above_hearing(*body, scene, objects).has_value();
      })) {
    return "nothing in it can be heard: all bodies with a bank ring above hearing, and the scene has no clicks; "
           "set clicks = true in [contact]";
  }
  return {};
}

}  // namespace ringdown::scene
