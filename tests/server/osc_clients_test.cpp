// The senders in clients/ and oscsend, run for real: what is sent must arrive, and parse.
#include "protocol/bulk.h"
#include "protocol/help.h"
#include "tests/server/fake_daemon.h"

namespace ringdown::wire {
namespace {

TEST(OscClients, EveryExampleOfTheManualWorksWithOscsend) {
  if (!is_installed("oscsend")) GTEST_SKIP() << "oscsend (liblo-tools) is not installed";
  for (const protocol::AddressSpec& spec : protocol::addresses()) {
    if (spec.address == "/sync") continue;  // the test's daemon answers it itself
    std::string command = protocol::oscsend_command(spec);
    if (command.empty()) continue;  // a blob
    FakeDaemon daemon;
    command.replace(command.find("7770"), 4, daemon.port());
    ASSERT_EQ(run(command).exit_code, 0) << command;
    const auto received = daemon.received(1);
    ASSERT_EQ(received.size(), 1u) << command;
    const auto request = protocol::parse(received[0].message);
    ASSERT_TRUE(request) << command << ": " << request.error().message;
    const auto example = protocol::parse(spec.example);
    EXPECT_EQ(request->index(), example->index());
    EXPECT_EQ(received[0].message.address, spec.example.address);
    EXPECT_EQ(received[0].message.arguments.size(), spec.example.arguments.size());
  }
}

TEST(OscClients, PythonStrikesNowAndInTimedBundles) {
  if (!is_installed("python3")) GTEST_SKIP() << "python3 is not installed";
  FakeDaemon daemon;
  const Outcome outcome =
      run("python3 " RINGDOWN_SOURCE_DIR "/clients/python/strike.py bell --roll 3 --port " + daemon.port());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto received = daemon.received(4);
  ASSERT_EQ(received.size(), 4u);
  expect_example_blow(received[0]);
  expect_example_blow(received[1]);
  EXPECT_EQ(received[0].time, kImmediately);
  for (std::size_t i = 2; i < 4; ++i) {
    EXPECT_NEAR(unix_seconds(received[i].time) - unix_seconds(received[i - 1].time), 0.12, 1e-6);
  }
}

TEST(OscClients, PythonRainsManyBlowsInFewMessages) {
  if (!is_installed("python3")) GTEST_SKIP() << "python3 is not installed";
  FakeDaemon daemon;
  const Outcome outcome =
      run("python3 " RINGDOWN_SOURCE_DIR "/clients/python/strike.py bell --rain 2000 --port " + daemon.port());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  const auto received = daemon.received(3);
  ASSERT_EQ(received.size(), 3u);
  std::vector<protocol::BulkStrike> blows;
  for (std::size_t i = 1; i < 3; ++i) {
    const auto request = protocol::parse(received[i].message);
    ASSERT_TRUE(request) << request.error().message;
    const auto some = protocol::decode_strikes(request->get<protocol::StrikeMany>().records);
    ASSERT_TRUE(some) << some.error().message;
    blows.insert(blows.end(), some->begin(), some->end());
  }
  ASSERT_EQ(blows.size(), 2000u);
  for (std::size_t i = 0; i < blows.size(); ++i) {
    EXPECT_EQ(blows[i].object, 0u);
    EXPECT_FALSE(blows[i].vertex);
    EXPECT_NEAR(length(blows[i].point_m - Vec3{0.05, 0, 0.02}), 0, 1e-8);
    EXPECT_NEAR(length(blows[i].impulse_ns - Vec3{-0.001, 0, 0}), 0, 1e-8);
    EXPECT_NEAR(blows[i].delay_s, static_cast<double>(i) / 2000, 1e-7);
  }
}

TEST(OscClients, PythonSaysWhatTheDaemonRefused) {
  if (!is_installed("python3")) GTEST_SKIP() << "python3 is not installed";
  FakeDaemon daemon([](const Message& message) { return protocol::Fail{message.address, "there is no bell"}; });
  const Outcome outcome = run("python3 " RINGDOWN_SOURCE_DIR "/clients/python/strike.py bell --port " + daemon.port());
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.output.find("there is no bell"), std::string::npos) << outcome.output;
}

TEST(OscClients, PureDataStrikes) {
  if (!is_installed("pd")) GTEST_SKIP() << "pd (puredata-core) is not installed";
  FakeDaemon daemon;
  const Outcome outcome = run("timeout 30 pd -nogui -noaudio -nomidi -stderr -open " RINGDOWN_SOURCE_DIR
                              "/clients/puredata/strike.pd"
                              " -send 'ringdown-port " +
                              daemon.port() + "; strike bang; pd quit'");
  const auto received = daemon.received(1);
  ASSERT_EQ(received.size(), 1u) << outcome.output;
  expect_example_blow(received[0]);
  EXPECT_NEAR(strike_in(received[0]).verb.contact_time_s, 0.0005, 1e-8);
}

TEST(OscClients, SuperColliderStrikes) {
  if (!is_installed("sclang")) GTEST_SKIP() << "sclang (supercollider-language) is not installed";
  FakeDaemon daemon;
  const Outcome outcome = run("QTWEBENGINE_DISABLE_SANDBOX=1 QT_QPA_PLATFORM=offscreen RINGDOWN_PORT=" + daemon.port() +
                              " timeout 60 sclang " RINGDOWN_SOURCE_DIR "/clients/supercollider/strike.scd");
  const auto received = daemon.received(10);
  ASSERT_EQ(received.size(), 10u) << outcome.output;
  expect_example_blow(received[0]);
}

}  // namespace
}  // namespace ringdown::wire
