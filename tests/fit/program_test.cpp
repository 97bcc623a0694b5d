// ringdown-fit as its user meets it: exit codes, what it prints, what it leaves behind.
#include "engine/modal/bank_file.h"
#include "tests/fit/recording.h"
#include "tests/integration/process.h"
#include "tests/integration/sound_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

const std::string kProgram = RINGDOWN_BIN_DIR "/ringdown-fit";

// One vector for each channel.
void write(const fs::path& path, const std::vector<std::vector<double>>& channels, int rate, int format) {
  SF_INFO info{.samplerate = rate, .channels = static_cast<int>(channels.size()), .format = format};
  SNDFILE* const file = sf_open(path.c_str(), SFM_WRITE, &info);
  ASSERT_TRUE(file);
  std::vector<double> frames;
  for (std::size_t n = 0; n < channels[0].size(); ++n) {
    for (const auto& channel : channels) frames.push_back(channel[n]);
  }
  sf_writef_double(file, frames.data(), static_cast<sf_count_t>(channels[0].size()));
  sf_close(file);
}

Outcome fit(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), kProgram);
  return run(arguments);
}

const std::vector<Tone> kTones = {{440, 3, 0.3}, {1870, 8, 0.2}, {7000, 30, 0.1}};

TEST(FitProgram, ARecordingBecomesABankAndSounds) {
  const TemporaryFolder folder;
  auto samples = struck(kTones, 1.2, 0.1);
  add_noise(samples, 1e-4);
  write(folder / "cup.flac", {samples}, 48000, SF_FORMAT_FLAC | SF_FORMAT_PCM_24);
  const Outcome ran = fit({folder / "cup.flac", "-o", folder / "cup.glb", "--residual", folder / "rest.wav",
                           "--resynth", folder / "modes.wav"});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("3 modes explain 100.00 % of the energy"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("A4 +0 ct"), std::string::npos) << ran.output;
  const auto bank = modal::read_bank(folder / "cup.glb");
  ASSERT_TRUE(bank) << bank.error().message;
  EXPECT_EQ(bank->name, "cup");
  EXPECT_EQ(bank->mode_count(), 3u);
  EXPECT_LT(relative_error_db(read_left(folder / "modes.wav"), struck(kTones, 1.2, 0.1)), -50);
  EXPECT_LT(rms(read_left(folder / "rest.wav")), 1.5e-4);
}

TEST(FitProgram, WhatIsWrittenOfADullBlowHasItsEnergyOnce) {
  const TemporaryFolder folder;
  auto samples = struck({{310, 200, 0.4, 1.1}, {790, 330, 0.3, 2.3}, {815, 300, 0.3, 4}}, 0.6, 0.2);
  std::vector<double> click(samples.size());
  add_noise(click, 0.05, 9);
  for (std::size_t n = 0; n < click.size(); ++n) {
    const double t = static_cast<double>(n) / kRate - 0.2;
    samples[n] += t < 0 ? 0 : click[n] * std::exp(-150 * t);
  }
  const double energy = rms(samples);
  add_noise(samples, 1e-4);
  write(folder / "pad.wav", {samples}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  const Outcome ran = fit({folder / "pad.wav", "--resynth", folder / "again.wav"});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NEAR(20 * std::log10(rms(read_left(folder / "again.wav")) / energy), 0, 0.7);
}

TEST(FitProgram, ChannelsAreMixedOrChosen) {
  const TemporaryFolder folder;
  write(folder / "two.wav", {struck({{500, 5, 0.4}}, 1), struck({{900, 5, 0.4}}, 1)}, 44100,
        SF_FORMAT_WAV | SF_FORMAT_PCM_16);
  EXPECT_NE(fit({folder / "two.wav"}).output.find(": 2 modes"), std::string::npos);
  const Outcome second = fit({folder / "two.wav", "--channel", "2"});
  EXPECT_NE(second.output.find(": 1 modes"), std::string::npos) << second.output;
  EXPECT_NE(second.output.find("826.87"), std::string::npos) << "900 Hz at 44.1/48 of its speed: " << second.output;
  EXPECT_EQ(fit({folder / "two.wav", "--channel", "3"}).exit_code, 3);
}

// The frequencies of the loudest modes in what the program printed, by column.
std::vector<double> frequencies(const std::string& output) {
  std::vector<double> found;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    double number = 0, frequency_hz = 0;
    if (words >> number >> frequency_hz && number == static_cast<double>(found.size())) found.push_back(frequency_hz);
  }
  return found;
}

