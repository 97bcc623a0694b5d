#include "server/session/held_keys.h"

#include <bit>

namespace ringdown::session {
namespace {

constexpr unsigned bit(std::size_t channel) REALTIME { return 1u << channel; }

}  // namespace

std::optional<HeldKeys::Pedal> HeldKeys::pedal_of(std::uint8_t controller) REALTIME {
  if (controller == midi::kSustainPedal) return Pedal::sustain;
  if (controller == midi::kSostenutoPedal) return Pedal::sostenuto;
  if (controller == midi::kSoftPedal) return Pedal::damp;
  return std::nullopt;
}

void HeldKeys::press(std::size_t key, std::size_t channel) REALTIME {
  channels_[key] = static_cast<Channels>(channels_[key] | bit(channel));
  kept_[key] = false;
}

HeldKeys::Release HeldKeys::release(std::size_t key, std::size_t channel) REALTIME {
  if (!is_down(key, channel)) return Release::absent;
  channels_[key] = static_cast<Channels>(channels_[key] & ~bit(channel));
  if (is_down(key)) return Release::down;
  kept_[key] = !is_down(Pedal::damp) && (is_down(Pedal::sustain) || chosen_[key]);
  return kept_[key] ? Release::kept : Release::free;
}

HeldKeys::Keys HeldKeys::move(Pedal pedal, std::size_t channel, bool down) REALTIME {
  const bool was_down = is_down(pedal);
  Channels& on = pedals_[static_cast<std::size_t>(pedal)];
  on = static_cast<Channels>(down ? on | bit(channel) : on & ~bit(channel));
  if (is_down(pedal) == was_down) return {};
  if (pedal == Pedal::damp) {
    if (down) kept_.reset();
    return {};
  }
  if (pedal == Pedal::sostenuto) {
    for (std::size_t key = 0; key < kNotes; ++key) chosen_[key] = down && is_down(key);
  }
  if (down) return {};
  const Keys freed = is_down(Pedal::sustain) ? Keys() : kept_ & ~chosen_;
  kept_ &= ~freed;
  return freed;
}

HeldKeys::Keys HeldKeys::lift_pedals(std::size_t channel) REALTIME {
  Keys freed;
  for (const Pedal pedal : {Pedal::sustain, Pedal::sostenuto, Pedal::damp}) freed |= move(pedal, channel, false);
  return freed;
}

bool HeldKeys::is_down(std::size_t key, std::size_t channel) const REALTIME {
  return (channels_[key] & bit(channel)) != 0;
}

bool HeldKeys::is_down(Pedal pedal) const REALTIME { return pedals_[static_cast<std::size_t>(pedal)] != 0; }

HeldKeys::Keys HeldKeys::held() const REALTIME {
  Keys keys;
  for (std::size_t key = 0; key < kNotes; ++key) keys[key] = is_held(key);
  return keys;
}

std::size_t HeldKeys::channel_of(std::size_t key) const REALTIME {
  return static_cast<std::size_t>(std::countr_zero(channels_[key]));
}

}  // namespace ringdown::session
