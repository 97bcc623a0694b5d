// Two hundred thousand blocks on the audio thread while others strike, load, retune and free: nothing in them
// allocates, locks or asks the system for anything.
#include "engine/modal/bank_file.h"
#include "server/session/session.h"
#include "tests/support/realtime_guard.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <random>
#include <thread>
#include <unistd.h>

namespace ringdown::session {
namespace {

constexpr std::uint64_t kBlocks = 200'000, kStrikes = 10'000, kLoads = 400, kFrees = 80;
constexpr std::size_t kFrames = 16, kObjects = 12, kBanks = 4;

class Crowd {
 public:
  explicit Crowd(Session& session) : session_(session) {
    for (std::size_t n = 0; n < kBanks; ++n) {
      EXPECT_TRUE(modal::write_bank(test::random_bank(static_cast<std::uint32_t>(n), 4 << n, 12), bank(n)));
    }
    loader_ = std::jthread([this](const std::stop_token& stop) { load_and_free(stop); });
    player_ = std::jthread([this](const std::stop_token& stop) { strike(stop); });
  }
  ~Crowd() {
    loader_ = {};
    player_ = {};
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  std::atomic<std::uint64_t> loads = 0, frees = 0, strikes = 0;

  [[nodiscard]] bool done() const { return loads >= kLoads && frees >= kFrees && strikes >= kStrikes; }

 private:
  [[nodiscard]] std::filesystem::path bank(std::size_t n) const { return folder_ / (std::to_string(n) + ".glb"); }
  static std::string name(std::size_t n) { return "o" + std::to_string(n); }

  void load_and_free(const std::stop_token& stop) {
    std::minstd_rand random(1);
    while (!stop.stop_requested()) {
      const protocol::ObjectRef object{.name = name(random() % kObjects)};
      const auto choice = random() % 4;
      if (choice < 2) {
        loads += session_.perform(protocol::LoadObject{object.name, bank(random() % kBanks)}, 0).has_value();
      } else if (choice == 2) {
        frees += session_.perform(protocol::FreeObject{object}, 0).has_value();
      } else {
        static_cast<void>(
            session_.rack().set_material(object, {.stiffness = 1 + 0.1 * static_cast<double>(random() % 10)}));
      }
      session_.rack().collect();
    }
  }

  void strike(const std::stop_token& stop) {
    std::minstd_rand random(2);
    while (!stop.stop_requested()) {
      const auto now = session_.rack().mixer().counters().frames.load();
      const protocol::Strike blow{{.name = name(random() % kObjects)}, {{0.1, 0, 0}, {0, 0.01, 0.02}, 0}};
      strikes += session_.play(blow, now + static_cast<synth::Frame>(random() % 100)).has_value();
      const protocol::SetPickup pickup{
          blow.object,
          {{0.1, 0, 0}, random() % 2 == 0 ? Vec3{0, 0, 1} : Vec3{}, 1 + static_cast<std::uint32_t>(random() % 8)}};
      if (random() % 16 == 0) static_cast<void>(session_.play(pickup, now));
      std::this_thread::yield();
    }
  }

  Session& session_;
  test::TemporaryFolder folder_;
  std::jthread loader_, player_;
};

TEST(Realtime, BlocksWhileOthersStrikeAndLoadAllocateNothingLockNothingAndCallNoSystem) {
  if (!test::kRealtimeGuardWorks) GTEST_SKIP() << "sanitizers and clang replace the watched functions";
  Session session(48000);
  session.merge_within(0);
  session.rack().mixer().meters().watch_objects(true);
  Crowd crowd(session);
  std::array<float, kFrames> left{}, right{}, felt{};
  synth::Outputs outputs(left.data(), right.data());
  for (std::size_t pickup = 0; pickup < synth::kMaxPickups; ++pickup) outputs.listen_to_pickup(pickup, felt.data());
  test::RealtimeViolations seen;
  std::uint64_t broken = 0;
  {
    const test::RealtimeScope scope;
    const auto& strikes = session.rack().mixer().counters().strikes;  // without those of objects that were just freed
    for (std::uint64_t block = 0; block < kBlocks || !crowd.done() || strikes <= kStrikes / 20; ++block) {
      session.rack().mixer().render(outputs, kFrames);
      for (std::size_t n = 0; n < kFrames; ++n) broken += !(std::abs(left[n]) < 1e6f && std::abs(right[n]) < 1e6f);
    }
    seen = scope.seen();
  }
  EXPECT_EQ(seen.total(), 0u) << seen.first;
  EXPECT_EQ(broken, 0u);
  const synth::MixerCounters& counters = session.rack().mixer().counters();
  EXPECT_GE(counters.strikes + counters.refused + synth::kQueueCapacity + synth::kMaxPendingEvents, kStrikes);
}

}  // namespace
}  // namespace ringdown::session
