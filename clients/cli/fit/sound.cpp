#include "clients/cli/fit/sound.h"

#include "engine/base/within_memory.h"
#include "server/session/offline.h"

#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

namespace fs = std::filesystem;

using SoundHandle = std::unique_ptr<SNDFILE, int (*)(SNDFILE*)>;
using Channels = std::vector<std::vector<double>>;

// Channels cancel each other if the energy of their mean is below this share of the energy that unrelated channels
// would have: 10 dB.
constexpr double kCancels = 0.1;

tl::unexpected<Error> refuse(const fs::path& path, const std::string& why) {
  return fail(ErrorKind::bad_input, path.string() + " " + why);
}

// Returns where the samples of a WAV file begin if its header states no length for them although some follow.
std::optional<std::streamoff> data_without_length(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 12> riff{};
  file.read(riff.data(), riff.size());
  const auto is = [](const char* at, std::string_view name) { return std::string_view(at, 4) == name; };
  if (!file || !is(riff.data(), "RIFF") || !is(riff.data() + 8, "WAVE")) return {};
  std::array<char, 8> chunk{};
  while (file.read(chunk.data(), chunk.size())) {
    std::uint32_t size = 0;
    for (std::size_t k = 0; k < 4; ++k) size |= std::uint32_t{static_cast<unsigned char>(chunk[4 + k])} << (8 * k);
    if (is(chunk.data(), "data")) {
      const std::streamoff at = file.tellg();
      return size == 0 && file.peek() != std::char_traits<char>::eof() ? std::optional(at) : std::nullopt;
    }
    file.seekg(size + size % 2, std::ios::cur);
  }
  return {};
}

// The end of a file, from an offset on, as libsndfile reads it.
class Tail {
 public:
  Tail(const fs::path& path, std::streamoff begin)
      : file_(path, std::ios::binary), begin_(begin), size_(static_cast<sf_count_t>(fs::file_size(path)) - begin) {
    file_.seekg(begin);
  }

  static Tail& of(void* data) { return *static_cast<Tail*>(data); }

  static SF_VIRTUAL_IO calls() {
    return {.get_filelen = [](void* data) { return of(data).size_; },
            .seek = [](sf_count_t to, int whence, void* data) { return of(data).seek(to, whence); },
            .read = [](void* to, sf_count_t count, void* data) { return of(data).read(static_cast<char*>(to), count); },
            .write = [](const void*, sf_count_t, void*) { return sf_count_t{0}; },
            .tell = [](void* data) { return of(data).at_; }};
  }

 private:
  sf_count_t seek(sf_count_t to, int whence) {
    at_ = to + (whence == SEEK_CUR ? at_ : whence == SEEK_END ? size_ : 0);
    file_.clear();
    file_.seekg(begin_ + at_);
    return at_;
  }

  sf_count_t read(char* to, sf_count_t count) {
    file_.read(to, count);
    at_ += file_.gcount();
    return file_.gcount();
  }

  std::ifstream file_;
  std::streamoff begin_;
  sf_count_t size_, at_ = 0;
};

// Opens such samples in the format that the header gives them.
SoundHandle open_without_length(Tail& tail, SF_INFO& info) {
  SF_INFO raw{};
  raw.samplerate = info.samplerate;
  raw.channels = info.channels;
  raw.format = SF_FORMAT_RAW | (info.format & SF_FORMAT_SUBMASK) | SF_ENDIAN_LITTLE;
  SF_VIRTUAL_IO calls = Tail::calls();
  SoundHandle file(sf_open_virtual(&calls, SFM_READ, &raw, &tail), sf_close);
  if (file) info = raw;
  return file;
}

// Reads all channels, or the wanted one alone; a sound that is too long is read a little beyond its limit.
Channels read_channels(SNDFILE* file, const SF_INFO& info, std::optional<int> wanted) {
  constexpr sf_count_t kBlock = 4096;
  const auto count = static_cast<std::size_t>(info.channels);
  const auto max = static_cast<std::size_t>(kMaxSound_s * info.samplerate);
  const std::size_t first = wanted ? static_cast<std::size_t>(*wanted - 1) : 0;
  Channels channels(wanted ? 1 : count);
  std::vector<double> frames(static_cast<std::size_t>(kBlock) * count);
  for (sf_count_t read; channels[0].size() <= max && (read = sf_readf_double(file, frames.data(), kBlock)) > 0;) {
    for (std::size_t n = 0; n < static_cast<std::size_t>(read); ++n) {
      for (std::size_t c = 0; c < channels.size(); ++c) channels[c].push_back(frames[n * count + first + c]);
    }
  }
  return channels;
}

double mean_of(const std::vector<double>& samples) {
  double sum = 0;
  for (const double x : samples) sum += x;
  return sum / static_cast<double>(samples.size());
}

