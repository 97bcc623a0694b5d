// Files, packets and messages for one reader each: what tests/fuzz feeds, without its compiler, and sound files.
#include "clients/cli/fit/sound.h"
#include "engine/base/folders.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/targets.h"
#include "tests/hostile/attack.h"
#include "tests/hostile/banks.h"

#include <algorithm>
#include <cstring>
#include <fstream>

namespace ringdown::hostile {
namespace {

constexpr std::size_t kMaxInputBytes = 16384;

// A target of tests/fuzz, fed with changed files of its corpus.
class ReaderAttack : public Attack {
 public:
  explicit ReaderAttack(const std::string& name)
      : feed_(std::ranges::find(fuzz::kTargets, name, &fuzz::Target::name)->feed),
        mutator_(fuzz::inputs_of({std::filesystem::path(RINGDOWN_SOURCE_DIR "/tests/fuzz/corpus") / name})) {}
  std::string make(Random& random) override { return mutator_.next(random.engine(), kMaxInputBytes); }
  void feed(const std::string& input, Random& /*random*/) override { feed_(std::as_bytes(std::span(input))); }

 private:
  void (*feed_)(fuzz::Bytes);
  fuzz::Mutator mutator_;
};

class BankAttack : public Attack {
 public:
  std::string make(Random& random) override { return hostile_bank(random); }
  void feed(const std::string& input, Random& /*random*/) override { fuzz::bank(std::as_bytes(std::span(input))); }
};

// A little WAV file of 16-bit or float samples.
std::string wav(std::uint16_t channels, bool floats) {
  constexpr std::size_t kFrames = 64;
  const std::uint16_t bytes = floats ? 4 : 2;
  std::string samples(kFrames * channels * bytes, '\x21');
  std::string file = "RIFF....WAVEfmt ";
  const auto add = [&file](auto number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    file.append(raw, sizeof number);
  };
  const std::uint32_t rate = 48000, frame = channels * bytes, size = static_cast<std::uint32_t>(samples.size());
  add(std::uint32_t{16}), add(static_cast<std::uint16_t>(floats ? 3 : 1)), add(channels), add(rate), add(rate * frame);
  add(static_cast<std::uint16_t>(frame)), add(static_cast<std::uint16_t>(8 * bytes));
  file += "data";
  add(size);
  file += samples;
  const auto riff = static_cast<std::uint32_t>(file.size() - 8);
  std::memcpy(file.data() + 4, &riff, sizeof riff);
  return file;
}

class SoundAttack : public Attack {
 public:
  std::string make(Random& random) override { return mutator_.next(random.engine(), kMaxInputBytes); }
  void feed(const std::string& input, Random& random) override {
    const auto path = folder_.path() / "sound.wav";
    std::ofstream(path, std::ios::binary) << input;
    const auto sound = random.one_in(2) ? cli::read_sound(path, 1) : cli::read_sound(path, std::nullopt);
    if (!sound) return fuzz::expect(!sound.error().message.empty(), "a refusal has a sentence");
    fuzz::expect(sound->sample_rate_hz > 0 && sound->channels > 0, "a sound has a rate and channels");
    fuzz::expect(std::ranges::all_of(sound->samples, [](double x) { return std::isfinite(x); }), "samples are finite");
  }

 private:
  PrivateFolder folder_{"ringdown-hostile"};
  fuzz::Mutator mutator_{{wav(1, false), wav(2, false), wav(1, true), wav(6, true)}};
};

template <class Kind>
std::unique_ptr<Attack> begin(const std::string& /*name*/) {
  return std::make_unique<Kind>();
}

std::unique_ptr<Attack> begin_reader(const std::string& name) { return std::make_unique<ReaderAttack>(name); }

// Each kind's share of the inputs. Kinds that cost a process or a connection for each input get less.
double share_of(const std::string& name) {
  constexpr std::pair<const char*, double> kShares[] = {{"osc", 40},     {"stream", 25}, {"midi", 20},    {"mesh", 18},
                                                        {"score", 18},   {"bank", 18},   {"reader", 0.4}, {"http", 4},
                                                        {"settings", 5}, {"options", 5}, {"scene", 8},    {"gltf", 8}};
  const auto* found = std::ranges::find(kShares, name, &std::pair<const char*, double>::first);
  return found == std::end(kShares) ? 10 : found->second;
}

}  // namespace

std::vector<Kind> reader_kinds() {
  constexpr std::size_t kSlice = 2000;
  std::vector<Kind> kinds;
  for (const fuzz::Target& target : fuzz::kTargets) {
    kinds.push_back({target.name, share_of(target.name), kSlice, begin_reader});
  }
  kinds.push_back({"bank-numbers", 20, kSlice, begin<BankAttack>});
  kinds.push_back({"sound", 4, kSlice, begin<SoundAttack>});
  return kinds;
}

}  // namespace ringdown::hostile
