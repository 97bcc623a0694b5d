// A sound file that is written piece by piece under a temporary name, and gets its own when it is complete.
//
//   auto file = SoundFile::create({"take.wav"}, 48000);
//   file->write(samples);            // left right left right ...
//   file->finish();                  // without, the destructor removes what was written
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
  std::string comment = {};  // is kept in the file
  std::size_t frames = 0;    // of the whole file, where that is known
};

class SoundFile {
 public:
  // 32-bit float WAV, or 24-bit FLAC when the name ends in .flac. WAV that is known to exceed 4 GiB, where its lengths
  // have no more digits, is written as RF64 (EBU Tech 3306), which the same programs read. Fails for other endings,
  // except those of streams, and where no file can be made. A path from a message is its own target; output_target()
  // follows a user's.
  static Result<SoundFile> create(OutputTarget target, double sample_rate_hz, const SoundFormat& format = {});
  SoundFile(SoundFile&&) noexcept;
  SoundFile& operator=(SoundFile&&) noexcept;
  ~SoundFile();

  // Appends frames of one sample for each channel. Fails when the disk is full.
  Result<void> write(std::span<const float> samples);

  // Completes the file and renames it, or copies it to the stream; also after a write() that failed, and then with what
  // was written before. Call last.
  Result<void> finish();

 private:
  struct Open;
  explicit SoundFile(std::unique_ptr<Open> open);
  std::unique_ptr<Open> open_;
};

}  // namespace ringdown::session
