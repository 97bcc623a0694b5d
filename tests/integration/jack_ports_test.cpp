// Ports of objects and groups, their metadata, and notes from another client.
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"

#include <jack/jack.h>

#include <cmath>
#include <fstream>
#include <memory>

namespace ringdown::test {
namespace {

constexpr double kPortsRate = 48000;

class JackPorts : public JackTest {
 protected:
  void SetUp() override {
    JackTest::SetUp();
    low_ = "low=" + bank("low.glb", 300, 0.1).string();
    high_ = "high=" + bank("high.glb", 1200, 0.1).string();
  }

  [[nodiscard]] bool exists(const std::string& port) const { return server_.connections().contains(port); }

  std::string low_, high_;
};

TEST_F(JackPorts, EachObjectHasAPortThatOthersComingAndGoingDoNotTouch) {
  Daemon daemon({"--ports", "objects", "--object", low_, "--object", high_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(becomes_true([&] { return exists("ringdown:low") && exists("ringdown:high"); }));
  JackRecorder recorder(server_.name(), "recorder", static_cast<std::size_t>(2 * kPortsRate));
  ASSERT_TRUE(recorder.connect("ringdown:low", "recorder:in_1"));
  ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_2"));

  ASSERT_TRUE(daemon.ask({"/object/high/free", {}}));
  ASSERT_TRUE(daemon.ask({"/load", {"third", (folder_ / "high.glb").string()}}));
  EXPECT_TRUE(becomes_true([&] { return exists("ringdown:third") && !exists("ringdown:high"); }));
  EXPECT_TRUE(server_.connections()["ringdown:low"].contains("recorder:in_1"));

  daemon.send(strike("third"));
  ASSERT_TRUE(recorder.wait_for(static_cast<std::size_t>(2 * kPortsRate)));
  EXPECT_EQ(peak(recorder.samples(0)), 0) << "only its own object is heard at a port";
  EXPECT_GT(peak(recorder.samples(1)), 0.01) << "all are heard in the mix";
}

TEST_F(JackPorts, AGroupSharesAPortInWhichItsObjectsAreHeard) {
  Daemon daemon({"--ports", "groups", "--object", low_, "--object", high_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_TRUE(daemon.ask({"/object/low/group", {"bells"}})->holds<protocol::Done>());
  EXPECT_TRUE(daemon.ask({"/object/high/group", {"bells"}})->holds<protocol::Done>());
  ASSERT_TRUE(becomes_true([&] { return exists("ringdown:bells"); }));
  daemon.send(strike("low"));
  daemon.send(strike("high"));
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 2; }));
  JackRecorder recorder(server_.name(), "recorder", static_cast<std::size_t>(kPortsRate));
  ASSERT_TRUE(recorder.connect("ringdown:bells", "recorder:in_1"));
  ASSERT_TRUE(recorder.wait_for(static_cast<std::size_t>(kPortsRate)));
  const Samples heard = recorder.samples(0);
  KeepSignals keep(kPortsRate);
  keep.add("bells", heard);
  const Spectrum bells = spectrum(std::span(heard).last(16384), kPortsRate);
  for (const double pitch_hz : {300., 1200.}) {
    EXPECT_GT(bells.magnitude[static_cast<std::size_t>(std::lround(pitch_hz / bells.bin_hz))], 1e-3) << pitch_hz;
  }
  EXPECT_TRUE(daemon.ask({"/object/low/group", {}})->holds<protocol::Done>());
  EXPECT_TRUE(daemon.ask({"/object/high/group", {}})->holds<protocol::Done>());
  EXPECT_TRUE(becomes_true([&] { return !exists("ringdown:bells"); }));
}

TEST_F(JackPorts, PatchbaysLearnNamesOrderAndGroupOfPorts) {
  if (!installed("jack_property")) GTEST_SKIP() << "needs jack_property (jack-tools)";
  Daemon daemon({"--ports", "objects", "--object", low_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(becomes_true([&] { return exists("ringdown:low"); }));
  const auto properties = [&] { return run({"jack_property", "-l"}, server_.environment()).output; };
  EXPECT_TRUE(becomes_true([&] { return properties().find("value: low") != std::string::npos; })) << properties();
  for (const char* wanted : {"pretty-name value: Mix left", "pretty-name value: Mix right", "port-group value: Mix",
                             "port-group value: Objects", "order value: 0", "order value: 2"}) {
    EXPECT_NE(properties().find(wanted), std::string::npos) << wanted << "\n" << properties();
  }
}

TEST_F(JackPorts, ANoteFromAnotherClientLandsOnItsSample) {
  std::ofstream(folder_ / "notes.toml") << "[[note]]\nnote = 48\nobject = 'low'\nimpulse_ns = [0, 0, 0.5]\n"
                                           "contact_time_s = 0\n";
  Daemon daemon({"--notes", (folder_ / "notes.toml").string(), "--limiter", "off", "--object", low_},
                server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(exists("ringdown:midi_in"));
  const auto frames = static_cast<std::size_t>(kPortsRate);
  JackRecorder keyboard(server_.name(), "keyboard", 1), recorder(server_.name(), "recorder", frames);
  ASSERT_TRUE(keyboard.connect("keyboard:midi_out", "ringdown:midi_in"));
  ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
  ASSERT_TRUE(recorder.wait_for_freewheel());
  keyboard.send({0x90, 48, 127});
  ASSERT_TRUE(recorder.wait_for(frames));
  const Samples heard = recorder.samples(0);
  KeepSignals keep(kPortsRate);
  keep.add("heard", heard);
  const std::size_t first = silence_before(heard);
  ASSERT_LT(first, heard.size()) << "nothing was heard";
  ASSERT_TRUE(keyboard.sent());
  EXPECT_EQ(recorder.first_frame() + first, *keyboard.sent() + 1) << "a sine begins at zero";
}

TEST_F(JackPorts, TheFirstKeyboardIsConnectedAsSoonAsThereIsOne) {
  Daemon daemon({"--connect", "--object", low_, "--object", high_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  JackRecorder keyboard(server_.name(), "keyboard", static_cast<std::size_t>(kPortsRate));
  ASSERT_TRUE(keyboard.connect("ringdown:out_left", "keyboard:in_1"));
  ASSERT_TRUE(becomes_true([&] { return server_.connections()["ringdown:midi_in"].contains("keyboard:midi_out"); }));
  keyboard.send({0x90, 61, 127});
  ASSERT_TRUE(keyboard.wait_for(16384));
  const Samples samples = keyboard.samples(0);
  const Spectrum heard = spectrum(std::span(samples).first(16384), kPortsRate);
  const auto level = [&](double hz) {
    return heard.magnitude[static_cast<std::size_t>(std::lround(hz / heard.bin_hz))];
  };
  EXPECT_GT(level(1200), 10 * level(300)) << "the second object";
  daemon.process().send_signal(SIGTERM);
  daemon.process().wait();
  const std::string told = daemon.process().output();
  for (const char* words :
       {"no MIDI keyboard yet", "keys: C4 = low, C#4 = high", "plays what comes from keyboard:midi_out"}) {
    EXPECT_NE(told.find(words), told.npos) << words << "\n" << told;
  }
}

TEST_F(JackPorts, AKeyboardWhoseProgramBeginsLaterIsConnectedThen) {
  constexpr auto kOptions = static_cast<jack_options_t>(JackNoStartServer | JackServerName);
  const std::unique_ptr<jack_client_t, decltype(&jack_client_close)> late(
      jack_client_open("late", kOptions, nullptr, server_.name().c_str()), &jack_client_close);
  ASSERT_TRUE(late);
  constexpr auto kFlags = JackPortIsOutput | JackPortIsPhysical;
  ASSERT_TRUE(jack_port_register(late.get(), "midi_out", JACK_DEFAULT_MIDI_TYPE, kFlags, 0));
  Daemon daemon({"--connect", "--object", low_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto is_connected = [&] { return server_.connections()["ringdown:midi_in"].contains("late:midi_out"); };
  EXPECT_FALSE(is_connected()) << "JACK connects no port of a program that has not begun";
  jack_set_process_callback(
      late.get(), [](jack_nframes_t, void*) { return 0; }, nullptr);
  ASSERT_EQ(jack_activate(late.get()), 0);
  EXPECT_TRUE(becomes_true(is_connected)) << daemon.process().output();
}

TEST_F(JackPorts, AKeyboardIsFoundByAPartOfItsName) {
  JackRecorder pad(server_.name(), "pad", 1), keyboard(server_.name(), "keyboard", 1);
  Daemon daemon({"--keyboard", "BOARD:", "--object", low_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_TRUE(becomes_true(
      [&] { return server_.connections()["ringdown:midi_in"] == std::set<std::string>{"keyboard:midi_out"}; }));
}

TEST_F(JackPorts, ATuningMessageRetunesTheObjectOfItsKey) {
  Daemon daemon({"--keyboard", "keyboard", "--object", low_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  JackRecorder keyboard(server_.name(), "keyboard", static_cast<std::size_t>(60 * kPortsRate));
  ASSERT_TRUE(keyboard.connect("ringdown:out_left", "keyboard:in_1"));
  ASSERT_TRUE(becomes_true([&] { return server_.connections()["ringdown:midi_in"].contains("keyboard:midi_out"); }));
  keyboard.send({0x90, 60, 127});
  ASSERT_TRUE(keyboard.wait_for(8192));
  const auto is_heard = [&](double hz) {
    const Samples samples = keyboard.samples(0);
    const Spectrum heard = spectrum(std::span(samples).last(8192), kPortsRate);
    const auto loudest = std::ranges::max_element(heard.magnitude) - heard.magnitude.begin();
    return std::abs(static_cast<double>(loudest) * heard.bin_hz - hz) < 2 * heard.bin_hz;
  };
  EXPECT_TRUE(is_heard(300));
  // The key of note 60 gets the pitch of note 72.
  keyboard.send({0xf0, 0x7f, 0x7f, 0x08, 0x02, 0x00, 0x01, 60, 72, 0x00, 0x00, 0xf7});
  EXPECT_TRUE(becomes_true([&] { return is_heard(600); }));
}

TEST_F(JackPorts, WithoutAnythingElseAMapBringsItsObjects) {
  std::filesystem::create_directory(folder_ / "maps");
  std::ofstream(folder_ / "maps/notes.toml") << "banks = '..'\n[[note]]\nnote = 48\nobject = 'low'\n[[note]]\nnote = "
                                                "50\nobject = 'high'\n[[note]]\nnote = 52\nobject = 'low'\n"
                                                "[[note]]\nnote = 53\nobject = 'twin'\nbank = 'low'\n";
  const std::string map = (folder_ / "maps/notes.toml").string();
  {
    Daemon daemon({"--notes", map}, server_.environment());
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    EXPECT_TRUE(done(daemon, {"/object/low/free", {}}));
    EXPECT_TRUE(done(daemon, {"/object/high/free", {}}));
    EXPECT_TRUE(done(daemon, {"/object/twin/free", {}})) << "of the bank of another object";
  }
  Daemon daemon({"--notes", map, "--object", low_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_FALSE(done(daemon, {"/object/high/free", {}})) << "the user's objects, and no others";
}

// The listener faces along x, the object stands 30 degrees to the left: Y (channel 1) is sin 30 degrees of W (channel
// 0).
TEST_F(JackPorts, AmbisonicPortsHearWhereAnObjectStands) {
  Daemon daemon({"--ambisonics", "1", "--object", low_}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  for (const char* port : {"ambisonic_0", "ambisonic_1", "ambisonic_2", "ambisonic_3"}) {
    EXPECT_TRUE(exists(std::string("ringdown:") + port)) << port;
  }
  EXPECT_FALSE(exists("ringdown:ambisonic_4"));
  daemon.send({"/listener", {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f}});
  daemon.send({"/object/low/pose", {1.7320508f, 1.f, 0.f, 1.f, 0.f, 0.f, 0.f}});
  daemon.send(strike("low"));
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 1; }));
  const auto frames = static_cast<std::size_t>(kPortsRate / 2);
  JackRecorder recorder(server_.name(), "recorder", frames);
  ASSERT_TRUE(recorder.connect("ringdown:ambisonic_0", "recorder:in_1"));
  ASSERT_TRUE(recorder.connect("ringdown:ambisonic_1", "recorder:in_2"));
  ASSERT_TRUE(recorder.wait_for(frames));
  const std::size_t later = frames / 2;  // both are connected by then
  const Samples all = recorder.samples(0), side = recorder.samples(1);
  Samples half;
  for (const double sample : std::span(all).subspan(later)) half.push_back(0.5 * sample);
  EXPECT_GT(peak(half), 1e-3);
  EXPECT_LT(relative_error_db(std::span(side).subspan(later), half), -80);
}

TEST_F(JackPorts, AWrongNoteMapIsRefusedWithItsLine) {
  std::ofstream(folder_ / "notes.toml") << "[[note]]\nnote = 200\nobject = 'low'\n";
  const Outcome outcome =
      run({program("ringdownd"), "--port", "0", "--notes", (folder_ / "notes.toml").string()}, server_.environment());
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.output.find("notes.toml:2"), std::string::npos) << outcome.output;
}

}  // namespace
}  // namespace ringdown::test
