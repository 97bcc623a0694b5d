// Frequencies as musicians name them.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace ringdown::cli {

// The nearest note of equal temperament at A4 = 440 Hz and how far off it is: "A4 +0 ct". C4 is middle C.
// "" when the frequency is no pitch: not above 0, or not finite.
inline std::string note_name(double frequency_hz) {
  if (!(frequency_hz > 0) || !std::isfinite(frequency_hz)) return "";
  constexpr const char* kNames[] = {"C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B"};
  const double key = 69 + 12 * std::log2(frequency_hz / 440);  // MIDI's numbering: 60 is middle C
  const double nearest = std::round(key);
  const int octave = static_cast<int>(std::floor(nearest / 12)) - 1;
  const int step = static_cast<int>(nearest - 12 * std::floor(nearest / 12));
  char text[32];
  std::snprintf(text, sizeof text, "%s%d %+.0f ct", kNames[step], octave, 100 * (key - nearest));
  return text;
}

}  // namespace ringdown::cli
