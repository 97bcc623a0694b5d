// ringdown-fit: finds the modes of a struck object in a recording and writes them as a bank, or fits a bank's damping
// to the recording.
#include "clients/cli/fit/report.h"
#include "clients/cli/fit/sound.h"
#include "clients/cli/long_work.h"
#include "engine/base/output_file.h"
#include "engine/fit/burst.h"
#include "engine/fit/recorded_bank.h"
#include "engine/fit/settle.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/hearing/loudness.h"
#include "packaging/manual/command_line.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

using namespace ringdown;  // NOLINT: a program
using manual::complain_of_usage;
using protocol::complain;
using protocol::ExitCode;
namespace fs = std::filesystem;

struct Arguments {
  fs::path input, output, damping_of, residual, resynth;
  std::optional<int> channel;
  std::array<double, 2> band = {20, 20000};
  std::vector<double> impulse = {0, 0, 1};
  double contact_ms = 0;
  bool without_burst = false;
  std::string name;
  fit::Options options;
  fit::CalibrateOptions match;
};

void add_options(manual::App& app, Arguments& arguments) {
  app.add_option("wave", arguments.input, "The recording of one blow: WAV, FLAC, AIFF, ...")
      ->type_name("FILE")
      ->required();
  app.add_option("-o,--output", arguments.output, "The bank to write; default: the modes are only printed.")
      ->type_name("FILE");
  app.add_option("--damping-of", arguments.damping_of,
                 "A baked bank of the same object: --output is that bank with its loss factors fitted to the "
                 "recording.")
      ->type_name("FILE");
  app.add_option(
         "--tolerance", arguments.match.tolerance_cents,
         "With --damping-of: largest frequency error of a matching mode in cents, after the common tuning is removed.")
      ->check(manual::between(0.1, 200.0))
      ->capture_default_str();
  app.add_option("--channel", arguments.channel,
                 "The channel, counted from 1; default: the mean of all channels, or the loudest one if they cancel.")
      ->check(manual::between(1, 1024));
  app.add_option("--from", arguments.options.from_s,
                 "Time of the blow in seconds; default: the beginning of the sound.")
      ->check(manual::any_number());
  app.add_option("--band", arguments.band, "Lowest and highest frequency in Hz; default: 20 20000.")
      ->type_name("LOW HIGH")
      ->check(manual::any_number());
  app.add_option("--floor", arguments.options.floor_db,
                 "Drop modes that begin more than this many dB below the loudest.")
      ->check(manual::between(1.0, 200.0))
      ->capture_default_str();
  app.add_option("--max-modes", arguments.options.max_modes,
                 "Keep at most this many modes, those with the most energy.")
      ->check(manual::between(std::size_t{1}, fit::kMaxModes))
      ->capture_default_str();
  app.add_option("--impulse", arguments.impulse,
                 "The impulse in N s that should sound as loud as the recording; default: 0,0,1.")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->check(manual::any_number());
  app.add_option("--contact", arguments.contact_ms,
                 "The contact time in ms that this impulse will have; its spectrum is divided out.")
      ->check(manual::between(0.0, 100.0))
      ->capture_default_str();
  app.add_flag("--no-burst", arguments.without_burst,
               "Keep only modes; by default the rest of the blow becomes a burst of noise in the bank.");
  app.add_option("--name", arguments.name, "The bank's name; default: the recording's.");
  app.add_option("--resynth", arguments.resynth, "Write the sum of the modes, and of the burst, as a sound.")
      ->type_name("FILE");
  app.add_option("--residual", arguments.residual, "Write the recording minus the modes and the burst as a sound.")
      ->type_name("FILE");
}

std::size_t sample_at(double seconds, const cli::Sound& sound) {
  return std::min(static_cast<std::size_t>(std::round(seconds * sound.sample_rate_hz)), sound.samples.size());
}

fit::Kept keep(const fit::Fit& found, const cli::Sound& sound, const Arguments& arguments) {
  const auto part = std::span(sound.samples).first(sample_at(found.end_s, sound));
  return fit::keep(part, sound.sample_rate_hz, sample_at(found.onset_s, sound), found.modes, !arguments.without_burst);
}

