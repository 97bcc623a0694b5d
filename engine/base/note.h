// Frequencies as musicians name them.
#pragma once

#include "engine/base/formatted.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace ringdown {

// Returns the note number of a frequency, with fractions: 69.5 is a quarter tone above A4.
inline double note_of(double frequency_hz) { return 69 + 12 * std::log2(frequency_hz / 440); }

// Returns the nearest note of equal temperament at A4 = 440 Hz and the distance from that note: "A4 +0 ct". C4 is
// middle C. Returns "" if the frequency is not above 0 or not finite.
inline std::string note_name(double frequency_hz) {
  if (!(frequency_hz > 0) || !std::isfinite(frequency_hz)) return "";
  constexpr const char* kNames[] = {"C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B"};
  const double key = note_of(frequency_hz);  // MIDI's numbering: 60 is middle C
  const double nearest = std::round(key);
  const int octave = static_cast<int>(std::floor(nearest / 12)) - 1;
  const int step = static_cast<int>(nearest - 12 * std::floor(nearest / 12));
  return formatted("{}{} {:+.0f} ct", kNames[step], octave, 100 * (key - nearest));
}

// Returns the name of a MIDI number: "A4" for 69, "F#3" for 54.
inline std::string key_name(int number) {
  const std::string name = note_name(440 * std::exp2((number - 69) / 12.0));
  return name.substr(0, name.find(' '));
}

// Returns the MIDI number of a note: "A4" is 69, "C4" 60, "F#3" and "Fs3" and "Gb3" 54. Nothing if outside 0 to 127.
inline std::optional<int> note_number(std::string_view note) {
  constexpr std::string_view kLetters = "CDEFGAB";
  constexpr std::array kSteps = {0, 2, 4, 5, 7, 9, 11};
  const std::size_t letter = note.empty() ? std::string_view::npos : kLetters.find(note.front());
  if (letter == std::string_view::npos) return std::nullopt;
  note.remove_prefix(1);
  int number = kSteps[letter];
  if (!note.empty() && (note.front() == '#' || note.front() == 's' || note.front() == 'b')) {
    number += note.front() == 'b' ? -1 : 1;
    note.remove_prefix(1);
  }
  const bool below = note.starts_with('-');
  if (below) note.remove_prefix(1);
  if (note.size() != 1 || note.front() < '0' || note.front() > '9') return std::nullopt;
  number += 12 * ((below ? -1 : 1) * (note.front() - '0') + 1);
  return number >= 0 && number <= 127 ? std::optional(number) : std::nullopt;
}

inline double note_frequency(double number) { return 440 * std::exp2((number - 69) / 12); }

// Returns the note's name as part of a file name: "Fs3" for 54.
inline std::string note_word(int number) {
  constexpr std::array kNames = {"C", "Cs", "D", "Ds", "E", "F", "Fs", "G", "Gs", "A", "As", "B"};
  return kNames[number % 12] + std::to_string(number / 12 - 1);
}

}  // namespace ringdown
