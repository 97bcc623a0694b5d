// Output goes where it was told: each program that writes a file, given links, pipes and devices. Signals leave no part
// of a file.
#include "tests/batch/box_folder.h"
#include "tests/integration/process.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sndfile.hh>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <thread>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string program(const std::string& name) { return RINGDOWN_BIN_DIR "/" + name; }
const std::string kBanks = RINGDOWN_SOURCE_DIR "/presets/banks/";

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A tetrahedron's surface, a quarter of a second of a decaying tone, a scene without objects.
void write_inputs(const fs::path& folder) {
  std::ofstream(folder / "solid.ply")
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n.1 0 0\n0 .1 0\n0 0 .1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  std::ofstream(folder / "still.toml") << "[scene]\nduration_s = 0.1\n";
  std::array<double, 12000> tone{};
  for (std::size_t n = 0; n < tone.size(); ++n) {
    const double t_s = static_cast<double>(n) / 48000;
    tone[n] = 0.5 * std::exp(-30 * t_s) * std::sin(2 * std::numbers::pi * 700 * t_s);
  }
  SndfileHandle(folder / "blow.wav", SFM_WRITE, SF_FORMAT_WAV | SF_FORMAT_FLOAT, 1, 48000)
      .write(tone.data(), tone.size());
}

struct Writer {
  friend void PrintTo(const Writer& writer, std::ostream* out) { *out << writer.name; }

  std::string name, ending;
  Words command;            // IN stands for the folder of inputs; the output follows
  bool tells_time = false;  // no two files are equal
};

const BoxFolder& boxes() {
  static const BoxFolder folder;
  return folder;
}

std::vector<Writer> writers() {
  boxes().box("box", 100);
  std::vector<Writer> all = {
      {"render", ".wav", {"ringdown", "render", "--seconds", "0.1", "-o"}},
      {"flac", ".flac", {"ringdown", "render", "--seconds", "0.1", "-o"}},
      {"materials", ".wav", {"ringdown", "materials", "steel", "--sound"}},
      {"scale", ".glb", {"ringdown", "scale", kBanks + "wrench.glb", "--size", "2", "-o"}},
      {"daemon", ".wav", {"ringdownd", "--settings", "none", "--driver", "wav", "--scene", "IN/still.toml", "-o"}},
      {"capture",
       ".wav",
       {"ringdownd", "--settings", "none", "--driver", "null", "--port", "0", "--seconds", "0.1", "--capture"},
       true},
      {"record",
       ".osc",
       {"ringdownd", "--settings", "none", "--driver", "null", "--port", "0", "--seconds", "0.1", "--record"},
       true},
      {"bake",
       ".glb",
       {"ringdown-bake", boxes().objects() / "box.toml", "--materials", boxes().materials(), "--no-cache", "-o"}},
      {"check", ".ply", {"ringdown-check", "mesh", "IN/solid.ply", "-o"}},
      {"fill", ".glb", {"ringdown-fill", kBanks + "wine-glass.glb", "--level", "0.12", "-o"}},
      {"fit", ".glb", {"ringdown-fit", "IN/blow.wav", "--floor", "30", "-o"}},
      {"residual", ".wav", {"ringdown-fit", "IN/blow.wav", "--floor", "30", "--residual"}},
      {"png", ".png", {"ringdown-picture", kBanks + "wrench.glb", "-o"}},
      {"html", ".html", {"ringdown-picture", kBanks + "wrench.glb", "-o"}},
      {"bullet", ".osc", {"ringdown-bullet", "IN/still.toml", "--seconds", "0.1", "--events"}},
  };
  std::erase_if(all, [](const Writer& writer) { return !fs::exists(program(writer.command[0])); });
  return all;
}

class Output : public testing::TestWithParam<Writer> {
 protected:
  Output() {
    write_inputs(in_.path());
    output_ = out_ / ("out" + GetParam().ending);
  }

