#include "clients/cli/fit/sound.h"

#include "engine/base/within_memory.h"
#include "server/session/offline.h"

#include <sndfile.h>

#include <memory>
#include <vector>

namespace ringdown::cli {
namespace {

// The mean of all channels, or one of them; `channel` counts from 1.
std::vector<double> samples_of(SNDFILE* file, int channels, std::optional<int> channel) {
  constexpr sf_count_t kBlock = 4096;
  std::vector<double> samples, frames(static_cast<std::size_t>(kBlock * channels));
  for (sf_count_t count; (count = sf_readf_double(file, frames.data(), kBlock)) > 0;) {
    for (sf_count_t n = 0; n < count; ++n) {
      const double* frame = frames.data() + n * channels;
      double sum = 0;
      for (int c = 0; c < channels; ++c) sum += frame[c];
      samples.push_back(channel ? frame[*channel - 1] : sum / channels);
    }
  }
  return samples;
}

}  // namespace

Result<Sound> read_sound(const std::filesystem::path& path, std::optional<int> channel) {
  std::error_code error;
  if (const auto status = std::filesystem::status(path, error); !std::filesystem::is_regular_file(status)) {
    return fail(ErrorKind::bad_input,
                "cannot read " + path.string() + " as a sound: " +
                    (std::filesystem::exists(status) ? "it is not a regular file; write the sound "
                                                       "to one first"
                                                     : "there is no such file"));
  }
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> file(sf_open(path.c_str(), SFM_READ, &info), sf_close);
  if (!file) return fail(ErrorKind::bad_input, "cannot read " + path.string() + " as a sound: " + sf_strerror(nullptr));
  if (channel && (*channel < 1 || *channel > info.channels)) {
    return fail(ErrorKind::bad_input, path.string() + " has channels 1 to " + std::to_string(info.channels) +
                                          ", and no channel " + std::to_string(*channel));
  }
  if (info.frames < 1 || info.frames > kMaxSound_s * info.samplerate) {
    return fail(ErrorKind::bad_input,
                path.string() + " is empty or longer than ten minutes; cut out the one blow that matters");
  }
  return within_memory("read " + path.string(), [&]() -> Result<Sound> {
    return Sound{static_cast<double>(info.samplerate), info.channels, samples_of(file.get(), info.channels, channel)};
  });
}

Result<void> write_sound(std::span<const double> samples, double sample_rate_hz, const std::filesystem::path& path,
                         const std::stop_token& stop) {
  session::Recording recording{.sample_rate_hz = sample_rate_hz};
  recording.left.assign(samples.begin(), samples.end());
  recording.right = recording.left;
  return session::write_audio(recording, path, [&stop](double) { return !stop.stop_requested(); });
}

}  // namespace ringdown::cli
