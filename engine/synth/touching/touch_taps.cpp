// Builds a group's contacts: its bodies, how each place on them moves and is moved, and the taps between all places.
// Runs when a contact begins or ends, a point moves, or an object's voice changes.
#include "engine/synth/touching/touch_group.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace ringdown::synth {
namespace {

constexpr double kStepsOfContact = 8;  // that an impact should last

constexpr double kRubDamping = 0.02;  // of critical, of what rubs on its spring

// The mass that a short push moves.
double mass_of(const TouchSlot& slot) REALTIME {
  return 1 / ((slot.rigid.kg > 0 ? 1 / slot.rigid.kg : 0.0) + std::max(slot.per_kg, 1e-3));
}

// By how much the load of a rub presses the surfaces together.
double rub_depth_m(const Touch& rub) REALTIME {
  const double load = rub.force_n / rub.stiffness;
  return std::cbrt(load * load);
}

// Steps in a sample, for a mass that hits at a speed: Hertz's contact time in samples; for one that rubs, half a
// period.
std::size_t substeps_for(const TouchSlot& slot, double sample_rate_hz) REALTIME {
  const Touch& touch = slot.touch;
  if (touch.kind == Touch::Kind::bow || !(touch.stiffness > 0)) return 1;
  const double kg = mass_of(slot);
  const auto in_a_sample = [](double samples) REALTIME {
    return static_cast<std::size_t>(std::clamp(std::ceil(kStepsOfContact / samples), 1.0, double{kMaxSubsteps}));
  };
  if (touch.kind == Touch::Kind::rub) {
    return in_a_sample(std::numbers::pi * std::sqrt(kg * rub_depth_m(touch) / (1.5 * touch.force_n)) * sample_rate_hz);
  }
  const double speed = touch.kind == Touch::Kind::mallet ? std::max(touch.speed_m_s, 0.01) : 0.2;
  const double depth = std::pow(1.25 * kg * speed * speed / touch.stiffness, 0.4);
  return in_a_sample(2.94 * depth / speed * sample_rate_hz);
}

}  // namespace

void TouchGroup::find_poles(Body& body) REALTIME {
  const auto [re, im] = body.table->exponents();
  const double part = 1.0 / static_cast<double>(substeps_);
  for (std::size_t i = 0; i < body.table->columns(); ++i) {
    const double size = std::exp(part * re[i]);
    body.poles[i] = size * std::cos(part * im[i]);
    body.poles[kMaxTouchColumns + i] = size * std::sin(part * im[i]);
  }
}

// A mode of damped frequency w and decay s with the output weight W per velocity, z = W (w q - i (v + s q)), is moved
// by its shape phi: q = Re z / (W w) is displaced by 1 N, constant in a step, towards phi (w - i s) / (w^2 + s^2) W, of
// which 1 - p is reached. A place's weight is phi / (W w); the rest of the product is the same for all places.
void TouchGroup::find_response(Body& body) REALTIME {
  const ModeTable& table = *body.table;
  std::fill_n(body.response, table.columns(), 0.0);
  std::fill_n(body.response + kMaxTouchColumns, table.columns(), 0.0);
  const auto [log_re, log_im] = table.exponents();
  const double rate_hz = table.sample_rate_hz(), shape = modal::shape_factor(table.material_);
  const ModeArrays poles = modes_of(body, TouchedStates(*body.object->voices.current()).open());
  for (std::size_t i = 0; i < table.playable_modes(); ++i) {
    const std::size_t c = table.column(i);
    const double w = log_im[c] * rate_hz, s = -log_re[c] * rate_hz, output = table.weight_[i] / shape;
    const double size = output * output * w / (w * w + s * s);
    const double left_re = 1 - poles.pole_re[c], left_im = -poles.pole_im[c];
    body.response[c] = size * (w * left_re + s * left_im);
    body.response[kMaxTouchColumns + c] = size * (w * left_im - s * left_re);
  }
}

