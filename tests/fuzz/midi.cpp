#include "engine/synth/mixer.h"
#include "engine/synth/modes/fade_out.h"
#include "server/session/midi_player.h"
#include "tests/fuzz/targets.h"
#include "tests/support/synthetic_bank.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::fuzz {
namespace {

constexpr std::size_t kBlock = 64;  // frames

void hear(synth::Mixer& mixer) {
  std::array<float, kBlock> left{}, right{};
  mixer.render(left, right);
  expect(std::ranges::all_of(left, [](float sample) { return std::isfinite(sample); }), "notes sound in numbers");
}

}  // namespace

void midi(Bytes messages) {
  static synth::Mixer mixer(48000);  // making one takes longer than all else; each input has a new voice in it
  const auto map = std::make_shared<const modal::StrikeMap>(test::shared(test::single_mode_bank(1000, 5)));
  expect(mixer.install(0, std::make_unique<synth::Voice>(map, modal::MaterialScale{}, 48000),
                       synth::Mixer::Install::replace),
         "a voice is installed");
  session::NoteTable table{.release_s = 0.1};
  for (std::size_t note = 0; note < session::kNotes; note += 2) {  // every other note strikes nothing
    table.notes[note] = {.object = 0, .point_m = {1, 0, 0}, .impulse_ns = {0, 0, 1}, .contact_time_s = 1e-3};
  }
  SpscRing<synth::Event> played(64);
  session::MidiPlayer player;
  for (std::size_t at = 0; at < messages.size();) {
    const std::size_t length = std::min(std::to_integer<std::size_t>(messages[at]) % 8, messages.size() - at - 1);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(messages.data()) + at + 1;
    player.play({bytes, length}, mixer.counters().frames + at % kBlock, table, mixer, played);
    for (const synth::Event* event; (event = played.front()); played.pop()) {
      expect(event->object == 0, "a note strikes its object");
      const auto* strike = event->verb.get_if<synth::verb::Strike>();
      if (!strike) continue;
      expect(is_finite(strike->impulse_ns), "a note strikes its object with a finite blow");
      expect(strike->contact_time_s >= 0 && strike->contact_time_s <= 0.1, "a blow lasts a tenth of a second at most");
    }
    at += 1 + length;
    if (at % 5 == 0) hear(mixer);
  }
  hear(mixer);
  expect(mixer.remove(0), "the voice is removed");
  for (std::size_t faded = 0; faded <= synth::FadeOut::kMinFrames; faded += kBlock) hear(mixer);
  mixer.collect();
}

}  // namespace ringdown::fuzz
