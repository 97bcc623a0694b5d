#include "server/session/scene_pieces.h"

#include "engine/breaking/breakable.h"
#include "engine/scene/fracture/breaking_bodies.h"

#include <cstddef>
#include <string>
#include <utility>

namespace ringdown::session {

Result<ScenePieces::Sets> ScenePieces::load(const ObjectState& object, synth::Frame frame) {
  if (auto good = breaking::Breakable::check(object.map->bank()); !good)
    return fail(good.error().kind, "object \"" + object.name + "\" cannot break: " + good.error().message);
  const modal::Fracture& fracture = *object.map->bank().fracture;
  Sets sets;
  for (std::size_t p = 0; p < fracture.patterns.size(); ++p) {
    sets.push_back(std::make_shared<const breaking::PieceSet>(*object.map, object.material, p));
    for (std::size_t i = 0; i < sets.back()->pieces().size(); ++i) {
      const breaking::BodyPiece& piece = sets.back()->pieces()[i];
      if (!piece.map) continue;
      const std::string name = scene::piece_name(object.name, fracture, p, i);
      if (auto loaded = load_piece(object, piece, name, frame); !loaded)
        return fail(loaded.error().kind, "object \"" + object.name + "\" cannot break: " + loaded.error().message);
    }
  }
  return sets;
}

Result<void> ScenePieces::load_piece(const ObjectState& object, const breaking::BodyPiece& piece,
                                     const std::string& name, synth::Frame frame) {
  if (const auto known = rack_.find({.name = name}); known && !contains((*known)->number))
    return fail(ErrorKind::refused, "an object \"" + name + "\" exists already");
  const modal::BankPath path{modal::split_bank_path(object.bank).file, {piece.model}};
  const auto number = rack_.add(name, modal::bank_path(path),
                                {.map = piece.map, .bytes = object.bank_bytes, .content = object.bank_content});
  if (!number) return fail(number.error());
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
      (object.gain == made->gain || rack_.push(synth::Producer::worker, {frame, *number, synth::verb::Gain{object.gain}})) &&
      (object.pan == made->pan || rack_.push(synth::Producer::worker, {frame, *number, synth::verb::Pan{object.pan}}));
  if (sent) return {};
  return fail(ErrorKind::refused, "too many objects at once; wait for those before to be taken up");
}

void ScenePieces::free(const std::set<synth::ObjectNumber>& numbers) const {
  for (const synth::ObjectNumber number : numbers) static_cast<void>(rack_.free({.number = number}));
}

void ScenePieces::keep_loaded() {
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

bool ScenePieces::contains(synth::ObjectNumber object) const {
  const std::scoped_lock lock(mutex_);
  return pieces_.contains(object);
}

}  // namespace ringdown::session
