#include "engine/bake/tubes/resonator.h"

#include "engine/base/note.h"
#include "engine/base/range.h"

#include <cmath>
#include <string>

namespace ringdown::bake {
namespace {

constexpr Range kDiameter_m{1e-6, 1e3}, kMouth_m{-1e6, 1e6}, kWay{-1e6, 1e6}, kTubeLength_m{1e-6, 1e4};
constexpr Range kDetune_cents{-1200, 1200};
constexpr double kFirstHz = 20, kHighestHz = 1e5;

void read_tuning(TomlTable& table, Resonator& resonator) {
  std::vector<std::string> words;
  table.words("tuned_to", words, false);
  if (words.empty()) return;
  if (const auto note = note_number(words.front())) {
    resonator.tuned_hz = note_frequency(*note);
    return;
  }
  char* end = nullptr;
  const double number = std::strtod(words.front().c_str(), &end);
  if (*end != '\0' || !(number >= 1 && number <= kHighestHz) || (number < kFirstHz && number != std::floor(number))) {
    table.complain("tuned_to",
                   "tuned_to must be a mode's number from 1 to 19, a frequency of 20 to 100000 Hz, or a note");
  } else if (number < kFirstHz) {
    resonator.tuned_mode = static_cast<int>(number);
  } else {
    resonator.tuned_hz = number;
  }
}

Resonator read_resonator(TomlTable& table) {
  Resonator resonator;
  table.require({"diameter_m", "mouth_m"});
  double diameter_m = 0;
  table.number("diameter_m", diameter_m, kDiameter_m);
  resonator.radius_m = diameter_m / 2;
  table.vector("mouth_m", resonator.mouth_m, kMouth_m);
  table.vector("axis", resonator.axis, kWay);
  if (!(dot(resonator.axis, resonator.axis) > 0)) table.complain("axis", "axis must be a direction, not 0");
  read_tuning(table, resonator);
  table.number("detune_cents", resonator.detune_cents, kDetune_cents);
  table.boolean("stopped", resonator.stopped);
  if (table.has("length_m")) {
    resonator.length_m = 1;
    table.number("length_m", *resonator.length_m, kTubeLength_m);
    if (table.has("tuned_to")) table.complain("tuned_to", "a tube is either tuned_to a mode or has a length_m");
    if (table.has("detune_cents"))
      table.complain("detune_cents", "detune_cents has no effect on a tube with a length_m");
  }
  return resonator;
}

}  // namespace

Resonator Resonator::scaled(double scale) const {
  Resonator other = *this;
  other.radius_m *= scale;
  other.mouth_m = scale * mouth_m;
  if (other.length_m) *other.length_m *= scale;
  return other;
}

void read_resonators(TomlTable& file, std::vector<Resonator>& resonators) {
  for (TomlTable& table : file.tables("resonator")) resonators.push_back(read_resonator(table));
  if (resonators.size() > kMaxResonators)
    file.complain("resonator", "an object may have " + std::to_string(kMaxResonators) + " resonators at most");
}

}  // namespace ringdown::bake
