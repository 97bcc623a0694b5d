#include "server/session/scene_pieces.h"

#include "engine/base/content_hash.h"
#include "engine/breaking/breakable.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/scene/fracture/breaking_bodies.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>

namespace ringdown::session {
namespace {

// Returns true if a body of the scene plays the object and may break.
bool breaks(const scene::SceneDescription& scene, const std::string& object) {
  const auto does = [&](const scene::BodyDescription& body) { return body.breaks && body.object == object; };
  return std::ranges::any_of(scene.bodies, does) ||
         std::ranges::any_of(scene.emitters, [&](const auto& emitter) { return does(emitter.body); });
}

}  // namespace

Result<std::map<std::string, ScenePieces::Sets>> ScenePieces::load_objects(const scene::SceneDescription& description,
                                                                           const std::filesystem::path& path,
                                                                           synth::Frame frame) {
  std::map<std::string, ScenePieces::Sets> pieces;
  for (const auto& object : description.objects) {
    const auto number = rack_.load(object.name, object.bank);
    if (!number) return fail(number);
    if (!object.group.empty()) {
      if (const auto set = rack_.set_group({.name = object.name}, object.group); !set) return fail(set);
    }
    if (object.material != modal::MaterialScale{}) {
      if (const auto set = rack_.set_material({.name = object.name}, object.material); !set) return fail(set);
    }
    if (object.level_m) {
      if (const auto set = rack_.set_level({.name = object.name}, *object.level_m); !set)
        return fail("object " + object.name, set);
    }
    if (object.tubes) {
      if (const auto set = rack_.set_tubes({.name = object.name}, *object.tubes); !set)
        return fail("object " + object.name, set);
    }
    const bool sent = rack_.push(synth::Producer::worker, {frame, *number, synth::verb::Gain{object.gain}}) &&
                      rack_.push(synth::Producer::worker, {frame, *number, synth::verb::Pan{object.pan}}) &&
                      (!(object.fan.depth > 0) || rack_.push(synth::Producer::worker, {frame, *number, object.fan}));
    if (!sent)
      return fail(ErrorKind::refused,
                  path.string() + ": too many objects at once; wait for those before to be taken up");
    if (!breaks(description, object.name)) continue;
    auto sets = load(**rack_.find({.name = object.name}), frame);
    if (!sets) return fail(path.string(), sets);
    pieces.emplace(object.name, std::move(*sets));
  }
  return pieces;
}

Result<ScenePieces::Sets> ScenePieces::load(const ObjectState& object, synth::Frame frame) {
  if (auto good = breaking::Breakable::check(object.map->bank()); !good)
    return fail(good.error().kind, "object \"{}\" cannot break: {}", object.name, good.error().message);
  const modal::Fracture& fracture = *object.map->bank().fracture;
  Sets sets;
  for (std::size_t p = 0; p < fracture.patterns.size(); ++p) {
    sets.push_back(std::make_shared<const breaking::PieceSet>(*object.map, object.material, p));
    for (std::size_t i = 0; i < sets.back()->pieces().size(); ++i) {
      const breaking::BodyPiece& piece = sets.back()->pieces()[i];
      BankFile file{.map = piece.map, .bytes = object.bank_bytes, .content = object.bank_content};
      if (!piece.map) {
        modal::Bank own = fracture.patterns[p].pieces[i].bank;
        own.gain = object.map->bank().gain;
        file.alone = std::make_shared<const std::vector<std::byte>>(drawn_file(own));
        file.bytes = file.alone->size();
        file.content = ContentHasher().bytes(*file.alone).hash();
        file.map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(own)));
      }
      if (auto loaded = load_piece(object, piece, {p, i}, std::move(file), frame); !loaded)
        return fail(loaded.error().kind, "object \"{}\" cannot break: {}", object.name, loaded.error().message);
    }
  }
  return sets;
}

Result<void> ScenePieces::load_piece(const ObjectState& object, const breaking::BodyPiece& piece, const Place& place,
                                     BankFile file, synth::Frame frame) {
  const std::string name = scene::piece_name(object.name, *object.map->bank().fracture, place.pattern, place.piece);
  if (const auto known = rack_.find({.name = name}); known && !contains((*known)->number))
    return fail(ErrorKind::refused, "an object \"" + name + "\" exists already");
  // A piece without modes is no model of the file.
  modal::BankPath path{modal::split_bank_path(object.bank).file, {piece.model}};
  if (!piece.map) path.model = {.number = place.pattern, .piece = place.piece};
  const auto number = rack_.add(name, modal::bank_path(path), std::move(file));
  if (!number) return fail(number);
  loaded_.insert(*number);
  {
    const std::scoped_lock lock(mutex_);
    pieces_.insert(*number);
  }
  const ObjectSnapshot made = *rack_.find({.number = *number});
  if (object.material != made->material) {
    if (auto set = rack_.set_material({.number = *number}, object.material); !set) return set;
  }
  if (object.group != made->group) {
    if (auto set = rack_.set_group({.number = *number}, object.group); !set) return set;
  }
  const bool sent =
      (object.gain == made->gain ||
       rack_.push(synth::Producer::worker, {frame, *number, synth::verb::Gain{object.gain}})) &&
      (object.pan == made->pan || rack_.push(synth::Producer::worker, {frame, *number, synth::verb::Pan{object.pan}}));
  if (sent) return {};
  return fail(ErrorKind::refused, "too many objects at once; wait for those before to be taken up");
}

void ScenePieces::free(const std::set<synth::ObjectNumber>& numbers) const {
  for (const synth::ObjectNumber number : numbers) static_cast<void>(rack_.free({.number = number}));
}

void ScenePieces::keep_loaded() {
  for (std::atomic<bool>& broken : broken_) broken = false;
  std::set<synth::ObjectNumber> before = std::exchange(loaded_, {});
  {
    const std::scoped_lock lock(mutex_);
    std::swap(before, pieces_);
    for (const synth::ObjectNumber number : pieces_) before.erase(number);
  }
  free(before);
}

void ScenePieces::forget_loaded() {
  const std::set<synth::ObjectNumber> loaded = std::exchange(loaded_, {});
  {
    const std::scoped_lock lock(mutex_);
    for (const synth::ObjectNumber number : loaded) pieces_.erase(number);
  }
  free(loaded);
}

void ScenePieces::free() {
  loaded_.clear();
  keep_loaded();
}

void ScenePieces::note_broken(std::span<const synth::ObjectNumber> objects) {
  for (const synth::ObjectNumber object : objects) broken_.at(object) = true;
}

bool ScenePieces::contains(synth::ObjectNumber object) const {
  const std::scoped_lock lock(mutex_);
  return pieces_.contains(object);
}

}  // namespace ringdown::session