double TouchGroup::find_port(Body& body, const Vec3& point_m, const Vec3& direction, double width_m,
                             TouchPort& port) REALTIME {
  Voice& voice = *body.object->voices.current();
  const ModeTable& table = *body.table;
  std::fill_n(port.weight.get(), table.columns(), 0.0);
  // A wide body touches a patch: its middle, and half the width away to all sides, as far as there is surface.
  const std::array<Vec3, 2> aside = across(direction);
  const std::size_t points = width_m > 0 ? 5 : 1;
  for (std::size_t k = 0; k < points; ++k) {
    const double side = k % 2 == 1 ? 0.5 * width_m : -0.5 * width_m;
    verb::Strike push{.point_m = point_m, .impulse_ns = direction, .contact_time_s = 0};
    if (k > 0) push.point_m = point_m + side * aside[(k - 1) / 2];
    const double share = points == 1 ? 1.0 : (k == 0 ? 2.0 : 1.0) / 6.0;
    if (!voice.find_sane_amplitudes(push)) continue;
    for (std::size_t i = 0; i < table.columns(); ++i) port.weight[i] += share * voice.amplitudes().re[i];
  }
  double per_kg = 0;
  port.leaning = 0;
  const auto [log_re, log_im] = table.exponents();
  const double rate_hz = table.sample_rate_hz(), shape = modal::shape_factor(table.material_);
  for (std::size_t i = 0; i < table.playable_modes(); ++i) {
    const std::size_t c = table.column(i);
    const double w = log_im[c] * rate_hz, s = -log_re[c] * rate_hz, output = table.weight_[i] / shape;
    const double amplitude = port.weight[c];
    port.weight[c] = 0;
    if (!(std::abs(output) > 0)) continue;  // a mode that nobody hears has no state
    port.weight[c] = amplitude / (output * output * w);
    port.leaning += amplitude * w / (w * w + s * s);
    per_kg += amplitude * amplitude / (output * output);
  }
  return per_kg;
}

void TouchGroup::find_ports(TouchSlot& touch) REALTIME {
  const Touch& how = touch.touch;
  const bool rubs = how.kind == Touch::Kind::rub, slides = rubs || how.kind == Touch::Kind::couple;
  const std::array<Vec3, 2> along = across(how.direction);
  const auto on_other = [&](const Vec3& push) REALTIME { return rubs ? rotated(how.to_other, -1 * push) : -1 * push; };
  touch.per_kg = 0;
  for (std::size_t s = 0; s < touch.sides.size(); ++s) {
    TouchSlot::Side& side = touch.sides[s];
    if (!side.object) continue;
    Body& body = body_of(*side.object);
    find_response(body);
    const Vec3& point_m = s == 0 ? how.point_m : how.other_point_m;
    const bool turned = s == 1 && length(how.other_direction) > 0;
    const Vec3 direction = s == 0 ? how.direction : turned ? how.other_direction : on_other(how.direction);
    touch.per_kg += find_port(body, point_m, direction, how.width_m, side.ports[0]);
    for (std::size_t k = 0; slides && k < 2; ++k)
      static_cast<void>(find_port(body, point_m, s == 0 ? along[k] : on_other(along[k]), 0, side.ports[k + 1]));
  }
  touch.stale = false;
}

// The step and the bodies' compliance limit how stiff bristles can be: stiffer ones than half of 1 / Z would ring from
// step to step.
void TouchGroup::find_laws(TouchSlot& touch) REALTIME {
  const Touch& how = touch.touch;
  touch.contact.on = touch.open;
  if (how.kind != Touch::Kind::bow) {
    touch.contact.impact = contact::ImpactLaw{.stiffness = how.stiffness, .bounce = how.bounce};
  }
  if (how.kind == Touch::Kind::rub) {
    const double s2_m2 = 1.5 * mass_of(touch) / (how.force_n * rub_depth_m(how));
    touch.contact.impact->damping_s_m = 2 * kRubDamping * std::sqrt(s2_m2);
  }
  const bool rubs = how.kind == Touch::Kind::rub && how.friction > 0;
  touch.contact.directions = rubs || how.kind == Touch::Kind::couple ? 2 : how.kind == Touch::Kind::bow ? 1 : 0;
  if (touch.contact.directions == 0) return;
  constexpr double kStiffest_n_m = 2e6, kStribeck_m_s = 0.1;
  const std::size_t i = touch.first + (touch.contact.impact ? 1 : 0);
  const double compliance = std::max(taps_[(i * (i + 1) / 2 + i) * kTapRow], 1e-30);
  const double bristle = std::min(kStiffest_n_m, 0.5 / compliance);
  if (touch.contact.friction) touch.contact.sliding.stiffen(bristle / touch.contact.friction->bristle_n_m);
  touch.contact.friction =
      contact::FrictionLaw{.static_coefficient = how.friction,
                           .sliding_coefficient = how.sliding * how.friction,
                           .stribeck_m_s = kStribeck_m_s,
                           .bristle_n_m = bristle,
                           .bristle_ns_m = 0.3 * step_s_ * std::min(1 / compliance, std::sqrt(bristle / compliance))};
}

