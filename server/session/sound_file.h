// A sound file that is written piece by piece under a temporary name, and gets its final name when complete.
//
//   auto file = SoundFile::create({"take.wav"}, 48000);
//   file->write(samples);            // left right left right ...
//   file->finish();                  // without finish(), the destructor removes the file
//
// [worker]
#pragma once

#include "engine/base/output_file.h"
#include "engine/base/result.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>

namespace ringdown::session {

struct SoundFormat {
  std::size_t channels = 2;
  std::string comment = {};  // comment stored in the file
  std::size_t frames = 0;    // length of the whole file; 0: unknown
  int bits = 32;             // of a sample in a WAV: 32 (float) or 24
};

class SoundFile {
 public:
  // Creates a WAV of 32-bit floats or 24 bits, or a 24-bit FLAC if the name ends in .flac. WAV that is known to exceed
  // 4 GiB, the limit of its length fields, is written as RF64 (EBU Tech 3306), which programs that read WAV also read.
  // Fails for other endings, except those of streams, and if no file can be made. Use a path from a message as the
  // target itself, and output_target() for a user's path.
  static Result<SoundFile> create(OutputTarget target, double sample_rate_hz, const SoundFormat& format = {});
  SoundFile(SoundFile&&) noexcept;
  SoundFile& operator=(SoundFile&&) noexcept;
  ~SoundFile();

  // Appends frames of one sample for each channel. Fails when the disk is full.
  Result<void> write(std::span<const float> samples);

  // Completes the file and renames it, or copies it to the stream. After a failed write() the file has the sound that
  // was written before. Call last.
  Result<void> finish();

 private:
  struct Open;
  explicit SoundFile(std::unique_ptr<Open> open);
  std::unique_ptr<Open> open_;
};

}  // namespace ringdown::session
