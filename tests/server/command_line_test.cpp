// The `ringdown` program, run for real: what it sends, prints and refuses.
#include "engine/base/note.h"
#include "tests/server/fake_daemon.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace ringdown::wire {
namespace {

const std::string kRingdown = RINGDOWN_BIN_DIR "/ringdown";

TEST(RingdownStrike, TheStrikeCommandSendsAPointOrAVertex) {
  FakeDaemon daemon;
  const std::string strike = kRingdown + " strike bell --to " + daemon.url();
  const Outcome at = run(strike + " --at 0.05,0,0.02 --impulse -0.02,0,0");
  EXPECT_EQ(at.exit_code, 0) << at.output;
  EXPECT_EQ(at.output, "");
  const Outcome vertex = run(strike + " --vertex 7 --impulse 0,0,-1e-2 --contact-time 0");
  EXPECT_EQ(vertex.exit_code, 0) << vertex.output;
  const auto received = daemon.received(2);
  ASSERT_EQ(received.size(), 2u);
  expect_example_blow(received[0]);
  EXPECT_EQ(received[1].message, (Message{"/object/bell/strike_vertex", {7., 0., 0., -0.01, 0.}}));
}

TEST(RingdownStrike, TheStrikeCommandPrintsARefusalByTheDaemon) {
  FakeDaemon daemon([](const Message& message) { return protocol::Fail{message.address, "there is no bell"}; });
  const Outcome outcome = run(kRingdown + " strike bell --vertex 0 --impulse 1,0,0 --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.output, "ringdown: there is no bell\n");
}

TEST(RingdownStrike, TheStrikeCommandSaysThatThereIsNoDaemon) {
  const OscSocket deaf = std::move(*OscSocket::bind());  // a port that nobody answers
  const std::string url = "osc.udp://127.0.0.1:" + std::to_string(deaf.port());
  const Outcome outcome = run(kRingdown + " strike bell --vertex 0 --impulse 1,0,0 --timeout 0.2 --to " + url);
  EXPECT_EQ(outcome.exit_code, 6);
  EXPECT_NE(outcome.output.find("no answer from a daemon at " + url), std::string::npos) << outcome.output;
}

TEST(RingdownStrike, WrongUseOfACommandIsRefusedBeforeAnythingIsSent) {
  const std::pair<const char*, const char*> wrong[] = {
      {"strike", "object"},
      {"strike bell --impulse 1,0,0", "--at"},
      {"strike bell --at 0,0,0 --vertex 1 --impulse 1,0,0", "--vertex"},
      {"strike bell --at 0,0,0", "--impulse"},
      {"strike bell --at 0,0 --impulse 1,0,0", "--at"},
      {"strike bell --at 0,0,x --impulse 1,0,0", "--at: 'x'"},
      {"strike bell --at 0,0,nan --impulse 1,0,0", "--at: 'nan'"},
      {"strike bell --at 0,0,0 --impulse 1e9,0,0", "(jx)"},
      {"strike bell --vertex 0.5 --impulse 1,0,0", "(vertex)"},
      {"strike 'my bell' --vertex 0 --impulse 1,0,0", "(object)"},
      {"strike bell --vertex 0 --impulse 1,0,0 --contact-time 1", "(contact_time)"},
      {"strike bell --vertex 0 --impulse 1,0,0 --to localhost:7770", "osc.udp://"},
      {"send /stauts", "/status"},
      {"send /object/bell/gain", "(gain)"},
      {"", "subcommand"},
      {"stike", ""},
  };
  for (const auto& [arguments, named] : wrong) {
    const Outcome outcome = run(kRingdown + " " + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments << ": " << outcome.output;
    EXPECT_NE(outcome.output.find(named), std::string::npos) << arguments << ": " << outcome.output;
  }
}

TEST(RingdownStrike, HelpDescribesTheArgumentsAsTheTableDoes) {
  const std::string help = run(kRingdown + " strike --help").output;
  std::string flat;  // CLI11 breaks lines
  for (const char c : help) {
    if (c != '\n' && !(c == ' ' && flat.ends_with(' '))) flat += c;
  }
  for (const protocol::ArgumentSpec& argument : (*protocol::find_address("/object/0/strike"))->arguments) {
    if (argument.sentence.starts_with("Its ")) continue;  // y and z stand with x
    EXPECT_NE(flat.find(argument.sentence), flat.npos) << argument.name << " in\n" << help;
  }
}

TEST(RingdownSend, TheSendCommandPrintsTheAnswer) {
  FakeDaemon daemon([](const Message&) { return protocol::VersionReply{"ringdownd", "9.8", 1}; });
  const Outcome outcome = run(kRingdown + " send /version --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("9.8"), std::string::npos) << outcome.output;
}

TEST(RingdownSend, TheSendCommandPrintsTheNumberButNotTheAddressThatWasAsked) {
  FakeDaemon daemon([](const Message& message) { return protocol::Done{message.address, 42}; });
  const Outcome outcome = run(kRingdown + " send /load bell a.glb --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("42"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("/load"), std::string::npos) << outcome.output;
}

TEST(RingdownSend, TheSendCommandWaitsForItsOwnAnswerAndNotForAnothers) {
  FakeDaemon daemon([](const Message&) { return protocol::Done{"/scene/clear", 1}; });
  const Outcome outcome = run(kRingdown + " send /load bell a.glb --timeout 0.2 --to " + daemon.url());
  EXPECT_EQ(outcome.exit_code, 6) << outcome.output;
}

TEST(RingdownProtocol, TheProtocolInMarkdownIsTheCommittedManual) {
  std::ifstream file(RINGDOWN_SOURCE_DIR "/docs/reference/protocol.md");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(run(kRingdown + " protocol --markdown").output, text.str());
}

// A folder with a copy of the program, and perhaps something else for its sibling.
class BakeFolder : public ::testing::Test {
 protected:
  BakeFolder() { std::filesystem::copy_file(kRingdown, folder_ / "ringdown"); }

  [[nodiscard]] Outcome bake(const std::string& arguments) const {
    return run((folder_ / "ringdown").string() + " bake " + arguments);
  }

  test::TemporaryFolder folder_;
};

TEST_F(BakeFolder, EveryArgumentOfBakeReachesTheSiblingUnchanged) {
  const std::filesystem::path sibling = folder_ / "ringdown-bake";
  std::ofstream(sibling) << "#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 7\n";
  std::filesystem::permissions(sibling, std::filesystem::perms::owner_all);
  const Outcome outcome = bake("'a b.toml' -o x.glb --help --modes=3 -- -y ''");
  EXPECT_EQ(outcome.output, "<a b.toml><-o><x.glb><--help><--modes=3><--><-y><>");
  EXPECT_EQ(outcome.exit_code, 7);
  EXPECT_EQ(bake("--help").output, "<--help>");
}

TEST_F(BakeFolder, OneSentenceSaysThatTheBakingSiblingIsMissing) {
  const Outcome outcome = bake("a.toml");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.output.find((folder_ / "ringdown-bake").string()), std::string::npos) << outcome.output;
}

TEST(NoteName, NoteNamesFollowEqualTemperament) {
  EXPECT_EQ(note_name(440), "A4 +0 ct");
  EXPECT_EQ(note_name(261.6256), "C4 +0 ct");  // middle C
  EXPECT_EQ(note_name(246.9417), "B3 +0 ct");  // the octave's number changes at C
  EXPECT_EQ(note_name(27.5), "A0 +0 ct");      // the piano's lowest
  EXPECT_EQ(note_name(20), "D#0 +49 ct");      // 19.445 Hz, and 1200 log2(20 / 19.445) = 48.7
  EXPECT_EQ(note_name(450), "A4 +39 ct");      // 1200 log2(45 / 44) = 38.9
  EXPECT_EQ(note_name(0), "");
}

TEST(RingdownInfo, TheInfoCommandListsEveryModeOfABank) {
  const std::string bank = RINGDOWN_SOURCE_DIR "/presets/banks/bronze-bell.glb";
  const Outcome outcome = run(kRingdown + " info " + bank);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  std::istringstream lines(outcome.output);
  std::string line;
  std::getline(lines, line);
  const std::size_t modes = std::stoul(line.substr(line.find(": ") + 2));
  while (std::getline(lines, line) && line.find("frequency Hz") == line.npos) {
  }
  std::size_t rows = 0;
  for (; std::getline(lines, line); ++rows) {
    std::istringstream row(line);
    std::size_t number = 0;
    double frequency = 0, t60 = 0, decay = 0;
    row >> number >> frequency >> t60 >> decay;
    EXPECT_EQ(number, rows);
    EXPECT_NEAR(t60 * decay, std::log(1000.0), 0.01) << line;
    EXPECT_TRUE(frequency >= 20 && frequency <= 20000) << line;
  }
  EXPECT_GT(modes, 0u);
  EXPECT_EQ(rows, modes);
}

TEST(RingdownInfo, AMissingBankIsABadInput) {
  const Outcome outcome = run(kRingdown + " info /nonexistent.glb");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.output.find("/nonexistent.glb"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace ringdown::wire
