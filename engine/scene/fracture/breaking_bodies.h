// The bodies of a scene that may break, and what happens when one does.
//
//   breaking.add(id, body);          // with the body: its pieces and their shapes are made ready
//   ... ContactSounds asks judge() about every blow on such a body ...
//   breaking.replace_broken(points, report);  // between two parts of a step: bodies that broke become their pieces
//
// The modal state of each body is followed through the blows that the scene itself makes (engine/breaking/breakable.h).
// Contacts that slide or roll are left out of it. A blow breaks the body if the sum of its impulses reaches the one
// that the scene gives, or if it strains the body up to its strength; how many pieces there are is decided by the
// energy of the vibration, of which the crack takes its part.
//
// The body breaks at the peak of the force. Half of the blow's impulse is therefore taken back from both bodies, and
// from what supports them; what then is left of the striker's motion acts on the pieces as new contacts. Each piece
// starts with the motion that it had as a part of the body: linear and angular momentum are kept to rounding. Pieces
// below the least mass are heard and have no body. A piece whose bank has pieces itself breaks again, by the same
// rules: it has a strength of its own, and its motion is followed from the break on. [one thread at a time]
#pragma once

#include "engine/base/result.h"
#include "engine/breaking/breakable.h"
#include "engine/scene/scene_bodies.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::scene {

// Returns the name of the object, or of the body, that piece `piece` of a pattern has. The pieces of all patterns of a
// body are numbered together, in the order of the patterns.
std::string piece_name(const std::string& whole, const modal::Fracture& fracture, std::size_t pattern,
                       std::size_t piece);

class BreakingBodies {
 public:
  // `bodies` must outlive this. `seed` is the scene's.
  BreakingBodies(SceneBodies& bodies, std::uint64_t seed, double sample_rate_hz);

  // Makes a body of the store ready to break. Objects named after its pieces sound as these. Fails with a sentence if
  // its bank has no pieces, does not know how it breaks, or cannot break. Cost: some milliseconds for each piece.
  Result<void> add(BodyId id, const Body& body);
  void remove(BodyId id) { bodies_.erase(id); }
  void silence(synth::ObjectNumber object);     // pieces that sound as this object become silent
  void set_sample_rate(double sample_rate_hz);  // all bodies count as at rest

  [[nodiscard]] bool empty() const { return bodies_.empty(); }

  // Decides whether a body breaks under the blows of one pair (BlowJudge).
  std::optional<double> judge(BodyId body, BodyId other, const BodyBlows& blows);

  // Replaces the bodies that judge() has let break since the last call by their pieces. `points` are the contact points
  // of the part. Adds events, in no order, and a sentence for each body. Returns the objects of the bodies that are
  // gone.
  std::vector<synth::ObjectNumber> replace_broken(std::span<const ContactPoint> points,
                                                  std::vector<synth::Event>& events, std::vector<std::string>& notices);

 private:
  // A piece of a pattern as a body.
  struct PieceBody {
    BodyDescription description;
    Solid solid;
  };
  struct Pattern {
    std::shared_ptr<const breaking::PieceSet> set;
    std::vector<std::optional<synth::ObjectNumber>> objects;  // of the pieces; nothing: it is not heard
    std::vector<std::shared_ptr<const PieceBody>> pieces;     // null: it has no body
    std::vector<std::shared_ptr<Pattern>> finer;              // of each piece; null: it does not break again
    [[nodiscard]] std::size_t body_count() const;
    void silence(synth::ObjectNumber object);
  };
  struct Entry {
    breaking::Breakable state;
    Breaks breaks;
    std::uint64_t number = 0;  // its strength is drawn by it
    std::optional<double> strength_pa;
    std::vector<Pattern> patterns;
    bool crowded = false;  // whether it was said that there is no room for its pieces
  };
  struct Broken {
    BodyId body = 0, other = 0;
    synth::ObjectNumber object = 0;
    synth::Frame frame = 0;
    Entry entry;
    std::size_t pattern = 0;
    double share = 1;  // of the pair's impulse that has acted
    modal::ModalState peak;
    breaking::Shattered shattered;
  };

  Result<Pattern> pattern_of(const Body& body, const SoundingObject& object, const breaking::Breakable& state,
                             std::size_t number) const;
  void nest(std::vector<Pattern>& patterns, const breaking::Breakable& state);
  [[nodiscard]] std::optional<double> strength_of(const Entry& entry) const;
  void follow_piece(const Broken& broken, std::size_t piece, BodyId id);
  void take_back(const Broken& broken, std::span<const ContactPoint> points, std::set<BodyId>& taken);
  void replace(const Broken& broken, std::vector<std::string>& notices);

  SceneBodies& scene_;
  std::uint64_t seed_;
  double sample_rate_hz_;
  std::map<BodyId, Entry> bodies_;
  // The pieces of pieces, made once for all bodies that share their pieces: by the set and the number of the piece.
  using PieceOfSet = std::pair<std::shared_ptr<const breaking::PieceSet>, std::size_t>;
  std::map<PieceOfSet, std::shared_ptr<const breaking::PieceSet>> finer_sets_;
  std::vector<Broken> broken_;
  std::vector<std::string> crowded_;  // sentences
};

}  // namespace ringdown::scene