// Writes the sum of the modes in their own phases with a burst that was fitted together with them. The bank's burst was
// fitted with modes in other phases, and would count twice what those modes lack.
Result<void> write_sounds(const fit::Fit& found, const cli::Sound& sound, const Arguments& arguments,
                          const std::stop_token& stop) {
  if (arguments.resynth.empty() && arguments.residual.empty()) return {};
  const std::size_t onset = sample_at(found.onset_s, sound), count = sound.samples.size();
  std::vector<double> samples = fit::played_from(found.modes, sound.sample_rate_hz, onset, count);
  if (!arguments.resynth.empty()) {
    std::vector<double> all = samples;
    if (!arguments.without_burst && arguments.damping_of.empty()) {
      const auto part = std::span(sound.samples).first(sample_at(found.end_s, sound));
      const auto noise = fit::burst_modes(fit::fit_burst(part, sound.sample_rate_hz, onset, found.modes));
      const std::vector<double> burst = fit::played_from(noise, sound.sample_rate_hz, onset, count);
      for (std::size_t n = 0; n < count; ++n) all[n] += burst[n];
    }
    if (auto written = cli::write_sound(all, sound.sample_rate_hz, arguments.resynth, stop); !written) return written;
  }
  if (arguments.residual.empty()) return {};
  for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = sound.samples[n] - samples[n];
  return cli::write_sound(samples, sound.sample_rate_hz, arguments.residual, stop);
}

// The amplitude of a mode in one channel, with its object in the centre, divided by 2 pi f F(f) (phi . j).
constexpr double kLoudness =
    modal::Air{}.density_kg_m3 * modal::kUnknownFlow / modal::kFullScale_pa / std::numbers::sqrt2;

Result<modal::Bank> bank_of(const fit::Fit& found, const fit::Kept& kept, const Arguments& arguments) {
  if (arguments.damping_of.empty()) {
    const fit::Blow blow{{arguments.impulse[0], arguments.impulse[1], arguments.impulse[2]},
                         arguments.contact_ms / 1e3};
    return fit::to_bank(kept.modes, blow, kLoudness, arguments.name, kept.noise);
  }
  const Result<modal::Bank> bank = modal::read_bank(arguments.damping_of);
  if (!bank) return bank;
  const Result<fit::Calibration> calibration = fit::calibrate(found.modes, *bank, arguments.match);
  if (!calibration) return fail(arguments.input.string(), calibration);
  cli::print_calibration(found, *bank, *calibration);
  return fit::with_losses(*bank, *calibration);
}

ExitCode fit_recording(Arguments& arguments, const std::stop_token& stop) {
  const Result<cli::Sound> sound = cli::read_sound(arguments.input, arguments.channel);
  if (!sound) return complain(sound);
  if (!sound->note.empty()) complain("warning: " + arguments.input.string() + ": " + sound->note, ExitCode::ok);
  const Result<fit::Fit> found = fit::fit_modes(sound->samples, sound->sample_rate_hz, arguments.options);
  if (stop.stop_requested()) return complain({ErrorKind::cancelled, "cancelled; nothing was written"});
  if (!found) return complain({found.error().kind, arguments.input.string() + ": " + found.error().message});
  const bool is_of_recording = arguments.damping_of.empty();  // else it is a baked bank with other damping
  const fit::Kept kept = is_of_recording ? keep(*found, *sound, arguments) : fit::Kept{};
  if (found->modes.empty() && kept.noise.empty()) {
    return complain({ErrorKind::bad_input,
                     arguments.input.string() + " has no mode above its noise; name the time of a blow by --from"});
  }
  cli::print_fit(arguments.input.string(), *found);
  if (is_of_recording) cli::print_kept(arguments.input.string(), *found, kept);
  const Result<modal::Bank> bank = bank_of(*found, kept, arguments);
  if (!bank) return complain(bank);
  if (!arguments.output.empty()) {
    const auto written = modal::write_bank(*bank, arguments.output);
    if (!written) return complain(written);
  }
  const auto written = write_sounds(*found, *sound, arguments, stop);
  return written ? ExitCode::ok : complain(written);
}

// The text of the man page in addition to the options.
const std::vector<manual::Section> kSections = {
    {"EXAMPLES",
     {{"ringdown fit cup.wav -o cup.glb", "The modes of a cup that was tapped once, as a bank that plays them."},
      {"ringdown fit cup.wav --damping-of baked-cup.glb -o cup.glb", "The baked cup, decaying like the real one."}}},
    {"SEE ALSO", {{"ringdown(1), ringdown-bake(1), ringdownd(1)", "The other programs."}}},
};

ExitCode run(int argc, char** argv) {
  manual::App app("Finds the modes of a struck object in a recording.", "ringdown-fit");
  Arguments arguments;
  add_options(app, arguments);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  const auto& j = arguments.impulse;
  if (!(std::hypot(j[0], j[1], j[2]) > 0)) {
    return complain_of_usage(app, "--impulse takes three numbers that are not all 0, like 0,0,1");
  }
  if (arguments.name.empty()) arguments.name = arguments.input.stem().string();
  arguments.options.low_hz = arguments.band[0];
  arguments.options.high_hz = arguments.band[1];
  for (const fs::path& path : {arguments.output, arguments.resynth, arguments.residual}) keep_stdout_for(path);
  return cli::run_cancellable([&arguments](const std::stop_token& stop) { return fit_recording(arguments, stop); });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}