  // The command as one line for a shell.
  [[nodiscard]] std::string line(const fs::path& output) const {
    std::string text;
    for (const std::string& word : command(output)) text += "'" + word + "' ";
    return text;
  }
  [[nodiscard]] Words command(const fs::path& output) const {
    Words words = GetParam().command;
    words[0] = program(words[0]);
    for (std::string& word : words) {
      if (word.starts_with("IN/")) word = in_.path() / word.substr(3);
    }
    words.push_back(output);
    return words;
  }
  [[nodiscard]] Outcome write(const fs::path& output) const { return run(command(output)); }

  // What the program writes to a plain file.
  [[nodiscard]] std::string expected() const {
    const fs::path plain = in_.path() / ("plain" + GetParam().ending);
    const Outcome ran = write(plain);
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    return content(plain);
  }
  void expect_written(const std::string& found, const fs::path& where) const {
    if (GetParam().tells_time) {
      EXPECT_EQ(found.substr(0, 4), expected().substr(0, 4)) << where;
    } else {
      EXPECT_TRUE(found == expected()) << where << " has " << found.size() << " bytes, which are others";
    }
  }
  [[nodiscard]] std::size_t files_out() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(out_.path()), {}));
  }

  TemporaryFolder in_, out_, far_;
  fs::path output_;
};

TEST_P(Output, ALinkIsFollowedAndTheFileAtItsEndReplaced) {
  const fs::path far = far_.write("far" + GetParam().ending, "old");
  fs::create_symlink(far, output_);
  std::ifstream reader(far);
  const Outcome ran = write(output_);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(fs::read_symlink(output_), far);
  expect_written(content(far), far);
  std::string before;
  reader >> before;
  EXPECT_EQ(before, "old") << "the file was not replaced, but written over";
  EXPECT_EQ(files_out(), 1u);
}

TEST_P(Output, ADanglingLinkIsFollowed) {
  const fs::path far = far_ / ("new" + GetParam().ending);
  fs::create_symlink("hop", output_);
  fs::create_symlink(far, out_ / "hop");
  const Outcome ran = write(output_);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  expect_written(content(far), far);
  EXPECT_EQ(files_out(), 2u);
}

TEST_P(Output, APipeGetsTheBytesAndStaysAPipe) {
  ASSERT_EQ(::mkfifo(output_.c_str(), 0600), 0);
  const fs::path copy = in_ / "copy";
  Process reader({"sh", "-c", "cat '" + output_.string() + "' > '" + copy.string() + "'"});
  const Outcome ran = write(output_);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  ASSERT_EQ(reader.wait(), 0);
  EXPECT_TRUE(fs::is_fifo(output_));
  expect_written(content(copy), output_);
  EXPECT_EQ(files_out(), 1u);
}

TEST_P(Output, TheStandardOutputGetsTheBytesAndNothingElse) {
  fs::create_symlink("/dev/stdout", output_);
  const fs::path copy = in_ / "copy";
  const Outcome ran = run({"bash", "-o", "pipefail", "-c", line(output_) + "| cat > '" + copy.string() + "'"});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_TRUE(fs::is_symlink(output_));
  expect_written(content(copy), output_);
}

// A link stands for the device: a program that replaces what it is given replaces the link, not /dev/full.
TEST_P(Output, AFullDeviceIsAFailureWithASentence) {
  fs::create_symlink("/dev/full", output_);
  const Outcome ran = write(output_);
  EXPECT_EQ(ran.exit_code, 1) << ran.output;
  EXPECT_NE(ran.output.find("No space left on device"), std::string::npos) << ran.output;
  EXPECT_EQ(fs::read_symlink(output_), "/dev/full");
  EXPECT_EQ(files_out(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Programs, Output, testing::ValuesIn(writers()),
                         [](const auto& writer) { return writer.param.name; });

TEST(OutputByName, TheStandardOutputIsAppendedToWhereTheShellAppends) {
  const TemporaryFolder folder;
  const std::string render = program("ringdown") + " render --seconds 0.01 -o ";
  const fs::path file = folder.write("all", "before"), plain = folder / "plain.wav";
  ASSERT_EQ(run({"sh", "-c", render + plain.string()}).exit_code, 0);
  ASSERT_EQ(run({"sh", "-c", render + "/dev/stdout >> '" + file.string() + "'"}).exit_code, 0);
  EXPECT_TRUE(content(file) == "before" + content(plain));
}

TEST(OutputByName, ALinkThatLeadsToItselfIsAFailure) {
  const TemporaryFolder folder;
  fs::create_symlink("a.wav", folder / "a.wav");
  const Outcome ran = run({program("ringdown"), "render", "--seconds", "0.01", "-o", folder / "a.wav"});
  EXPECT_EQ(ran.exit_code, 1) << ran.output;
  EXPECT_NE(ran.output.find("Too many levels of symbolic links"), std::string::npos) << ran.output;
}

// Whether the process handles SIGTERM by now: its bit of SigCgt in the process's status.
bool handles_sigterm(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("SigCgt:")) return (std::stoull(line.substr(7), nullptr, 16) >> (SIGTERM - 1)) & 1;
  }
  return false;
}

