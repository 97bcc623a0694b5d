#include "tests/hostile/attacked_session.h"

#include "protocol/pattern.h"
#include "protocol/schema.h"
#include "tests/fuzz/targets.h"
#include "tests/hostile/playing.h"

#include <array>
#include <utility>

namespace ringdown::hostile {
namespace {

constexpr std::size_t kMaxBlockFrames = 256;  // of a block

std::shared_ptr<const synth::HeadFilters> head(double /*sample_rate_hz*/) {
  auto filters = std::make_shared<synth::HeadFilters>();
  filters->taps = 32;
  for (auto& ear : filters->reversed) ear.assign(synth::kMaxAmbisonicChannels * filters->taps, 0.1F);
  return filters;
}

synth::MixerSettings settings(Random& random) {
  synth::MixerSettings settings{.exact_contacts = random.one_in(2), .travel_time = random.one_in(3)};
  if (random.one_in(4)) {
    settings.head = head;
  } else if (!random.one_in(3)) {
    settings.ambisonic_order = random.below(synth::kMaxAmbisonicOrder + 1);
  }
  return settings;
}

}  // namespace

AttackedSession::AttackedSession(Random& random) {
  session_->rack().mixer().configure(settings(random));
  session_->rack().buses().set_mode(session::PortMode::objects);
  for (const wire::Message& message : keep_playing()) take(message);
}

void AttackedSession::take(const wire::Message& message) {
  if (!protocol::is_pattern(message.address)) return carry_out(message);
  const auto addresses = protocol::expand(message.address, *session_->rack().names());
  for (const std::string& address : addresses.value_or(std::vector<std::string>())) {
    carry_out({address, message.arguments});
  }
}

void AttackedSession::carry_out(const wire::Message& message) {
  auto request = protocol::parse(message);
  if (!request) return;
  visit(Overloaded{
            [&](const protocol::MixerRequest& r) { static_cast<void>(session_->play(r, now())); },
            [&](const protocol::TimedWorkerRequest& r) { static_cast<void>(session_->perform(r, now())); },
            [&](const protocol::WorkerRequest& r) { static_cast<void>(session_->perform(r, now())); },
            [](const protocol::FileRequest&) {},
            [](const protocol::Question&) {},
            [](const protocol::SubscriptionRequest&) {},
            [](const protocol::DaemonRequest&) {},
        },
        protocol::in_its_lane(*std::move(request)));
}

void AttackedSession::render(std::size_t frames, const synth::Inputs& inputs) {
  session_->scene().advance_to(now() + static_cast<synth::Frame>(frames), std::nullopt);
  fuzz::expect(outputs_.render(session_->rack().mixer(), frames, inputs) == 0,
               "every sample at every output is finite");
  session_->rack().collect();
}

void AttackedSession::play(std::size_t blocks, Random& random) {
  constexpr std::size_t kTurnsPerLoad = 400, kTurnsPerBlow = 16;
  if (++turns_ % kTurnsPerLoad == 0) {
    for (const wire::Message& message : keep_playing()) take(message);
  }
  if (turns_ % kTurnsPerBlow == 0) {
    for (const wire::Message& message : play_on(random)) take(message);
  }
  std::array<float, kMaxBlockFrames> input{};
  if (random.one_in(4)) {
    for (float& sample : input) sample = static_cast<float>(random.uniform(-1, 1));
    if (random.one_in(4)) input[random.below(input.size())] = static_cast<float>(random.extreme());
    if (random.one_in(8)) input[random.below(input.size())] = static_cast<float>(random.no_number());
  }
  synth::Inputs inputs;
  inputs.fill(input.data());
  for (; blocks > 0; --blocks) render(1 + random.below(kMaxBlockFrames), inputs);
}

void AttackedSession::expect_alive() {
  constexpr synth::Inputs kNoInputs{};
  constexpr int kBlocks = 400;
  for (const char* address : {"/clear", "/scene/clear", "/listener/off"}) take({address, {}});
  for (const std::string& name : *session_->rack().names()) take({"/object/" + name + "/free", {}});
  for (int block = 0; block < kBlocks; ++block) render(kMaxBlockFrames, kNoInputs);
  take({"/load", {std::string("last"), std::string("plate.glb")}});
  take({"/object/last/strike_vertex", {0, 0.0, 0.0, 1.0}});
  static_cast<void>(outputs_.take_loud());
  for (int block = 0; block < 8; ++block) render(kMaxBlockFrames, kNoInputs);
  fuzz::expect(outputs_.take_loud(), "an object that is not to blame can be heard after the attack");
}

}  // namespace ringdown::hostile