void expect_tones(const Outcome& ran) {
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  for (const Tone& tone : kTones) {
    EXPECT_TRUE(
        std::ranges::any_of(frequencies(ran.output), [&](double f) { return std::abs(f - tone.frequency_hz) < 0.01; }))
        << tone.frequency_hz << " Hz: " << ran.output;
  }
  EXPECT_EQ(ran.output.find("clipped"), std::string::npos) << ran.output;
}

// One channel is the other one turned over, to the last bit, or a little softer and with an offset.
TEST(FitProgram, TheLoudestOfChannelsThatCancelIsFitted) {
  const TemporaryFolder folder;
  for (const auto& [share, offset] : {std::pair(1.0, 0.0), {0.98, 0.02}}) {
    auto left = struck(kTones, 0.7, 0.1);
    add_noise(left, 1e-4);
    std::vector<double> right = left;
    for (double& sample : right) sample = offset - share * sample;
    write(folder / "two.wav", {right, left}, 48000, SF_FORMAT_WAV | SF_FORMAT_PCM_24);
    const Outcome ran = fit({folder / "two.wav"});
    expect_tones(ran);
    EXPECT_NE(ran.output.find("cancel each other"), std::string::npos) << ran.output;
    EXPECT_NE(ran.output.find("--channel"), std::string::npos) << ran.output;
  }
  const Outcome chosen = fit({folder / "two.wav", "--channel", "1"});
  expect_tones(chosen);
  EXPECT_EQ(chosen.output.find("warning"), std::string::npos) << chosen.output;
}

