// Scores for the plug-in, and the sound that libringdown makes of them by what docs/use/plugin.md says: own pitch,
// blows of 0.1 m/s, no spread, and released keys that ring on. It shares no code with the plug-in.
#pragma once

#include "clients/library/ringdown.h"
#include "tests/plugin/host.h"

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::test {

struct Score {
  std::vector<std::pair<std::uint32_t, std::array<std::uint8_t, 3>>> events;  // by frame of the whole
  std::uint32_t frames;
};
struct Sound {
  std::vector<float> left, right;
  std::uint32_t max_modes = 0;  // that rang in one block, where the library says so
};

// Returns notes of all velocities at frames that are no multiples of any block.
Score random_notes(int count, std::uint32_t frames, unsigned seed);

// Plays the score in blocks of the sizes given, over and over.
Sound play(PluginHost& host, const Score& score, const std::vector<std::uint32_t>& blocks);

double power(const std::vector<float>& samples);

// Returns how far b is from a, in dB of a.
double difference_db(const Sound& a, const Sound& b);

// A rig is the object that a score strikes and the mallet that strikes it: parameters of the plug-in, and what they
// mean.
struct Rig {
  double object = 25;
  std::string bank = "glockenspiel-bar";  // the preset of that number
  int root_key = 72;
  int mallet = 0;
  struct Place {
    std::array<double, 3> point_m{}, direction{};
  };
  std::optional<Place> second = {};  // for velocities from 100 on
};

// The instrument by libringdown alone. The events of a block of 256 frames are sent just before it.
class LibraryInstrument {
 public:
  explicit LibraryInstrument(const Rig& rig);
  ~LibraryInstrument();
  LibraryInstrument(const LibraryInstrument&) = delete;
  LibraryInstrument& operator=(const LibraryInstrument&) = delete;

  // Another bank replaces that of all objects, and what rings goes on.
  void set(const Rig& rig);
  Sound play(const Score& score);

 private:
  struct Bank {
    ringdown_bank* bank = nullptr;
    double mass_kg = 0;
    std::uint32_t vertex = 0;                  // where the eight leading modes move most
    Rig::Place place;                          // there, in the direction of the first mode
    double bowed_per_kg = 0, bowed_rad_s = 0;  // mode of the pitch at that place
  };
  static Bank open(const std::string& preset);
  void give_bank(int key);
  void press(std::int64_t frame, int key, int velocity);
  void draw_bow(std::int64_t frame, int key, const Rig::Place& place, double speed_m_s, double force_n);
  [[nodiscard]] double size_of(int key) const;

  Rig rig_;
  ringdown_mixer* mixer_ = nullptr;
  std::map<std::string, Bank> banks_;
  std::map<int, std::uint32_t> objects_;                    // by key
  std::map<int, std::function<void(std::int64_t)>> lifts_;  // of the bows that are drawn
};

inline constexpr double kRingsOn = 30;  // of the parameter Release

// Sets what LibraryInstrument assumes of the parameters that no Rig has.
void set_plain(PluginHost& host);

// Gives host and library each rig in turn and plays a score of its own on both. Returns the largest difference of
// their sounds, in dB. The host is active. `after_blocks` is called after every few blocks.
double largest_difference_db(
    PluginHost& host, const std::vector<Rig>& rigs, const std::function<void()>& after_blocks = [] {});

}  // namespace ringdown::test
