#include "clients/cli/sound_output.h"

#include "clients/cli/long_work.h"
#include "engine/base/process/child_process.h"
#include "packaging/manual/command_line.h"
#include "server/sound_options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <vector>

namespace ringdown::cli {
namespace {

using protocol::complain;
using protocol::ExitCode;

double in_db(double peak) { return 20 * std::log10(peak + 1e-12); }

// "anim.wav" becomes "anim-02.wav".
std::filesystem::path numbered(const std::filesystem::path& path, int take, int takes) {
  std::string number = std::to_string(take);
  number.insert(0, std::to_string(takes).size() - number.size(), '0');
  std::filesystem::path name = path.stem();
  name += "-" + number;
  name += path.extension();
  return path.parent_path() / name;
}

// The picture with the sound lies beside the sound, with its name and the picture's ending.
std::filesystem::path muxed_path(const std::filesystem::path& sound, const std::filesystem::path& picture) {
  return std::filesystem::path(sound).replace_extension(picture.extension());
}

// Refuses what mux() could not do when all is rendered.
Result<void> check_mux(const std::filesystem::path& picture, const std::filesystem::path& sound) {
  if (!std::filesystem::is_regular_file(picture))
    return fail(ErrorKind::bad_input, "--mux: there is no file " + picture.string());
  const std::filesystem::path target = muxed_path(sound, picture);
  if (sound.extension().empty() || target == sound ||
      std::filesystem::weakly_canonical(target) == std::filesystem::weakly_canonical(picture))
    return fail(ErrorKind::usage, "--mux: the result would be " + target.string() +
                                      ", which is there already; give the sound (-o) another name");
  if (!run_child({.command = {"ffmpeg", "-version"}}))
    return fail(ErrorKind::refused,
                "--mux needs ffmpeg, which is not installed: install the package ffmpeg, or leave out --mux");
  return {};
}

// Puts the sound under the picture, which begins `from_s` before the sound.
Result<std::filesystem::path> mux(const std::filesystem::path& picture, const std::filesystem::path& sound,
                                  double from_s, const std::stop_token& stop) {
  std::filesystem::path target = muxed_path(sound, picture);
  std::filesystem::path part = target;
  part.replace_extension("." + std::to_string(::getpid()) + ".part" + picture.extension().string());
  const auto done = run_child({.command = {"ffmpeg",
                                           "-nostdin",
                                           "-v",
                                           "error",
                                           "-y",
                                           "-i",
                                           picture.string(),
                                           "-itsoffset",
                                           std::to_string(from_s),
                                           "-i",
                                           sound.string(),
                                           "-map",
                                           "0:v",
                                           "-map",
                                           "1:a",
                                           "-c:v",
                                           "copy",
                                           "-b:a",
                                           "320k",
                                           part.string()},
                               .keep_going = [&stop] { return !stop.stop_requested(); }});
  std::error_code error;
  if (done && done->exit_code == 0) std::filesystem::rename(part, target, error);
  if (done && done->exit_code == 0 && !error) return target;
  std::filesystem::remove(part, error);
  if (!done) return fail(done);
  if (done->stopped) return fail(ErrorKind::cancelled, "cancelled; " + target.string() + " was not written");
  return fail(ErrorKind::refused,
              "--mux: ffmpeg could not put the sound under " + picture.string() + ": " + last_line(done->errors));
}

void print(const session::Rendering& rendering, const std::string& path, const session::OfflineOptions& options,
           const SoundOutput& output, const std::string& more) {
  char loudness[64] = "too short or quiet for a loudness";
  if (rendering.lufs) std::snprintf(loudness, sizeof loudness, "%.1f LUFS", *rendering.lufs);
  std::printf("%s: %.2f s at %.0f Hz, peak %.1f dB, true peak %.1f dBTP, %s%s\n", path.c_str(), rendering.seconds,
              options.sample_rate_hz, in_db(rendering.peak), in_db(rendering.true_peak), loudness, more.c_str());
  if (output.file.stems) std::printf("%s: %zu stems\n", output.file.stems->c_str(), rendering.stems);
  if (output.file.lufs && !rendering.lufs && rendering.peak > 0)
    complain("the sound is too short or too quiet for a loudness, so --lufs has changed nothing", ExitCode::ok);
  if (rendering.peak <= 1) return;
  const bool whole = path.ends_with(".flac") || output.file.bits == 24;
  complain(std::string("the sound exceeds full scale") +
               (whole ? ", and 24 bits clip there: lower --lufs or the objects' gain, or write a .wav of floats"
                      : ": keep the file of floats, and lower it there, or lower --lufs or the objects' gain"),
           ExitCode::ok);
}

ExitCode write_take(const session::OfflineOptions& options, const SoundOutput& output, const std::string& path,
                    const std::stop_token& stop, const More& more, const Judge& judge) {
  const bool seen = isatty(STDERR_FILENO) != 0;
  ProgressLine line(path, output.progress_lines ? ProgressLine::Style::lines
                          : seen                ? ProgressLine::Style::bar
                                                : ProgressLine::Style::none);
  const auto rendering = session::render_to_file(
      options, path,
      [&](double done) {
        line.show("rendering", done);
        return !stop.stop_requested();
      },
      output.file);
  line.clear();
  if (!rendering) return complain(rendering.error());
  for (const std::string& warning : rendering->warnings) complain(warning, ExitCode::ok);
  print(*rendering, path, options, output, more ? more(*rendering) : "");
  if (output.mux) {
    const auto target = mux(*output.mux, path, options.from_s.value_or(0), stop);
    if (!target) return complain(target.error());
    std::printf("%s: %s with this sound\n", target->c_str(), output.mux->c_str());
  }
  return judge(*rendering, path);
}

}  // namespace

void add_sound_output(manual::App& app, session::OfflineOptions& options, SoundOutput& output) {
  app.add_option("-o,--output", output.path, "File to write: .wav (32-bit float, or --bits) or .flac (24 bit).")
      ->type_name("FILE")
      ->required();
  app.add_choice("--bits", output.file.bits, {{"24", 24}, {"32", 32}}, "Bits of a sample in a .wav; 32 are floats")
      ->type_name("24|32")
      ->default_str("32");
  app.add_option(
         "--tail", options.tail_s,
         "Seconds after the last event, faded at their end, 0 or more; default: until the sound is silent, below "
         "-96 dBFS.")
      ->check(manual::between(0.0, 3600.0));
  options.fade_s = session::kFade_s;
  app.add_option("--fade", options.fade_s, "Seconds within which the sound fades away at its end; 0: it is cut off.")
      ->check(manual::between(0.0, 60.0))
      ->capture_default_str();
  app.add_option("--lufs", output.file.lufs, "Loudness to give the file, by EBU R 128: -23 for broadcast.")
      ->check(manual::between(-70.0, 0.0));
  app.add_option("--stems", output.file.stems,
                 "Folder to write stems into: a file for each object and kind of contact (impact, slide, roll).")
      ->type_name("FOLDER");
  app.add_option("--camera", options.camera, "Camera of the glTF scene that listens; default: the first.")
      ->type_name("NAME");
  app.add_option("--takes", output.takes,
                 "Number of files to write, FILE-1 and so on, each played a little differently: other strike points, "
                 "contact times, impulses, roughness.")
      ->check(manual::between(1, 1000));
  app.add_option("--scatter", output.variation.point_m, "Metres by which a take's strike point lies aside, at most.")
      ->check(manual::between(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--vary-contact", output.variation.contact_time,
                 "Largest change of a take's contact times: 0.1 is 10 % more, or as many times less.")
      ->check(manual::between(0.0, 9.0))
      ->capture_default_str();
  app.add_option("--vary-impulse", output.variation.impulse,
                 "Largest change of a take's impulses, as for contact times.")
      ->check(manual::between(0.0, 9.0))
      ->capture_default_str();
  app.add_option("--seed", output.variation.seed, "Seed of the takes: the same seed makes the same takes.")
      ->check(manual::between(std::uint64_t{0}, std::uint64_t{1} << 53))
      ->capture_default_str();
  app.add_option("--mux", output.mux, "Video to put the sound under, by ffmpeg; the result lies beside the sound.")
      ->type_name("FILE");
  app.add_option("--rate", options.sample_rate_hz, "Sample rate in Hz.")
      ->check(manual::between(8000.0, 768000.0))
      ->capture_default_str();
  app.add_flag("--progress-lines", output.progress_lines,
               "For programs: progress as lines 'FRACTION STAGE' on stdout.");
  server::add_sound_options(app, options.mixer);
}

ExitCode write_sound(session::OfflineOptions options, const SoundOutput& output, const std::stop_token& stop,
                     const More& more, const Judge& judge) {
  if (output.file.stems && !options.score.empty())
    return complain("--stems takes a scene apart, and no score: leave out --events", ExitCode::usage);
  if (options.seconds && options.tail_s)
    return complain("--seconds is the length with its tail: leave out --tail", ExitCode::usage);
  if (output.mux) {
    if (const auto good = check_mux(*output.mux, output.path); !good) return complain(good.error());
  }
  if (output.takes == 0) return write_take(options, output, output.path, stop, more, judge);
  ExitCode outcome = ExitCode::ok;
  for (int take = 1; take <= output.takes; ++take) {
    // Takes of neighbouring seeds have nothing in common.
    options.variation = output.variation;
    options.variation->seed = output.variation.seed * 1000003 + static_cast<std::uint64_t>(take);
    SoundOutput one = output;
    if (one.file.stems) *one.file.stems = numbered(*one.file.stems / "take", take, output.takes);
    const ExitCode code =
        write_take(options, one, numbered(output.path, take, output.takes).string(), stop, more, judge);
    if (code != ExitCode::ok && code != ExitCode::silence) return code;
    if (code != ExitCode::ok) outcome = code;
  }
  return outcome;
}

}  // namespace ringdown::cli