// Returns the energy of a sound around its mean. A constant sound has none, and neither does one that varies only by
// rounding.
double energy_of(const std::vector<double>& samples) {
  constexpr double kRounding = 1e-12;
  const double mean = mean_of(samples);
  double sum = 0;
  for (const double x : samples) sum += (x - mean) * (x - mean);
  return sum > kRounding * kRounding * mean * mean * static_cast<double>(samples.size()) ? sum : 0;
}

std::string number(std::size_t channel) { return formatted("channel {}", channel + 1); }

// One channel of all that sound, and in `note` what was left out.
std::vector<double> mix(Channels& channels, std::vector<double> energies, std::string& note) {
  std::vector<std::size_t> heard;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (energies[c] > 0) {
      heard.push_back(c);
    } else {
      note += (note.empty() ? "" : ", ") + number(c);
    }
  }
  if (!note.empty()) note += " is silent and is left out";
  const auto parts = static_cast<double>(heard.size());
  std::vector<double> mixed(channels[0].size());
  double apart = 0;  // the energy that the mean of unrelated channels would have
  for (const std::size_t c : heard) {
    for (std::size_t n = 0; n < mixed.size(); ++n) mixed[n] += channels[c][n] / parts;
    apart += energies[c] / (parts * parts);
  }
  if (energy_of(mixed) >= kCancels * apart) return mixed;
  const auto loudest = static_cast<std::size_t>(std::ranges::max_element(energies) - energies.begin());
  note = formatted("the channels cancel each other in their mean; {}{} is taken alone; --channel takes another",
                   number(loudest), heard.size() > 1 ? ", the loudest," : "");
  return std::move(channels[loudest]);
}

// Reduces what was read to one channel.
Result<Sound> sound_of(Channels channels, const SF_INFO& info, std::optional<int> wanted, const fs::path& path) {
  Sound sound{static_cast<double>(info.samplerate), info.channels, {}, {}};
  std::vector<double> energies;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto wrong = std::ranges::find_if_not(channels[c], [](double x) { return std::isfinite(x); });
    if (wrong != channels[c].end()) {
      const std::string time = formatted("{:.4f}", static_cast<double>(wrong - channels[c].begin()) / info.samplerate);
      return refuse(path,
                    formatted("has a sample that is not a number, at {} s in {}{}", time,
                              number(wanted ? static_cast<std::size_t>(*wanted - 1) : c),
                              info.channels > 1 ? "; --channel takes another channel" : "; write the file again"));
    }
    energies.push_back(energy_of(channels[c]));
  }
  if (std::ranges::all_of(energies, [](double energy) { return energy == 0; })) {
    return refuse(path, formatted("is silent: no sample of {} differs from the others{}",
                                  wanted ? number(static_cast<std::size_t>(*wanted - 1)) : "it",
                                  wanted && info.channels > 1 ? "; --channel takes another channel" : ""));
  }
  sound.samples = mix(channels, std::move(energies), sound.note);
  return sound;
}

}  // namespace

Result<Sound> read_sound(const fs::path& path, std::optional<int> channel) {
  const std::string unreadable = "cannot read " + path.string() + " as a sound: ";
  std::error_code error;
  if (const auto status = fs::status(path, error); !fs::is_regular_file(status)) {
    return fail(ErrorKind::bad_input, unreadable + (fs::exists(status) ? "it is not a regular file; write the sound "
                                                                         "to one first"
                                                                       : "there is no such file"));
  }
  if (fs::file_size(path, error) == 0 && !error) return refuse(path, "is empty: it has no bytes; record it again");
  SF_INFO info{};
  std::optional<Tail> tail;  // outlives the sound file that reads it
  SoundHandle file(sf_open(path.c_str(), SFM_READ, &info), sf_close);
  if (!file) return fail(ErrorKind::bad_input, unreadable + sf_strerror(nullptr));
  if (channel && (*channel < 1 || *channel > info.channels)) {
    return refuse(path, formatted("has channels 1 to {}, and no channel {}", info.channels, *channel));
  }
  if (const auto at = info.frames == 0 ? data_without_length(path) : std::nullopt) {
    file = open_without_length(tail.emplace(path, *at), info);
    if (!file) return fail(ErrorKind::bad_input, unreadable + sf_strerror(nullptr));
  }
  return within_memory("read " + path.string(), [&]() -> Result<Sound> {
    Channels channels = read_channels(file.get(), info, channel);
    if (channels[0].empty()) return refuse(path, "is empty: it has a header and no samples; record it again");
    if (static_cast<double>(channels[0].size()) > kMaxSound_s * info.samplerate)
      return refuse(path, "is longer than ten minutes; cut out the one blow that matters");
    return sound_of(std::move(channels), info, channel, path);
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
