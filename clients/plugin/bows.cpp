#include "clients/plugin/bows.h"

// libringdown's events allocate, lock and wait for nothing, but a C header cannot say so to the compiler.
TRUST_REALTIME_BEGIN

namespace ringdown::plugin {
namespace {

constexpr double kReplaced_s = 0.1;  // of what a bow left behind when its key got another object

}  // namespace

void Bows::draw(std::size_t key, const Stroke& stroke, double speed, const Moment& now) REALTIME {
  if (bows_[key].stroke.map != stroke.map) lift(key, now);
  bows_[key] = {stroke, speed, speed, session::kFirstBowPressure, true};
  send(bows_[key], key, now);
}

void Bows::set_speed(std::size_t key, double share, const Moment& now) REALTIME {
  if (!is_drawn(key)) return;
  bows_[key].speed = share;
  send(bows_[key], key, now);
}

void Bows::set_force(std::size_t key, double share, const Moment& now) REALTIME {
  if (!is_drawn(key)) return;
  bows_[key].force = share;
  send(bows_[key], key, now);
}

void Bows::reset(std::size_t key, const Moment& now) REALTIME {
  bows_[key].speed = bows_[key].first_speed;
  set_force(key, session::kFirstBowPressure, now);
}

void Bows::lift(std::size_t key, const Moment& now) REALTIME {
  if (!is_drawn(key)) return;
  bows_[key].is_drawn = false;
  send(bows_[key], key, now);
}

// When a key has got another object, the point of its old bow may lie beside that object, and libringdown would refuse
// the bow.
void Bows::send(const Bow& bow, std::size_t key, const Moment& now) REALTIME {
  if (bow.stroke.map != now.map) {
    if (!bow.is_drawn) ringdown_clear(now.mixer, now.frame, bow.stroke.object, kReplaced_s, nullptr);
    return;
  }
  ringdown_bow_args args;
  ringdown_bow_args_init(&args, sizeof args);
  write(now.sizes[bow.stroke.index] * bow.stroke.point_m, args.point_m);
  write(bow.stroke.direction, args.direction);
  args.speed_m_s = bow.speed * bow.stroke.speed_m_s;
  args.force_n = bow.is_drawn ? bow.force * bow.stroke.force_n : 0;
  args.number = static_cast<std::uint32_t>(key);
  const ringdown_result sent = ringdown_bow(now.mixer, now.frame, bow.stroke.object, &args, nullptr);
  if (sent != RINGDOWN_OK && !bow.is_drawn)
    ringdown_clear(now.mixer, now.frame, bow.stroke.object, kReplaced_s, nullptr);
}

}  // namespace ringdown::plugin

TRUST_REALTIME_END
