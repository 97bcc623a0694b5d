#include "tests/integration/sound_file.h"

#include <sndfile.h>

namespace ringdown::test {
namespace {

struct Frames {
  Samples samples;
  std::size_t channels = 1;
};

Frames read(const std::filesystem::path& path) {
  SF_INFO info{};
  SNDFILE* const file = sf_open(path.c_str(), SFM_READ, &info);
  if (!file) return {};
  Frames frames{Samples(static_cast<std::size_t>(info.frames * info.channels)),
                static_cast<std::size_t>(info.channels)};
  sf_readf_double(file, frames.samples.data(), info.frames);
  sf_close(file);
  return frames;
}

}  // namespace

Samples read_frames(const std::filesystem::path& path) { return read(path).samples; }

Samples read_left(const std::filesystem::path& path) {
  const auto [frames, channels] = read(path);
  Samples left;
  for (std::size_t i = 0; i < frames.size(); i += channels) left.push_back(frames[i]);
  return left;
}

}  // namespace ringdown::test
