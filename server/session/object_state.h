// A rack's record of one object. [any thread]
#pragma once

#include "engine/base/content_hash.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/modal/damper.h"
#include "engine/modal/levels/level_bank.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "engine/modal/strike_map.h"
#include "engine/modal/tubes/tube_bank.h"
#include "engine/synth/events/event.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {

// A number of an object that any thread may set, without a lock or an allocation. Copies share it.
class LiveNumber {
 public:
  LiveNumber(double value) : value_(std::make_shared<std::atomic<double>>(value)) {}  // NOLINT: reads as a number
  operator double() const { return *value_; }                                         // NOLINT
  void set(double value) const { *value_ = value; }

 private:
  std::shared_ptr<std::atomic<double>> value_;
};

// Immutable once published (object_table.h), except for live numbers: a change replaces it whole.
struct ObjectState {
  std::string name;
  synth::ObjectNumber number = 0;
  std::filesystem::path bank;  // the file that the map was read from
  std::size_t bank_bytes = 0;  // the file's size
  ContentHash bank_content;    // the file's hash
  std::shared_ptr<const std::vector<std::byte>>
      bank_alone;                 // for a scene's bank, the file with this bank alone, which size and hash describe
  std::int32_t bank_version = 0;  // grows when the object gets a new bank
  std::shared_ptr<const modal::StrikeMap> map;        // of the bank that plays: one made for it if at another level
  std::shared_ptr<const modal::StrikeMap> baked_map;  // of the bank in the file
  std::shared_ptr<const modal::LevelModes> at_level;  // the modes of `map`; null: the liquid stands as baked
  std::shared_ptr<const modal::TubeModes> tubes;      // the modes of `map`; null: tubes are as baked
  modal::MaterialScale material;
  std::optional<double> untuned_size;    // the material's size before the keyboard's tuning changed it (note_tuner.h)
  modal::Dampers dampers;                // dampers that touch the object
  modal::ModeRange modes;                // the modes of the bank that ring
  std::string group;                     // empty: the object is in no group
  LiveNumber gain = 1;                   // the value that was set last, even if its frame is still to come
  LiveNumber pan = 0;                    // -1 left ... +1 right; the value that was set last, as for gain
  LiveNumber fan_hz = 0, fan_depth = 0;  // of a vibraphone's fan; the values that were set last, as for gain
  bool mute = false;                     // silent, whatever is soloed
  bool solo = false;                     // while any object is soloed, only soloed ones are heard
};

// An object at one moment, with its latest gain and pan. It stays valid for whoever holds it, and so does its bank,
// whatever is loaded later.
using ObjectSnapshot = std::shared_ptr<const ObjectState>;

// Returns the object as it would be if no keyboard's tuning had changed its size: what files say.
ObjectState untuned(const ObjectState& object);

// The level of the object's liquid [m, in the frame of the object in its size]; nothing where it stands as baked.
std::optional<double> level_m(const ObjectState& object);

// The same, also where it stands as baked; 0 when the bank knows no levels.
double present_level_m(const ObjectState& object);

// How the object's tubes are tuned; nothing where they are as baked.
std::optional<modal::TubeTuning> tube_tuning(const ObjectState& object);

// What becomes of what rings when the liquid goes from one level to another, or when tubes are tuned; null when neither
// happens. [worker]
std::shared_ptr<const modal::ModeTransfer> mode_change(const ObjectState& before, const ObjectState& after);

// Refuses a point [m, object frame] whose distance from the object's bounding box exceeds the size of the box: such a
// point is probably in millimetres, or in another object's coordinates. Every request that acts at a point of an object
// is checked. The box has the size that the object's material gives. An object of one point may be touched from
// anywhere. Does not allocate on success. [any]
Result<void> check_point(Vec3 point_m, const ObjectState& object);

}  // namespace ringdown::session
