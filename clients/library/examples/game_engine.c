/* How a game makes its collisions sound with libringdown, in 60 lines of C. Copy what you need.
 *
 *   cc game_engine.c $(pkg-config --cflags --libs ringdown) -o game_engine
 *   ./game_engine bell.glb bounces.f32              # 3 s of stereo float32 samples at 48 kHz, as the game's mixer takes
 *
 * A ball falls on an object at the origin and bounces. The game steps 60 times a second. Here one thread does all;
 * a real game calls ringdown_render() in its audio callback, and the rest where it steps its physics. */
#include "ringdown.h"

#include <stdio.h>
#include <stdlib.h>

enum { kRate = 48000, kStep = kRate / 60, kSteps = 180 };

static void check(ringdown_result result, const ringdown_error* error) {
  if (result == RINGDOWN_OK) return;
  fprintf(stderr, "game_engine: %s\n", error->sentence);
  exit(1);
}

int main(int argc, char** argv) {
  if (argc != 3) return fprintf(stderr, "usage: game_engine BANK.glb OUT.f32\n"), 2;
  ringdown_error error;
  ringdown_bank* bank;
  ringdown_mixer* mixer;
  uint32_t bell;
  check(ringdown_bank_open(argv[1], &bank, &error), &error);
  check(ringdown_mixer_create(NULL, &mixer, &error), &error);
  check(ringdown_add(mixer, "bell", bank, &bell, &error), &error);
  ringdown_bank_release(bank); /* the mixer keeps what it plays */
  FILE* file = fopen(argv[2], "wb");
  if (!file) return perror(argv[2]), 1;

  const double mass_kg = 0.02, restitution = 0.6, gravity = 9.81;
  double height_m = 0.2, speed_m_s = 0;
  static float left[kStep], right[kStep];
  for (int step = 0; step < kSteps; ++step) {
    const double seconds = (double)kStep / kRate;
    speed_m_s -= gravity * seconds;
    height_m += speed_m_s * seconds;
    if (height_m < 0 && speed_m_s < 0) { /* the contact callback: where, and how hard */
      const double since_s = height_m / speed_m_s; /* it happened within the step: to the sample, not to the step */
      const double point_m[3] = {0, 0, 0}, impulse_ns[3] = {0, 0, mass_kg * speed_m_s * (1 + restitution)};
      const int64_t frame = ringdown_now(mixer) + kStep - (int64_t)(since_s * kRate);
      check(ringdown_strike(mixer, frame, bell, point_m, impulse_ns, 0.0005, &error), &error);
      height_m *= -restitution;
      speed_m_s *= -restitution;
    }
    ringdown_render(mixer, left, right, kStep); /* the audio callback */
    ringdown_collect(mixer);
    for (int i = 0; i < kStep; ++i) fwrite((float[2]){left[i], right[i]}, sizeof(float), 2, file);
  }
  ringdown_mixer_destroy(mixer);
  if (fclose(file) != 0) return perror(argv[2]), 1;
  return 0;
}
