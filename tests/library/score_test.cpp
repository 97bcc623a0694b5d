// A score of 10,000 events in 100 objects: the library gives the samples of `ringdown render`, bit for bit.
#include "clients/library/ringdown.h"
#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "server/session/offline.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>

namespace ringdown::test::score_test {
namespace {

using protocol::ObjectRef;

constexpr std::size_t kObjects = 100, kBanks = 10, kEvents = 10'000, kBlock = 256;
constexpr double kRate_hz = 48000, kSeconds = 4;

struct TimedRequest {
  std::int64_t frame = 0;
  protocol::Request request;
};

class Composer {
 public:
  std::vector<TimedRequest> compose() {
    std::vector<TimedRequest> score;
    for (std::size_t i = 0; i < kEvents; ++i) {
      score.push_back({static_cast<std::int64_t>(0.9 * kSeconds * kRate_hz * number(0, 1)), request()});
    }
    std::ranges::stable_sort(score, {}, &TimedRequest::frame);
    return score;
  }

 private:
  double number(double min, double max) { return std::uniform_real_distribution(min, max)(random_); }
  Vec3 vector(double max) { return {number(-max, max), number(-max, max), number(-max, max)}; }

  protocol::Request request() {
    const ObjectRef object{.name = {}, .number = static_cast<std::uint32_t>(random_() % kObjects)};
    if (random_() % 50 == 0) return two_way(object);
    switch (random_() % 12) {
      case 0:
        return protocol::StrikeVertex{object, {static_cast<std::uint32_t>(random_() % 10), vector(0.02), 0.001}};
      case 1:
        return protocol::SetGain{object, {number(0, 0.5), number(0, 0.1)}};
      case 2:
        if (random_() % 4 == 0) {
          return protocol::SetPickup{object, {vector(0.15), vector(1), 1 + static_cast<std::uint32_t>(random_() % 8)}};
        }
        return protocol::SetPan{object, {number(-1, 1)}};
      case 3:
        return protocol::RingModes{object, {static_cast<std::uint32_t>(random_() % 5), 2, number(0, 0.02)}};
      case 4:
        return protocol::Click{object, {vector(0.01), 0.0005}};
      case 5: {
        protocol::SetContact contact{object, {vector(0.15), {}}};
        contact.verb.contact.force_n = vector(2);
        contact.verb.contact.slip_m_s = number(0, 1);
        return contact;
      }
      case 6:
        if (random_() % 2 == 0) return protocol::OnObject<synth::verb::Choke>{object, {number(0, 0.2)}};
        return protocol::ClearObject{object, {number(0, 0.05)}};
      default:
        return protocol::Strike{object, {vector(0.15), vector(0.02), number(0, 0.002)}};
    }
  }

  protocol::Request two_way(const ObjectRef& object) {
    const Vec3 way{0, number(-1, 1), 1};
    switch (random_() % 3) {
      case 0: {
        protocol::SetBow bow{object, {vector(0.15)}};
        bow.verb.direction = way, bow.verb.speed_m_s = number(-1, 1), bow.verb.force_n = number(0, 2);
        return bow;
      }
      case 1: {
        protocol::HitMallet hit{object, {vector(0.15), vector(2)}};
        hit.verb.mass_kg = number(0.01, 0.1);
        return hit;
      }
      default: {
        protocol::SetCoupling set{object, {vector(0.15)}, {.name = {}, .number = (*object.number + 1) % kObjects}};
        set.verb.other_point_m = vector(0.15), set.verb.direction = way, set.verb.weight_n = 1;
        if (random_() % 2 == 0) set.verb.stiffness = 0;
        return set;
      }
    }
  }

  std::mt19937 random_{1};
};

// The same request by the C functions.
struct Player {
  ringdown_mixer* mixer;
  std::int64_t frame;
  ringdown_error error{};

  static std::array<double, 3> xyz(const Vec3& v) { return {v.x, v.y, v.z}; }

