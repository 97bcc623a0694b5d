#include "tests/bench/mixer/supercollider_files.h"

#include "engine/base/atomic_file.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::bench {
namespace {

constexpr float kNoiseLevel = 1e-3f;
constexpr float kRingTime_s = 60;

// Both formats are big-endian.
class Bytes {
 public:
  void add8(std::uint8_t value) { text_.push_back(static_cast<char>(value)); }
  void add16(std::uint16_t value) {
    add8(static_cast<std::uint8_t>(value >> 8)), add8(static_cast<std::uint8_t>(value));
  }
  void add32(std::uint32_t value) {
    add16(static_cast<std::uint16_t>(value >> 16)), add16(static_cast<std::uint16_t>(value));
  }
  void add_float(float value) { add32(std::bit_cast<std::uint32_t>(value)); }
  void add_text(std::string_view text) { text_ += text; }
  void add_pascal(std::string_view text) { add8(static_cast<std::uint8_t>(text.size())), add_text(text); }
  void add_padded(std::string_view text) { add_text(text), text_.append(4 - text.size() % 4, '\0'); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// One synth definition: a list of unit generators, each reading constants and generators before it.
class Definition {
 public:
  struct Input {
    int generator;  // -1: a constant
    std::uint32_t place;
  };
  Input constant(float value) {
    const auto [known, added] = place_of_.try_emplace(value, static_cast<std::uint32_t>(constants_.size()));
    if (added) constants_.push_back(value);
    return {-1, known->second};
  }
  // All run at audio rate and have one output, but Out, which has none.
  Input generator(std::string_view name, const std::vector<Input>& inputs, std::uint16_t special = 0) {
    constexpr std::uint8_t kAudioRate = 2;
    const bool has_output = name != "Out";
    generators_.add_pascal(name);
    generators_.add8(kAudioRate);
    generators_.add32(static_cast<std::uint32_t>(inputs.size()));
    generators_.add32(has_output ? 1 : 0);
    generators_.add16(special);
    for (const Input& input : inputs)
      generators_.add32(static_cast<std::uint32_t>(input.generator)), generators_.add32(input.place);
    if (has_output) generators_.add8(kAudioRate);
    return {count_++, 0};
  }
  void write(Bytes& to, std::string_view name) const {
    to.add_pascal(name);
    to.add32(static_cast<std::uint32_t>(constants_.size()));
    for (const float value : constants_) to.add_float(value);
    to.add32(0), to.add32(0);  // parameters and their names
    to.add32(static_cast<std::uint32_t>(count_));
    to.add_text(generators_.text());
    to.add16(0);  // variants
  }

 private:
  std::vector<float> constants_;
  std::map<float, std::uint32_t> place_of_;
  Bytes generators_;
  int count_ = 0;
};

Definition::Input add_noise(Definition& definition) {
  constexpr std::uint16_t kTimes = 2;  // BinaryOpUGen's number for *
  const auto noise = definition.generator("WhiteNoise", {});
  return definition.generator("BinaryOpUGen", {noise, definition.constant(kNoiseLevel)}, kTimes);
}

Definition noise_definition() {
  Definition definition;
  const auto noise = add_noise(definition);
  definition.generator("Out", {definition.constant(0), noise});
  return definition;
}

// Klank's inputs: what it filters, frequency scale and offset, decay scale, then frequency, amplitude and ring time of
// every mode.
Definition klank_definition(std::size_t modes) {
  Definition definition;
  std::vector<Definition::Input> inputs = {add_noise(definition), definition.constant(1), definition.constant(0),
                                           definition.constant(1)};
  for (std::size_t m = 0; m < modes; ++m) {
    const double place = (static_cast<double>(m) + 0.5) / static_cast<double>(modes);
    inputs.push_back(definition.constant(static_cast<float>(40 * std::pow(19000.0 / 40, place))));
    inputs.push_back(definition.constant(1 / static_cast<float>(modes)));
    inputs.push_back(definition.constant(kRingTime_s));
  }
  const auto klank = definition.generator("Klank", inputs);
  definition.generator("Out", {definition.constant(0), klank});
  return definition;
}

std::string message(std::string_view address, std::string_view types, const std::string& arguments) {
  Bytes bytes;
  bytes.add_padded(address);
  bytes.add_padded(types);
  bytes.add_text(arguments);
  return bytes.text();
}

std::string text_message(std::string_view address, const std::string& argument) {
  Bytes bytes;
  bytes.add_padded(argument);
  return message(address, ",s", bytes.text());
}

std::string new_synth(std::string_view definition) {
  constexpr std::uint32_t kAnyNumber = 0xFFFFFFFFu, kAtTail = 1, kRootGroup = 0;
  Bytes bytes;
  bytes.add_padded(definition);
  bytes.add32(kAnyNumber), bytes.add32(kAtTail), bytes.add32(kRootGroup);
  return message("/s_new", ",siii", bytes.text());
}

// A score is bundles, each after its size; one holds one message here, as scsynth takes 8 kB at most.
void add_bundle(Bytes& score, double time_s, const std::string& content) {
  Bytes bundle;
  bundle.add_padded("#bundle");
  bundle.add32(static_cast<std::uint32_t>(time_s));
  bundle.add32(static_cast<std::uint32_t>(std::ldexp(time_s - std::floor(time_s), 32)));
  bundle.add32(static_cast<std::uint32_t>(content.size()));
  bundle.add_text(content);
  score.add32(static_cast<std::uint32_t>(bundle.text().size()));
  score.add_text(bundle.text());
}

}  // namespace

Result<void> write_klank_definition(const std::filesystem::path& path, std::size_t modes) {
  Bytes file;
  file.add_text("SCgf");
  file.add32(2);
  file.add16(2);
  noise_definition().write(file, "noise");
  klank_definition(modes).write(file, "klank");
  return write_file_atomically(path, file.text());
}

Result<void> write_klank_score(const std::filesystem::path& path, const std::filesystem::path& definition,
                               std::size_t synths, double seconds) {
  Bytes score;
  add_bundle(score, 0, text_message("/d_load", definition.string()));
  add_bundle(score, 0, new_synth("noise"));
  for (std::size_t s = 0; s < synths; ++s) add_bundle(score, 0, new_synth("klank"));
  add_bundle(score, seconds, message("/g_freeAll", ",i", std::string(4, '\0')));  // the root group: the end
  return write_file_atomically(path, score.text());
}

}  // namespace ringdown::bench