void TouchGroup::find_taps() REALTIME {
  coupled_.fill(false);
  std::fill_n(taps_.get(), kFreedoms * (kFreedoms + 1) / 2 * kTapRow, 0.0);
  struct Place {
    TouchPort* port;
    std::size_t freedom;
  };
  for (std::size_t b = 0; b < body_count_; ++b) {
    Body& body = bodies_[b];
    std::array<Place, kMaxPlaces> places;
    std::size_t count = 0;
    for (TouchSlot* touch : touches()) {
      for (TouchSlot::Side& side : touch->sides) {
        if (side.object != body.object || !touch->used) continue;
        for (std::size_t k = 0; k < touch->contact.freedoms() && count < kFreedoms; ++k) {
          places[count++] = {&side.ports[k], touch->first + k};
        }
      }
    }
    for (std::size_t j = 0; j < count; ++j) {
      std::array<const double*, kMaxPlaces> weights{};
      std::array<double*, kMaxPlaces> out{};
      std::array<std::array<double, kChunkFrames>, kMaxPlaces> room;
      std::size_t wanted = 0;
      for (std::size_t i = 0; i <= j; ++i) {
        weights[i] = places[i].port->weight.get();
        out[i] = room[i].data();
        ++wanted;
      }
      weights[wanted] = kTouchSound.data();
      out[wanted++] = places[j].port->answer.data() + kAnswerPadding;
      ModeArrays kicked = modes_of(body, TouchedStates(*body.object->voices.current()).open());
      kicked.z_re = kick_.get();
      kicked.z_im = kick_.get() + kMaxTouchColumns;
      for (std::size_t c = 0; c < body.table->columns(); ++c) {
        kicked.z_re[c] = places[j].port->weight[c] * body.response[c];
        kicked.z_im[c] = places[j].port->weight[c] * body.response[kMaxTouchColumns + c];
      }
      free_motion(kicked, body.table->columns(), {weights.data(), wanted}, {out.data(), wanted}, kMaxTouchSteps);
      for (std::size_t i = 0; i <= j; ++i) {
        const std::size_t low = std::min(places[i].freedom, places[j].freedom);
        const std::size_t high = std::max(places[i].freedom, places[j].freedom);
        const std::size_t pair = high * (high + 1) / 2 + low;
        coupled_[pair] = true;
        for (std::size_t n = 0; n < kMaxTouchSteps; ++n) taps_[pair * kTapRow + n] += room[i][n];
      }
    }
  }
  for (const TouchSlot* touch : touches()) {
    if (touch->rigid.kg == 0 || !touch->used) continue;
    const std::size_t pair = touch->first * (touch->first + 1) / 2 + touch->first;
    coupled_[pair] = true;
    const double first = 0.5 * step_s_ * step_s_ / touch->rigid.kg;
    for (std::size_t n = 0; n < kMaxTouchSteps; ++n) {
      taps_[pair * kTapRow + n] += first * static_cast<double>(2 * n + 1);
    }
  }
  for (std::size_t j = 0; j < network_.freedoms(); ++j) {
    for (std::size_t i = 0; i <= j; ++i) network_.set_compliance(i, j, taps_[(j * (j + 1) / 2 + i) * kTapRow]);
  }
}

// Finds again what has changed: who takes part, an object's voice, a point.
void TouchGroup::refresh(const Chunk& chunk) REALTIME {
  std::size_t wanted = 1;
  for (const TouchSlot* touch : touches()) {
    if (touch->used) wanted = std::max(wanted, substeps_for(*touch, chunk.sample_rate_hz));
  }
  bool stale = stale_ || wanted != substeps_ || step_s_ != 1 / (chunk.sample_rate_hz * static_cast<double>(wanted));
  for (std::size_t b = 0; b < body_count_ && !stale; ++b) {
    const Voice* const voice = bodies_[b].object->voices.current();
    stale = !voice || &voice->table() != bodies_[b].table;
  }
  bool moved = stale;
  if (stale) {
    stale_ = false;
    substeps_ = wanted;
    step_s_ = 1 / (chunk.sample_rate_hz * static_cast<double>(wanted));
    body_count_ = 0;
    network_.clear();
    for (TouchSlot* touch : touches()) {
      for (TouchSlot::Side& side : touch->sides) {
        if (!side.object || !side.object->voices.current()) continue;
        bool known = false;
        for (std::size_t b = 0; b < body_count_; ++b) known = known || bodies_[b].object == side.object;
        if (known) continue;
        Body& body = bodies_[body_count_++];
        body.object = side.object;
        body.table = &side.object->voices.current()->table();
        body.poles = side.poles.get();
        body.response = side.response.get();
        if (substeps_ > 1) find_poles(body);
      }
      find_laws(*touch);
      const std::optional<std::size_t> first = network_.add(touch->contact);
      touch->first = first.value_or(0);
      touch->stale = true;
      if (!first) touch->used = touch->open = touch->contact.on = false;
    }
  }
  for (TouchSlot* touch : touches()) {
    if (!touch->stale || !touch->used) continue;
    find_ports(*touch);
    moved = true;
  }
  if (!moved) return;
  for (const TouchSlot* touch : touches()) {  // what a contact's surfaces weigh is known only now
    if (touch->used && substeps_for(*touch, chunk.sample_rate_hz) > substeps_) return refresh(chunk);
  }
  find_taps();
  for (TouchSlot* touch : touches()) find_laws(*touch);
}

}  // namespace ringdown::synth