  ringdown_result operator()(const protocol::Strike& s) {
    return ringdown_strike(mixer, frame, *s.object.number, xyz(s.verb.point_m).data(), xyz(s.verb.impulse_ns).data(),
                           s.verb.contact_time_s, &error);
  }
  ringdown_result operator()(const protocol::StrikeVertex& s) {
    return ringdown_strike_vertex(mixer, frame, *s.object.number, s.verb.vertex, xyz(s.verb.impulse_ns).data(),
                                  s.verb.contact_time_s, &error);
  }
  ringdown_result operator()(const protocol::SetGain& s) {
    return ringdown_gain(mixer, frame, *s.object.number, s.verb.gain, s.verb.ramp_s, &error);
  }
  ringdown_result operator()(const protocol::SetPan& s) {
    return ringdown_pan(mixer, frame, *s.object.number, s.verb.pan, &error);
  }
  ringdown_result operator()(const protocol::SetPickup& s) {
    ringdown_pickup_args pickup;
    ringdown_pickup_args_init(&pickup, sizeof pickup);
    std::ranges::copy(xyz(s.verb.point_m), pickup.point_m);
    std::ranges::copy(xyz(s.verb.direction), pickup.direction);
    pickup.bus = s.verb.number;
    return ringdown_pickup(mixer, frame, *s.object.number, &pickup, &error);
  }
  ringdown_result operator()(const protocol::RingModes& s) {
    return ringdown_ring(mixer, frame, *s.object.number, s.verb.first, s.verb.count, s.verb.amplitude, &error);
  }
  ringdown_result operator()(const protocol::Click& s) {
    return ringdown_click(mixer, frame, *s.object.number, xyz(s.verb.impulse_ns).data(), s.verb.contact_time_s, &error);
  }
  ringdown_result operator()(const protocol::SetContact& s) {
    ringdown_contact_args contact;
    ringdown_contact_args_init(&contact, sizeof contact);
    std::ranges::copy(xyz(s.verb.point_m), contact.point_m);
    std::ranges::copy(xyz(s.verb.contact.force_n), contact.force_n);
    contact.slip_m_s = s.verb.contact.slip_m_s;
    return ringdown_contact(mixer, frame, *s.object.number, &contact, &error);
  }
  ringdown_result operator()(const protocol::SetBow& s) {
    ringdown_bow_args bow;
    ringdown_bow_args_init(&bow, sizeof bow);
    std::ranges::copy(xyz(s.verb.point_m), bow.point_m);
    std::ranges::copy(xyz(s.verb.direction), bow.direction);
    bow.speed_m_s = s.verb.speed_m_s, bow.force_n = s.verb.force_n;
    return ringdown_bow(mixer, frame, *s.object.number, &bow, &error);
  }
  ringdown_result operator()(const protocol::HitMallet& s) {
    ringdown_mallet_args mallet;
    ringdown_mallet_args_init(&mallet, sizeof mallet);
    std::ranges::copy(xyz(s.verb.point_m), mallet.point_m);
    std::ranges::copy(xyz(s.verb.velocity_m_s), mallet.velocity_m_s);
    mallet.mass_kg = s.verb.mass_kg;
    return ringdown_mallet(mixer, frame, *s.object.number, &mallet, &error);
  }
  ringdown_result operator()(const protocol::SetCoupling& s) {
    ringdown_couple_args coupling;
    ringdown_couple_args_init(&coupling, sizeof coupling);
    coupling.other = *s.other.number;
    std::ranges::copy(xyz(s.verb.point_m), coupling.point_m);
    std::ranges::copy(xyz(s.verb.other_point_m), coupling.other_point_m);
    std::ranges::copy(xyz(s.verb.direction), coupling.direction);
    coupling.weight_n = s.verb.weight_n, coupling.stiffness = s.verb.stiffness;
    return ringdown_couple(mixer, frame, *s.object.number, &coupling, &error);
  }
  ringdown_result operator()(const protocol::OnObject<synth::verb::Choke>& s) {
    return ringdown_choke(mixer, frame, *s.object.number, s.verb.within_s, &error);
  }
  ringdown_result operator()(const protocol::ClearObject& s) {
    return ringdown_clear(mixer, frame, *s.object.number, s.verb.ramp_s, &error);
  }
  template <class Other>
  ringdown_result operator()(const Other&) {
    return RINGDOWN_REFUSED;
  }
};

class Score : public testing::Test {
 protected:
  Score() {
    for (std::size_t b = 0; b < kBanks; ++b) {
      const auto path = folder_ / (std::to_string(b) + ".glb");
      EXPECT_TRUE(modal::write_bank(random_bank(static_cast<std::uint32_t>(b), 20 + 5 * b, 12), path));
      paths_.push_back(path);
    }
  }

