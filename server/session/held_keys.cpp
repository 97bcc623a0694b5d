#include "server/session/held_keys.h"

#include <bit>

namespace ringdown::session {
namespace {

constexpr unsigned bit(std::size_t channel) RINGDOWN_REALTIME { return 1u << channel; }

}  // namespace

std::optional<HeldKeys::Pedal> HeldKeys::pedal_of(std::uint8_t controller) RINGDOWN_REALTIME {
  if (controller == midi::kSustainPedal) return Pedal::sustain;
  if (controller == midi::kSostenutoPedal) return Pedal::sostenuto;
  if (controller == midi::kSoftPedal) return Pedal::damp;
  return std::nullopt;
}

void HeldKeys::press(std::size_t key, std::size_t channel) RINGDOWN_REALTIME {
  channels_.data()[key] = static_cast<Channels>(channels_.data()[key] | bit(channel));
  kept_[key] = false;
}

HeldKeys::Release HeldKeys::release(std::size_t key, std::size_t channel) RINGDOWN_REALTIME {
  if (!is_down(key, channel)) return Release::absent;
  channels_.data()[key] = static_cast<Channels>(channels_.data()[key] & ~bit(channel));
  if (is_down(key)) return Release::down;
  kept_[key] = !is_down(Pedal::damp) && (is_down(Pedal::sustain) || chosen_[key]);
  return kept_[key] ? Release::kept : Release::free;
}

HeldKeys::Keys HeldKeys::move(Pedal pedal, std::size_t channel, bool down) RINGDOWN_REALTIME {
  const bool was_down = is_down(pedal);
  Channels& on = pedals_.data()[static_cast<std::size_t>(pedal)];
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

HeldKeys::Keys HeldKeys::lift_pedals(std::size_t channel) RINGDOWN_REALTIME {
  Keys freed;
  for (const Pedal pedal : {Pedal::sustain, Pedal::sostenuto, Pedal::damp}) freed |= move(pedal, channel, false);
  return freed;
}

bool HeldKeys::is_down(std::size_t key, std::size_t channel) const RINGDOWN_REALTIME {
  return (channels_.data()[key] & bit(channel)) != 0;
}

bool HeldKeys::is_down(Pedal pedal) const RINGDOWN_REALTIME {
  return pedals_.data()[static_cast<std::size_t>(pedal)] != 0;
}

std::size_t HeldKeys::channel_of(std::size_t key) const RINGDOWN_REALTIME {
  return static_cast<std::size_t>(std::countr_zero(channels_.data()[key]));
}

}  // namespace ringdown::session
