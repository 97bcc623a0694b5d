// The pieces of a scene's bodies that break: objects that are loaded with the scene, and silent until the break.
// [worker, unless noted]
//
//   auto sets = pieces.load_objects(scene, path, frame);  // each object, with the pieces of those that may break
//   pieces.keep_loaded();                                 // the pieces of the scene before go
#pragma once

#include "engine/base/result.h"
#include "engine/breaking/piece_set.h"
#include "engine/scene/description.h"
#include "engine/synth/events/event.h"
#include "server/session/object_state.h"
#include "server/session/rack.h"

#include <filesystem>
#include <map>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace ringdown::session {

class ScenePieces {
 public:
  explicit ScenePieces(Rack& rack) : rack_(rack) {}

  using Sets = std::vector<std::shared_ptr<const breaking::PieceSet>>;  // one for each pattern

  // Loads the pieces of all patterns of an object under the names that scene::piece_name() gives them, with its
  // material, group, gain and pan. Refused if the object cannot break, if one of the names is taken, or if there is no
  // room.
  Result<Sets> load(const ObjectState& object, synth::Frame frame);

  // Loads the objects of a scene and the pieces of those that may break. Returns the pieces by the objects' names.
  Result<std::map<std::string, Sets>> load_objects(const scene::SceneDescription& description,
                                                   const std::filesystem::path& path, synth::Frame frame);

  void keep_loaded();    // frees the pieces that have not been loaded since the last keep_loaded() or forget_loaded()
  void forget_loaded();  // frees those that have
  void free();

  [[nodiscard]] bool contains(synth::ObjectNumber object) const;  // [any but audio]

  // Notes objects whose bodies have broken, until they are freed or another scene's pieces are kept. Neither locks nor
  // allocates. [any]
  void note_broken(std::span<const synth::ObjectNumber> objects);
  void note_freed(synth::ObjectNumber object) { broken_.at(object) = false; }
  [[nodiscard]] bool is_broken(synth::ObjectNumber object) const { return object < broken_.size() && broken_[object]; }

 private:
  struct Place {
    std::size_t pattern, piece;  // numbers
  };
  Result<void> load_piece(const ObjectState& object, const breaking::BodyPiece& piece, const Place& place,
                          BankFile file, synth::Frame frame);
  void free(const std::set<synth::ObjectNumber>& numbers) const;

  Rack& rack_;
  std::set<synth::ObjectNumber> loaded_;  // since the last keep_loaded()
  mutable std::mutex mutex_;              // guards pieces_
  std::set<synth::ObjectNumber> pieces_;  // all, those in loaded_ included
  std::array<std::atomic<bool>, synth::kMaxObjects> broken_{};
};

}  // namespace ringdown::session