  session::Recording rendered(const std::vector<TimedRequest>& score) {
    session::OfflineOptions options;
    options.seconds = kSeconds;
    options.block_frames = kBlock;
    options.mixer.limiter_db = -1;
    for (const TimedRequest& event : score) {
      options.score.push_back({static_cast<double>(event.frame) / kRate_hz, protocol::format(event.request)});
    }
    for (std::size_t o = 0; o < kObjects; ++o) options.objects.emplace_back("o" + std::to_string(o), path_of(o));
    auto recording = session::render_offline(options, [](double) { return true; });
    EXPECT_TRUE(recording) << (recording ? "" : recording.error().message);
    EXPECT_TRUE(recording->warnings.empty()) << recording->warnings.front();
    return *std::move(recording);
  }

  [[nodiscard]] const std::filesystem::path& path_of(std::size_t object) const { return paths_[object % kBanks]; }

  TemporaryFolder folder_;
  std::vector<std::filesystem::path> paths_;
};

TEST_F(Score, OfTenThousandEventsGivesTheSamplesOfRingdownRender) {
  const auto score = Composer().compose();
  const session::Recording expected = rendered(score);
  ASSERT_GT(expected.peak, 0.01);

  ringdown_error error;
  ringdown_mixer* mixer = nullptr;
  ASSERT_EQ(ringdown_mixer_create(nullptr, &mixer, &error), RINGDOWN_OK) << error.sentence;
  std::vector<ringdown_bank*> banks(kBanks);
  for (std::size_t b = 0; b < kBanks; ++b) {
    ASSERT_EQ(ringdown_bank_open(paths_[b].c_str(), &banks[b], &error), RINGDOWN_OK) << error.sentence;
  }
  for (std::size_t o = 0; o < kObjects; ++o) {
    const std::string name = "o" + std::to_string(o);
    std::uint32_t number = 0;
    ASSERT_EQ(ringdown_add(mixer, name.c_str(), banks[o % kBanks], &number, &error), RINGDOWN_OK) << error.sentence;
    ASSERT_EQ(number, o);
  }
  for (ringdown_bank* const bank : banks) ringdown_bank_release(bank);
  const std::size_t late = ringdown_latency(mixer);
  std::vector<float> left(expected.left.size() + late), right(left.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < left.size(); begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, left.size());
    for (; next < score.size() && score[next].frame < static_cast<std::int64_t>(end); ++next) {
      Player player{mixer, score[next].frame};
      ASSERT_EQ(visit(player, score[next].request), RINGDOWN_OK) << player.error.sentence;
    }
    ringdown_render(mixer, left.data() + begin, right.data() + begin, end - begin);
    ringdown_collect(mixer);
  }
  EXPECT_EQ(next, score.size());
  EXPECT_TRUE(std::equal(expected.left.begin(), expected.left.end(), left.begin() + static_cast<std::ptrdiff_t>(late)));
  EXPECT_TRUE(
      std::equal(expected.right.begin(), expected.right.end(), right.begin() + static_cast<std::ptrdiff_t>(late)));
  ringdown_status status{};
  status.size = sizeof status;
  EXPECT_EQ(ringdown_get_status(mixer, &status), RINGDOWN_OK);
  EXPECT_EQ(status.late, 0u);
  EXPECT_EQ(status.dropped, 0u);
  EXPECT_EQ(status.objects, kObjects);
  ringdown_mixer_destroy(mixer);
}

}  // namespace
}  // namespace ringdown::test::score_test
