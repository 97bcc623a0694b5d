// The sound of a scene taken apart: one sound for each object and kind of contact, whose sum is the mix before its
// limiter.
//
//   StemLog log(rack);                    // before the scene is loaded
//   log.begin_block(frame);               // before every block that the rack's mixer renders
//   write_stems(log, settings, progress); // when all is rendered
//
// Each object gets its events again, alone, in a mixer of its own. A second mixer gets only its lasting
// contacts, and a third only those that slide. Slides are what the third renders, rolls are what the second renders
// beyond that, and impacts all that is left of the first: blows and their ringing. So the sum is exact, even where an
// object's modes exchange energy. Objects that feel each other (two-way contacts) play together, and one is heard. So
// do all objects with one whose modes exchange energy, because such an object amplifies the rounding of other chunks.
//
// [one thread]
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/synth/mixer.h"
#include "server/session/rack.h"
#include "server/session/sound_piece.h"

#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace ringdown::session {

class StemLog : public Observer {
 public:
  explicit StemLog(Rack& rack) : rack_(rack) { rack.observers().add(*this); }
  ~StemLog() override { rack_.observers().remove(*this); }
  StemLog(const StemLog&) = delete;
  StemLog& operator=(const StemLog&) = delete;

  void begin_block(synth::Frame frame);
  void played(const synth::Event& event) override;
  void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) override;

  // A voice that an object was given.
  struct Change {
    std::shared_ptr<const modal::StrikeMap> map;
    modal::MaterialScale material;
    modal::Dampers dampers;
    modal::ModeRange modes;
    synth::Mixer::Install how;
    synth::Frame at = 0;
    std::shared_ptr<const modal::ModeTransfer> mode_change;  // null: the level of its liquid stayed
  };
  // A pose that came before a block. Poses are kept apart from other events, because there are many.
  struct Posed {
    synth::Frame frame = 0;
    Pose pose;
  };
  struct Entry {
    std::size_t block = 0;
    std::variant<Posed, std::unique_ptr<const Change>, std::unique_ptr<const synth::Event>> what;
  };
  struct Track {
    std::string name;
    std::deque<Entry> entries;
    bool slides = false, rolls = false;
    bool blows = false;                  // whether it does anything else that sounds
    std::set<synth::ObjectNumber> felt;  // objects whose vibration this one feels
    bool chaotic = false;                // whether rounding makes another sound of it: its modes exchange energy
  };

  [[nodiscard]] const std::map<synth::ObjectNumber, Track>& tracks() const { return tracks_; }
  [[nodiscard]] const std::deque<Entry>& listener() const { return listener_; }
  [[nodiscard]] const std::vector<synth::Frame>& blocks() const { return blocks_; }  // their first frames

 private:
  Rack& rack_;
  std::map<synth::ObjectNumber, Track> tracks_;
  std::deque<Entry> listener_;
  std::vector<synth::Frame> blocks_;
};

struct StemSettings {
  std::filesystem::path folder;  // made if there is none
  double sample_rate_hz = 48000;
  int bits = 32;
  synth::MixerSettings mixer;  // those of the mix; there is no limiter
  Cut cut;                     // that of the mix
};

// Writes NAME-impact.wav, NAME-slide.wav and NAME-roll.wav for every object, as far as they are not silent, all as long
// as the mix. Returns how many. `progress` gets the share that is done, and may cancel.
Result<std::size_t> write_stems(const StemLog& log, const StemSettings& settings,
                                const std::function<bool(double done)>& progress);

}  // namespace ringdown::session
