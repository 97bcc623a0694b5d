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

std::vector<Samples> read_channels(const std::filesystem::path& path) {
  const auto [frames, count] = read(path);
  std::vector<Samples> channels(count);
  for (std::size_t i = 0; i < frames.size(); ++i) channels[i % count].push_back(frames[i]);
  return channels;
}

Samples read_left(const std::filesystem::path& path) { return read_channels(path).front(); }

}  // namespace ringdown::test
