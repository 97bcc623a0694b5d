// Reads tunings in the formats of Scala: scales (.scl) and keyboard mappings (.kbm), as described at
// https://www.huygens-fokker.org/scala/scl_format.html and in Scala's help on mappings. [worker]
//
//   auto tuning = read_tuning("meantone.scl", "");             // middle C: degree 0, at its own pitch
//   auto mapped = read_tuning("meantone.scl", "white.kbm");
//   auto lower = read_tuning("", "a432.kbm");                  // equal temperament, mapped
//
// The error for a file that breaks its format is one sentence that begins with path:line.
#pragma once

#include "engine/base/result.h"
#include "engine/microtuning/key_tuning.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace ringdown::microtuning {

struct Scale {
  std::vector<double> cents;  // of the degrees 1, 2 ... above degree 0; the last is the period
};

struct KeyboardMapping {
  int first_key = 0, last_key = 127;  // other keys keep their equal temperament
  int middle_key = 60;                // plays the first degree of the pattern
  int reference_key = 60;
  double reference_note = 60;               // pitch of the reference key, as a MIDI note with fractions
  int octave_degree = 0;                    // the degree by which neighbouring patterns differ; 0: the scale's period
  std::vector<std::optional<int>> pattern;  // degrees of the keys from middle_key on; empty: each key one degree
};

Result<Scale> read_scale(const std::filesystem::path& path);
Result<KeyboardMapping> read_mapping(const std::filesystem::path& path);

// The mapping's reference key must be mapped; read_mapping() refuses any other.
KeyTuning tuning_of(const Scale& scale, const KeyboardMapping& mapping);

// Reads both files. An empty path stands for equal temperament, or for the mapping that KeyboardMapping has by default.
Result<KeyTuning> read_tuning(const std::filesystem::path& scale, const std::filesystem::path& mapping);

}  // namespace ringdown::microtuning
