// The parts of the mixer benchmark. Each hands its rows to `sink` as they come.
#pragma once

#include "tests/bench/mixer/row.h"

namespace ringdown::bench {

// Modes per core: ours in one object and in ten, plain filters, Faust, scsynth; by turns, so that what disturbs the
// machine disturbs all.
void measure_throughput(const Settings& settings, const Sink& sink);

// Error of the sum of 2,000 modes, 20 Hz to 0.499 of the sample rate and T60 from 5 ms to 10 min, 1 s and 10 min after
// the strike; and how many modes per core each kernel sustains.
void measure_accuracy(const Settings& settings, const Sink& sink);

// A block of 1,000 silent objects.
void measure_silence(const Settings& settings, const Sink& sink);

// What a strike adds to a block.
void measure_strikes(const Settings& settings, const Sink& sink);

// 10,000 strikes a second on 1,000 objects.
void measure_storm(const Settings& settings, const Sink& sink);

// Block time and audible modes while a scene of 200 objects dies away.
void measure_decay(const Settings& settings, const Sink& sink);

// Block time while 999 of 1,000 modes pass through denormal numbers and one still rings, beside all of them loud.
void measure_tail(const Settings& settings, const Sink& sink);

// 1,000 objects of one bank that share their states, the same each for itself, and two of them.
void measure_instances(const Settings& settings, const Sink& sink);

// 10,000 modes in 100 objects that a listener hears from their places: standing, turning once a second, flying to and
// fro; and without a listener.
void measure_directions(const Settings& settings, const Sink& sink);
void measure_fields(const Settings& settings, const Sink& sink);

// 16 two-way contacts of 200 + 200 modes, touching and apart, and the same modes ringing freely.
void measure_two_way(const Settings& settings, const Sink& sink);

// 10,000 modes in 100 objects whose pitches glide, and the same without nonlinear terms; one object whose modes
// exchange energy.
void measure_nonlinear(const Settings& settings, const Sink& sink);

// The same mixer behind the C library, blocks of 64 with a strike in each.
void measure_library(const Settings& settings, const Sink& sink);

// One thread and two, at 30,000 modes.
void measure_threads(const Settings& settings, const Sink& sink);

// What the kinds of work that a time budget counts cost for each mode, over what moments cost; mean_us is of an object.
void measure_budget(const Settings& settings, const Sink& sink);

// How the time of a block grows with the number of modes, objects, strikes a second, two-way contacts and channels.
void measure_growth(const Settings& settings, const Sink& sink);
void grow_strikes(const Settings& settings, const Sink& sink);
void grow_contacts(const Settings& settings, const Sink& sink);
void grow_channels(const Settings& settings, const Sink& sink);

}  // namespace ringdown::bench
