// Capacities of docs/use/limits.md that no other test fills: at the limit all is well, one past it is refused or
// counted.
#include "engine/base/toml_table.h"
#include "engine/modal/bank_file.h"
#include "protocol/wire/score.h"
#include "tests/server/osc_server_fixture.h"

#include <fstream>
#include <semaphore>
#include <thread>

namespace ringdown::server {
namespace {

TEST(Capacity, AWorkerHoldsTasksUpToItsLimitAndRefusesTheNext) {
  std::binary_semaphore started{0}, go{0};
  std::atomic<std::size_t> done = 0;
  Worker worker([] {}, 10ms);
  ASSERT_TRUE(worker.post([&] {
    started.release();
    go.acquire();
  }));
  started.acquire();  // it is at work; from now on tasks wait
  for (std::size_t i = 0; i < Worker::kMaxTasks; ++i) ASSERT_TRUE(worker.post([&done] { ++done; })) << i;
  EXPECT_FALSE(worker.post([&done] { ++done; }));
  go.release();
  while (done < Worker::kMaxTasks) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(worker.post([] {})) << "there is room again";
  EXPECT_EQ(done, Worker::kMaxTasks);
}

TEST(Capacity, LatencyEndsAtASecond) {
  EXPECT_TRUE(parse_latency("1000ms"));
  EXPECT_FALSE(parse_latency("1000.1ms"));
  EXPECT_TRUE(parse_latency("192000"));
  EXPECT_FALSE(parse_latency("192001"));
}

// A score of one empty-handed message at `seconds`.
std::vector<std::byte> score_at(std::uint64_t seconds) {
  std::vector<std::byte> bytes = wire::encode_score(std::vector<wire::ScoreEvent>{{0, {"/a", {}}}});
  for (std::size_t i = 0; i < 4; ++i) bytes[12 + i] = static_cast<std::byte>(seconds >> (24 - 8 * i));
  return bytes;
}

TEST(Capacity, AScoreLastsADay) {
  const auto day = static_cast<std::uint64_t>(wire::kMaxScore);
  EXPECT_TRUE(wire::parse_score(score_at(day), "s"));
  EXPECT_FALSE(wire::parse_score(score_at(day + 1), "s"));
}

class CapacityTest : public OscServerTest {
 protected:
  // The sentence that `read` refuses a file of zeros with.
  template <class Read>
  std::string refusal_of(std::size_t bytes, const Read& read) {
    const auto file = folder_ / "large";
    std::ofstream(file).close();
    std::filesystem::resize_file(file, bytes);  // a hole: it takes no room on the disk
    const auto outcome = read(file);
    return outcome ? "" : outcome.error().message;
  }
};

TEST_F(CapacityTest, FilesAreReadToTheirLimitAndRefusedPastIt) {
  const auto too_large = [](const std::string& sentence) {
    return sentence.find("more than the limit") != std::string::npos;
  };
  const auto toml = [](const auto& path) { return TomlTable::read(path); };
  EXPECT_FALSE(too_large(refusal_of(kMaxTomlFileBytes, toml)));
  EXPECT_TRUE(too_large(refusal_of(kMaxTomlFileBytes + 1, toml)));
  const auto score = [](const auto& path) { return wire::read_score(path); };
  EXPECT_FALSE(too_large(refusal_of(wire::kMaxScoreBytes, score)));
  EXPECT_TRUE(too_large(refusal_of(wire::kMaxScoreBytes + 1, score)));
  const auto bank = [this](const auto& path) { return session_.banks().read(path); };
  EXPECT_FALSE(too_large(refusal_of(modal::kMaxBankFileBytes, bank)));
  EXPECT_TRUE(too_large(refusal_of(modal::kMaxBankFileBytes + 1, bank)));
}

TEST_F(CapacityTest, ARecordingKeepsEventsUpToItsLimitAndSaysWhatItLeftOut) {
  load("bell");
  ASSERT_TRUE(recorder_.start(folder_ / "full.osc", 0));  // which names the object: one event
  const synth::Event strike{.frame = 5, .object = (*session_.rack().find({.name = "bell"}))->number};
  for (std::size_t i = 1; i < session::kMaxRecorded; ++i) recorder_.played(strike);
  EXPECT_EQ(recorder_.left_out(), 0u);
  recorder_.played(strike);
  EXPECT_EQ(recorder_.left_out(), 1u);
  const auto written = recorder_.stop(10);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(*written, session::kMaxRecorded);
}

// Its silence is measured by a clock of the test's own.
TEST_F(CapacityTest, ASubscriberMayBeSilentUpToTheLimitAndNotLonger) {
  using Seconds = std::chrono::duration<double>;
  std::atomic<double> now_s = 0;
  std::atomic<int> notices = 0;
  const auto now = [&] {
    return Notifier::Clock::time_point(std::chrono::duration_cast<Notifier::Clock::duration>(Seconds(now_s.load())));
  };
  Notifier notifier(
      session_, driver_, [&](Peer, std::span<const std::byte>) { ++notices; }, now);
  const Peer peer{.endpoint = {.port = 1}};
  const auto is_told = [&] {
    for (const int before = notices; notices < before + 3;) {
      if (notifier.subscribers() == 0) return false;
      std::this_thread::sleep_for(1ms);
    }
    return true;
  };
  ASSERT_TRUE(notifier.subscribe(peer, 200));
  EXPECT_TRUE(is_told());
  now_s = kSilence_s;
  EXPECT_TRUE(is_told()) << "at the limit";
  notifier.heard_from(peer);
  now_s = 2 * kSilence_s;
  EXPECT_TRUE(is_told()) << "anything it sends keeps it";
  now_s = 2 * kSilence_s + 0.001;
  while (notifier.subscribers() > 0) std::this_thread::sleep_for(1ms);
}

// Notices come once in 1000 s, and whenever somebody subscribes.
TEST_F(CapacityTest, ANoticeTellsTheLastContacts) {
  std::vector<protocol::NotifyContact> contacts;
  std::binary_semaphore told{0};
  Notifier notifier(session_, driver_, [&](Peer, std::span<const std::byte> packet) {
    const auto messages = wire::decode_packet(packet).value();
    for (const wire::TimedMessage& timed : messages) {
      const auto reply = protocol::parse_reply(timed.message).value();
      if (const auto* contact = reply.get_if<protocol::NotifyContact>()) contacts.push_back(*contact);
      if (reply.holds<protocol::NotifyPeak>()) told.release();  // after the last contact
    }
  });
  const auto next_notice = [&] {
    ASSERT_TRUE(notifier.subscribe({.endpoint = {.port = 1}}, 1e-3));
    told.acquire();
  };
  load("bell");
  next_notice();
  ASSERT_TRUE(contacts.empty());
  const auto number = (*session_.rack().find({.name = "bell"}))->number;
  for (std::size_t i = 0; i <= kMaxContactsPerNotice; ++i) {
    ASSERT_TRUE(session_.rack().push(
        synth::Producer::worker,
        {.object = number,
         .verb = synth::verb::Strike{.impulse_ns = {0, 0, static_cast<double>(i)}, .contact_time_s = 0}}));
  }
  next_notice();
  ASSERT_EQ(contacts.size(), kMaxContactsPerNotice);
  EXPECT_EQ(contacts.front().impulse_ns.z, 1) << "the very first is left out";
  EXPECT_EQ(contacts.back().impulse_ns.z, static_cast<double>(kMaxContactsPerNotice));
}

}  // namespace
}  // namespace ringdown::server