// Ten minutes in 16 bits, which take minutes to fit.
void write_noise(const fs::path& path) {
  constexpr std::uint32_t kRate = 48000, kBytes = 599 * kRate * 2;
  std::ofstream file(path, std::ios::binary);
  const auto put = [&file](std::uint32_t number, std::streamsize size) {
    file.write(reinterpret_cast<const char*>(&number), size);
  };
  file << "RIFF";
  put(36 + kBytes, 4);
  file << "WAVEfmt ";
  put(16, 4), put(1, 2), put(1, 2), put(kRate, 4), put(2 * kRate, 4), put(2, 2), put(16, 2);
  file << "data";
  put(kBytes, 4);
  std::vector<std::int16_t> samples(kBytes / 2);
  std::minstd_rand random(1);
  for (std::int16_t& sample : samples) sample = static_cast<std::int16_t>(random());
  file.write(reinterpret_cast<const char*>(samples.data()), kBytes);
}

// Each command would last for minutes, or for ever: a pipe that nobody reads.
TEST(Interrupted, ALongCommandEndsWith130AndLeavesNoFile) {
  const TemporaryFolder in, out;
  ASSERT_EQ(::mkfifo((in / "pipe.png").c_str(), 0600), 0);
  write_noise(in / "long.wav");
  boxes().slow("slow");
  const std::vector<Words> commands = {
      {"ringdown", "render", "--seconds", "3000", "--block", "1", "-o", out / "a.wav"},
      {"ringdown-fit", in / "long.wav", "--residual", out / "a.wav"},
      {"ringdown-picture", kBanks + "wrench.glb", "-o", in / "pipe.png"},
      {"ringdown-bake", boxes().objects() / "slow.toml", "--materials", boxes().materials(), "--no-cache", "-o",
       out / "a.glb"},
  };
  for (Words command : commands) {
    if (!fs::exists(program(command[0]))) continue;
    command[0] = program(command[0]);
    for (const int signal : {SIGINT, SIGTERM}) {
      Process process(command);
      while (!handles_sigterm(process.id()) && !process.wait(1ms)) {
      }
      process.send_signal(signal);
      EXPECT_EQ(process.wait(60s), 130) << command[0] << ": " << process.output();
    }
  }
  EXPECT_TRUE(fs::is_empty(out.path()));
}

TEST(Input, FitRefusesAPipeInsteadOfWaiting) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.wav").c_str(), 0600), 0);
  const Outcome ran = run({program("ringdown-fit"), folder / "pipe.wav"}, {}, 20s);
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_NE(ran.output.find("pipe.wav as a sound: it is not a regular file"), std::string::npos) << ran.output;
}

TEST(Input, TheSentenceAboutAMissingFolderIsAboutTheFolder) {
  const Outcome ran = run({program("ringdown-bake"), "/nowhere/objects", "--jobs", "2", "-o", "/nowhere/banks"});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_EQ(ran.output, "ringdown-bake: there is no folder /nowhere/objects\n");
}

}  // namespace
}  // namespace ringdown::test