TEST(FitProgram, ASilentChannelDoesNotHalveTheLevel) {
  const TemporaryFolder folder;
  auto samples = struck({{500, 5, 0.4}}, 0.6, 0.1);
  add_noise(samples, 1e-4);
  const std::vector<double> silent(samples.size()), offset(samples.size(), 0.25);
  write(folder / "one.wav", {samples}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  const Outcome alone = fit({folder / "one.wav"});
  ASSERT_EQ(alone.exit_code, 0) << alone.output;
  for (const auto& other : {silent, offset}) {
    write(folder / "two.wav", {samples, other}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
    const Outcome ran = fit({folder / "two.wav"});
    EXPECT_NE(ran.output.find("channel 2 is silent"), std::string::npos) << ran.output;
    const auto table = [](const std::string& text) { return text.substr(text.find("onset")); };
    EXPECT_EQ(table(ran.output), table(alone.output));
  }
}

// Programs that write into a pipe leave the length of the data 0 in the header.
TEST(FitProgram, AWaveFileWithoutALengthIsReadToItsEnd) {
  const TemporaryFolder folder;
  auto samples = struck(kTones, 0.7, 0.1);
  add_noise(samples, 1e-4);
  for (const int format : {SF_FORMAT_PCM_24, SF_FORMAT_FLOAT}) {
    write(folder / "stream.wav", {samples}, 48000, SF_FORMAT_WAV | format);
    std::fstream file(folder / "stream.wav", std::ios::in | std::ios::out | std::ios::binary);
    std::string bytes(std::istreambuf_iterator<char>(file), {});
    file.clear();
    const auto data = bytes.find("data");
    ASSERT_NE(data, std::string::npos);
    for (const std::size_t at : {std::size_t{4}, data + 4})
      file.seekp(static_cast<std::streamoff>(at)).write("\0\0\0\0", 4);
    file.close();
    expect_tones(fit({folder / "stream.wav"}));
  }
}

TEST(FitProgram, WhatCannotBeFittedSaysWhyEachInItsOwnWords) {
  const TemporaryFolder folder;
  auto good = struck(kTones, 0.5);
  std::vector<double> broken = good;
  broken[4800] = std::nan("");
  write(folder / "silent.wav", {std::vector<double>(48000)}, 48000, SF_FORMAT_WAV | SF_FORMAT_PCM_16);
  write(folder / "constant.wav", {std::vector<double>(48000, 0.3)}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  write(folder / "nothing.wav", {{}}, 48000, SF_FORMAT_WAV | SF_FORMAT_PCM_16);
  write(folder / "nan.wav", {good, broken}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  (void)folder.write("empty.wav", "");
  (void)folder.write("text.wav", "no sound");
  const std::pair<std::string, std::string> cases[] = {
      {"silent.wav", "is silent"},      {"constant.wav", "is silent"},
      {"nothing.wav", "no samples"},    {"nan.wav", "not a number, at 0.1000 s in channel 2"},
      {"empty.wav", "it has no bytes"}, {"text.wav", "as a sound"}};
  for (const auto& [name, words] : cases) {
    const Outcome ran = fit({folder / name});
    EXPECT_EQ(ran.exit_code, 3) << ran.output;
    EXPECT_NE(ran.output.find(words), std::string::npos) << ran.output;
    EXPECT_NE(ran.output.find(name), std::string::npos) << ran.output;
  }
  EXPECT_EQ(fit({folder / "nan.wav", "--channel", "1"}).exit_code, 0);
}

TEST(FitProgram, TheProgramCalibratesABank) {
  const TemporaryFolder folder;
  const fs::path baked = fs::path(RINGDOWN_SOURCE_DIR) / "presets/banks/wooden-bar.glb";
  const auto bank = *modal::read_bank(baked);
  std::vector<Tone> tones;
  for (std::size_t m = 0; m < std::min<std::size_t>(8, bank.mode_count()); ++m) {
    const double others = bank.losses[m].total_per_s() - bank.losses[m].material_per_s;
    // The grain gives each mode a share of its own of what the material loses.
    const double f = bank.frequency_hz[m], list = modal::loss_factor_at(bank.material->loss_factors, f);
    tones.push_back({f, bank.losses[m].material_per_s * 4e-3 / list + others, 0.1});
  }
  auto samples = struck(tones, 1);
  add_noise(samples, 1e-4);
  write(folder / "bar.wav", {samples}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  const Outcome ran = fit({folder / "bar.wav", "--damping-of", baked, "-o", folder / "real.glb"});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_NE(ran.output.find("modes match"), std::string::npos) << ran.output;
  const auto real = modal::read_bank(folder / "real.glb");
  ASSERT_TRUE(real);
  ASSERT_EQ(real->material->loss_factors.size(), 1u) << ran.output;
  EXPECT_NEAR(real->material->loss_factors[0].eta / 4e-3, 1, 0.02);
}

TEST(FitProgram, TenMinutesAreReadAndNoFrameMore) {
  const TemporaryFolder folder;
  for (const std::size_t more : {0, 1}) {
    write(folder / "long.wav", {std::vector<double>(600 * 8000 + more)}, 8000, SF_FORMAT_WAV | SF_FORMAT_PCM_U8);
    const Outcome ran = fit({folder / "long.wav"});
    EXPECT_EQ(ran.exit_code, 3);
    EXPECT_EQ(ran.output.find("ten minutes") != std::string::npos, more > 0) << ran.output;
  }
}

TEST(FitProgram, RefusalsHaveTheirExitCodesAndOneSentence) {
  const TemporaryFolder folder;
  write(folder / "silence.wav", {std::vector<double>(48000)}, 48000, SF_FORMAT_WAV | SF_FORMAT_PCM_16);
  write(folder / "good.wav", {struck(kTones, 0.5)}, 48000, SF_FORMAT_WAV | SF_FORMAT_FLOAT);
  const fs::path text = folder.write("text.wav", "no sound");
  const std::string good = folder / "good.wav";
  const std::pair<std::vector<std::string>, int> cases[] = {
      {{}, 2},
      {{"/nowhere.wav"}, 3},
      {{text}, 3},
      {{folder / "silence.wav"}, 3},
      {{good, "--from", "0.49"}, 3},
      {{good, "--band", "900", "800"}, 3},
      {{good, "--impulse", "0,0,0"}, 2},
      {{good, "--impulse", "1,2"}, 2},
      {{good, "--max-modes", "0"}, 2},
      {{good, "--floor", "0"}, 2},
      {{good, "--band", "300", "900", "--damping-of", text}, 3},
      {{good, "--band", "300", "900", "-o", "/nowhere/x.glb"}, 1},
      {{good, "--band", "300", "900", "--residual", folder / "x.mp3"}, 1},
  };
  for (const auto& [arguments, exit_code] : cases) {
    const Outcome ran = fit(arguments);
    const std::string said = testing::PrintToString(arguments) + "\n" + ran.output;
    EXPECT_EQ(ran.exit_code, exit_code) << said;
    const auto sentence = ran.output.find("ringdown-fit: ");
    ASSERT_NE(sentence, std::string::npos) << said;
    EXPECT_EQ(std::count(ran.output.begin() + static_cast<long>(sentence), ran.output.end(), '\n'), 1) << said;
  }
}

}  // namespace
}  // namespace ringdown::test
