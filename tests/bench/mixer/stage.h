// Our mixer with objects in it, and what they are: banks whose sound is known.
#pragma once

#include "engine/synth/mixer.h"
#include "tests/bench/mixer/row.h"

#include <memory>
#include <vector>

namespace ringdown::bench {

using Map = std::shared_ptr<const modal::StrikeMap>;

// Modes evenly spread over the logarithms of frequency and T60, the two without relation to each other.
struct Spread {
  std::size_t modes = 0;
  double low_hz = 40, high_hz = 19000;
  double shortest_t60_s = 3600, longest_t60_s = 3600;
  double amplitude = 0.1;  // of each mode in the sum, full scale 1
};

// Every `step`-th mode of the spread from number `first`, so that several objects together hold all of it. Struck by
// strike_of(), each mode sounds with `amplitude`.
Map bank_of(const Spread& spread, std::size_t first = 0, std::size_t step = 1);
synth::Event strike_of(synth::ObjectNumber object);

// amplitude exp(-decay t) sin(2 pi frequency t)
struct Sinusoid {
  double frequency_hz, decay_per_s, amplitude;
};
// How a bank from bank_of() sounds when struck, before panning.
std::vector<Sinusoid> sinusoids_of(const modal::Bank& bank);

class Stage {
 public:
  static constexpr double kPan = 0.70710678118654752;  // gain of either channel: objects stand in the middle

  explicit Stage(std::size_t block) : left_(block), right_(block) {}
  void install(synth::ObjectNumber object, const Map& map);  // with a table of its own
  void install(synth::ObjectNumber object, const std::shared_ptr<synth::ModeTable>& table);
  void set_threads(std::size_t threads) { mixer_.configure({.threads = threads}); }
  void push(const synth::Event& event);  // at its frame
  void render();                         // one block

  [[nodiscard]] const std::vector<float>& left() const { return left_; }
  [[nodiscard]] synth::Frame frame() const { return mixer_.counters().frames.load(); }  // the next block's first
  [[nodiscard]] std::size_t ringing_modes() const { return mixer_.counters().ringing_modes.load(); }
  [[nodiscard]] std::size_t coupled_voices() const { return mixer_.counters().coupled_voices.load(); }
  [[nodiscard]] std::size_t strikes() const { return mixer_.counters().strikes.load(); }
  [[nodiscard]] std::size_t lost() const { return lost_; }  // events for which there was no room

 private:
  synth::Mixer mixer_{kRate};
  std::vector<float> left_, right_;
  std::size_t lost_ = 0;
};

// The modes of `spread` in so many objects, struck and ringing. `bytes_per_mode`, when given: what they take, without
// the banks, which objects share.
std::unique_ptr<Stage> ringing_stage(const Spread& spread, std::size_t objects, std::size_t block,
                                     double* bytes_per_mode = nullptr, std::size_t threads = 1);

}  // namespace ringdown::bench
