#include "clients/cli/fit/report.h"

#include "engine/base/note.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ringdown::cli {
namespace {

double decibels(double ratio) { return 20 * std::log10(ratio); }

// A standard error small enough that cents are proportional to it.
double cents_of(double relative) { return 1200 / std::log(2.0) * relative; }

}  // namespace

void print_fit(const std::string& name, const fit::Fit& fit) {
  std::printf("%s: %zu modes explain %.2f %% of the energy from %.4f s to %.4f s; the residual is %.1f dB below\n",
              name.c_str(), fit.modes.size(), 100 * fit.explained, fit.start_s, fit.end_s,
              -10 * std::log10(std::max(1 - fit.explained, 1e-30)));
  std::printf("onset      %.4f s; amplitudes refer to this time\n", fit.onset_s);
  if (fit.clipped > 0) std::printf("clipped    %zu samples; the fit begins at the last of them\n", fit.clipped);
  std::printf("\n%5s %12s %10s %9s %8s %10s %8s  %s\n", "mode", "frequency Hz", "+- cents", "T60 s", "+- %",
              "level dBFS", "+- dB", "note");
  for (std::size_t m = 0; m < fit.modes.size(); ++m) {
    const fit::Mode& mode = fit.modes[m];
    std::printf("%5zu %12.3f %10.2g %9.4g %8.2g %10.1f %8.2g  %s\n", m, mode.frequency_hz,
                cents_of(mode.frequency_error_hz / mode.frequency_hz), modal::t60_s(mode.decay_per_s),
                100 * mode.decay_error_per_s / mode.decay_per_s, decibels(mode.amplitude),
                decibels(1 + mode.amplitude_error), note_name(mode.frequency_hz).c_str());
  }
}

void print_kept(const std::string& name, const fit::Fit& fit, const fit::Kept& kept) {
  constexpr double kLittle = 0.5;
  const fit::Burst& burst = kept.burst;
  const std::size_t modes = kept.noise.size();
  std::printf("\n");
  if (modes > 0) {
    double shortest = INFINITY, longest = 0;
    for (std::size_t b = 0; b < burst.level.size(); ++b) {
      if (burst.level[b] == 0) continue;
      const double t60 = modal::t60_s(burst.decay_per_s[b / fit::kBandsOfDecay]);
      shortest = std::min(shortest, t60);
      longest = std::max(longest, t60);
    }
    std::printf("burst      of noise, %zu numbers, T60 %.3g to %.3g s; the bank plays it as %zu short modes\n",
                burst.numbers(), shortest, longest, modes);
  }
  if (std::isfinite(kept.distance_db)) {
    std::printf("distance   %.1f dB from the bank's sound to the recording, in thirds of an octave by 10 ms",
                kept.distance_db);
    if (std::isfinite(kept.sure_db)) std::printf("; %.1f dB without isolated cells", kept.sure_db);
    std::printf("\n");
  }
  if (fit.of_blow < kLittle) {
    std::fflush(stdout);
    std::fprintf(stderr, "ringdown-fit: warning: the modes explain only %.2g %% of the blow's energy in %s; %s\n",
                 100 * fit.of_blow, name.c_str(), modes > 0 ? "the rest is a burst of noise" : "the rest is lost");
  }
}

void print_calibration(const fit::Fit& fit, const modal::Bank& bank, const fit::Calibration& calibration) {
  std::printf("\n%5s %12s %12s %9s %10s %10s %10s\n", "mode", "recorded Hz", "baked Hz", "off cents", "decay 1/s",
              "fitted 1/s", "");
  for (const fit::Match& match : calibration.matches) {
    const fit::Mode& mode = fit.modes[match.recorded];
    std::printf("%5zu %12.3f %12.3f %9.1f %10.4g %10.4g %10s\n", match.baked, mode.frequency_hz,
                bank.frequency_hz[match.baked], match.off_cents, mode.decay_per_s,
                fit::fitted_loss(calibration, bank, match.baked, mode.frequency_hz).total_per_s(),
                match.used ? "" : "left out");
  }
  std::printf(
      "\n%zu of the recording's %zu modes match one of the bank's %zu; the loss factor is fitted to %zu of them\n",
      calibration.matches.size(), fit.modes.size(), bank.mode_count(), calibration.used());
  std::printf("tuning     %+.1f cents from the bank to the recording\n", calibration.tuning_cents);
  std::printf("loss       factor %s; the material's part of the decays lies within %.2g %% (standard deviation)\n",
              calibration.text().c_str(), 100 * calibration.spread);
}

}  // namespace ringdown::cli
