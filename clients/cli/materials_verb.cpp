#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/note.h"
#include "engine/base/output_file.h"
#include "engine/materials/material_bar.h"
#include "engine/materials/material_library.h"
#include "engine/synth/mixer.h"
#include "packaging/manual/command_line.h"
#include "server/session/offline.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>

namespace ringdown::cli {
namespace {

struct MaterialsArguments {
  std::string name, sound;
  std::filesystem::path folder;
  bool markdown = false;
};

constexpr double kSeconds = 2;  // length of the preview, printed and rendered
constexpr Vec3 kImpulse_ns = {0, 0, -0.02};
constexpr double kContactTime_s = 5e-4;

synth::Event blow(const modal::Bank& bar) {
  const modal::Vec3f& end = bar.positions.front();
  return {.object = 0,
          .verb = synth::verb::Strike{
              .point_m = {end[0], end[1], end[2]}, .impulse_ns = kImpulse_ns, .contact_time_s = kContactTime_s}};
}

// Renders a blow on the end of the bar by the daemon's mixer, with the loudest sample at -3 dB of full scale.
session::Recording strike(const modal::Bank& bar) {
  constexpr double kRate_hz = 48000, kPeak = 0.7079;
  session::Recording recording{.sample_rate_hz = kRate_hz};
  synth::Mixer mixer(kRate_hz);
  const auto map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(bar));
  static_cast<void>(mixer.install(0, std::make_unique<synth::Voice>(map, modal::MaterialScale{}, kRate_hz),
                                  synth::Mixer::Install::replace));
  static_cast<void>(mixer.push(synth::Producer::control, blow(bar)));
  const auto frames = static_cast<std::size_t>(kSeconds * kRate_hz);
  recording.left.resize(frames);
  recording.right.resize(frames);
  constexpr std::size_t kBlock = 256;
  for (std::size_t done = 0; done < frames;) {
    const std::size_t now = std::min(kBlock, frames - done);
    mixer.render(std::span(recording.left).subspan(done, now), std::span(recording.right).subspan(done, now));
    done += now;
  }
  float peak = 0;
  for (const float sample : recording.left) peak = std::max(peak, std::abs(sample));
  if (peak == 0) return recording;
  for (auto* channel : {&recording.left, &recording.right}) {
    for (float& sample : *channel) sample *= static_cast<float>(kPeak) / peak;
  }
  recording.peak = static_cast<float>(kPeak);
  return recording;
}

// The level of the blow's sound at time t, from the bar's modes [dB, any reference].
double level_db(const modal::Bank& bar, double t_s) {
  double energy = 0;
  for (std::size_t m = 0; m < bar.mode_count(); ++m) {
    const double amplitude = bar.frequency_hz[m] * bar.shape(m, 0)[2] * std::exp(-bar.decay_per_s[m] * t_s);
    energy += amplitude * amplitude;
  }
  return 10 * std::log10(energy + 1e-300);
}

// One character for each tenth of a second, from '#' at the level of the blow to '.' about 50 dB below; then nothing.
std::string decay_curve(const modal::Bank& bar) {
  constexpr std::string_view kLevels = "#@%*+=-:.";
  constexpr double kStep_s = 0.1, kStep_db = 60.0 / kLevels.size();
  const double start = level_db(bar, 0);
  std::string curve;
  for (int i = 0; i < static_cast<int>(std::lround(kSeconds / kStep_s)); ++i) {
    const auto level = static_cast<std::size_t>(std::max(0.0, (start - level_db(bar, i * kStep_s)) / kStep_db));
    curve += level < kLevels.size() ? kLevels[level] : ' ';
  }
  return curve;
}

// Seconds to -60 dB of a mode whose undamped frequency is given, in this material.
double t60_at(const modal::Material& material, double frequency_hz) {
  const double omega = modal::hz_to_rad_per_s(frequency_hz);
  return modal::t60_s(modal::mode_loss(material.damping_law(), omega * omega).total_per_s());
}

std::string lowest_mode_of(const modal::Bank& bar) {
  if (bar.mode_count() == 0) return "none";
  return formatted("{:7.1f} Hz  {}", bar.frequency_hz.front(), note_name(bar.frequency_hz.front()));
}

void print_heading() {
  std::printf("%-17s %7s %6s %7s  %-22s %9s %7s %7s  %s\n", "material", "E GPa", "nu", "kg/m3", "bar 200 x 30 x 8 mm",
              "its T60", "1 kHz", "4 kHz", "2 s of it");
}

void print_row(const bake::MaterialEntry& entry) {
  const modal::Material& m = entry.material;
  const modal::Bank bar = bake::bar_bank(m);
  const double t60 = bar.mode_count() > 0 ? modal::t60_s(bar.decay_per_s.front()) : 0;
  std::printf("%-17s %7.4g %6.3g %7.5g  %-22s %7.2g s %5.2g s %5.2g s  |%s|\n", m.name.c_str(),
              m.youngs_modulus_pa / 1e9, m.poisson_ratio, m.density_kg_m3, lowest_mode_of(bar).c_str(), t60,
              t60_at(m, 1000), t60_at(m, 4000), decay_curve(bar).c_str());
}

// Twelve lines of the level against time.
void print_curve(const modal::Bank& bar) {
  constexpr int kRows = 12, kColumns = 60;
  constexpr double kRow_db = 5;
  const double start = level_db(bar, 0);
  std::printf("\n  dB\n");
  for (int row = 0; row < kRows; ++row) {
    std::string line;
    for (int column = 0; column < kColumns; ++column) {
      line += start - level_db(bar, kSeconds * column / kColumns) < kRow_db * (row + 1) ? '#' : ' ';
    }
    line.erase(line.find_last_not_of(' ') + 1);
    std::printf("%4.0f |%s\n", 0 - kRow_db * row, line.c_str());
  }
  std::printf("     +%s %.0f s\n", std::string(kColumns, '-').c_str(), kSeconds);
}

void print_figure(const char* label, double value, const char* unit, const std::string& source) {
  std::printf("  %-8s %10.5g %-8s %s\n", label, value, unit, source.c_str());
}

void print_material(const bake::MaterialEntry& entry) {
  const modal::Material& m = entry.material;
  const auto& from = entry.sources;
  std::printf("%s: %s\n", m.name.c_str(), entry.description.c_str());
  print_figure("E", m.youngs_modulus_pa, "Pa", from.at("youngs_modulus_pa"));
  print_figure("nu", m.poisson_ratio, "", from.at("poisson_ratio"));
  print_figure("rho", m.density_kg_m3, "kg/m3", from.at("density_kg_m3"));
  for (const modal::LossFactor& point : m.loss_factors)
    std::printf("  loss factor at %7.5g Hz: %.3g\n", point.frequency_hz, point.eta);
  if (entry.uncertainty > 0)
    std::printf("  loss factors of an alloy or a piece may differ by a factor of %.3g\n", entry.uncertainty);
  print_figure("alpha", m.damping.alpha_per_s, "1/s", from.at("alpha_per_s"));
  const bool same = from.at("beta_s") == from.at("alpha_per_s");
  print_figure("beta", m.damping.beta_s, "s", same ? "as alpha" : from.at("beta_s"));
  if (m.thermal) {
    print_figure("expands", m.thermal->expansion_per_k, "1/K", from.at("expansion_per_k"));
    print_figure("conducts", m.thermal->conductivity_w_mk, "W/(m K)", from.at("conductivity_w_mk"));
    print_figure("heat", m.thermal->heat_capacity_j_kgk, "J/(kg K)", from.at("heat_capacity_j_kgk"));
  }
  if (const auto& brittle = m.brittleness) {
    print_figure("strength", brittle->strength.strength_pa, "Pa", from.at("strength_pa"));
    print_figure("Weibull", brittle->strength.weibull_modulus, "", from.at("weibull_modulus"));
    const auto area = from.find("strength_area_m2");
    print_figure("of area", brittle->strength.reference_area_m2, "m2", area == from.end() ? "" : area->second);
    print_figure("K_Ic", brittle->toughness_pa_sqrt_m, "Pa m^1/2", from.at("toughness_pa_sqrt_m"));
  }
  for (const auto& [key, source] : from) {
    if (key.starts_with("grain.")) std::printf("  %-28s %s\n", key.c_str(), source.c_str());
  }
  const modal::Bank bar = bake::bar_bank(m);
  std::printf("\nA free bar of 200 x 30 x 8 mm, struck on its end (bending modes of Timoshenko's beam):\n");
  for (std::size_t i = 0; i < std::min<std::size_t>(bar.mode_count(), 6); ++i) {
    std::printf("  %9.1f Hz  %-11s T60 %.2g s\n", bar.frequency_hz[i], note_name(bar.frequency_hz[i]).c_str(),
                modal::t60_s(bar.decay_per_s[i]));
  }
  if (bar.mode_count() == 0) return void(std::printf("  the bar has no mode that rings\n"));
  std::printf("  T60 at 1 kHz %.2g s, at 4 kHz %.2g s\n", t60_at(m, 1000), t60_at(m, 4000));
  print_curve(bar);
}

ExitCode list(const MaterialsArguments& arguments) {
  if (arguments.markdown) {
    const Result<std::string> page = bake::materials_as_markdown(arguments.folder);
    if (!page) return complain(page);
    const Result<std::string> grains = bake::grains_as_markdown(arguments.folder);
    if (!grains) return complain(grains);
    const Result<std::string> strengths = bake::strengths_as_markdown(arguments.folder);
    if (!strengths) return complain(strengths);
    std::fputs((*page + "\n" + *grains + "\n" + *strengths).c_str(), stdout);
    return ExitCode::ok;
  }
  const std::vector<std::string> names = bake::names_in(arguments.folder);
  if (names.empty()) return complain({ErrorKind::bad_input, "there are no materials in " + arguments.folder.string()});
  print_heading();
  for (const std::string& name : names) {
    const auto entry = bake::read_material(arguments.folder / (name + ".toml"));
    if (!entry) return complain(entry);
    print_row(*entry);
  }
  std::printf(
      "\nringdown materials NAME prints the source of each figure; with --sound FILE.wav it writes the sound of a "
      "bar.\n");
  return ExitCode::ok;
}

ExitCode show(const MaterialsArguments& arguments) {
  const auto entry = bake::find_material(arguments.folder, arguments.name);
  if (!entry) return complain(entry);
  if (arguments.sound.empty()) {
    print_material(*entry);
    return ExitCode::ok;
  }
  const modal::Bank bar = bake::bar_bank(entry->material);
  if (bar.mode_count() == 0)
    return complain({ErrorKind::bad_input, "no mode of a bar of " + arguments.name + " rings"});
  if (const auto written = session::write_audio(strike(bar), arguments.sound); !written) return complain(written);
  std::printf("%s: %.0f s of a bar of %s, %s\n", arguments.sound.c_str(), kSeconds, arguments.name.c_str(),
              lowest_mode_of(bar).c_str());
  return ExitCode::ok;
}

ExitCode materials(MaterialsArguments arguments) {
  const auto folder = material_folder(arguments.folder);
  if (!folder) return complain(folder);
  arguments.folder = *folder;
  const ExitCode code = arguments.name.empty() ? list(arguments) : show(arguments);
  if (code == ExitCode::ok && std::fflush(stdout) != 0)
    return complain({ErrorKind::input_output, "cannot write to the standard output"});
  return code;
}

}  // namespace

void add_materials_verb(manual::App& app, ExitCode& outcome) {
  auto arguments = std::make_shared<MaterialsArguments>();
  manual::App* verb =
      app.add_subcommand("materials", "Lists the materials with the sound of a bar of each, or shows one of them.");
  manual::Option* name =
      verb->add_option("name", arguments->name, "The material to show, with the source of each figure.")
          ->type_name("NAME");
  verb->add_option("--materials", arguments->folder, "Folder of materials (default: the presets').")
      ->type_name("FOLDER");
  verb->add_option(
          "--sound", arguments->sound,
          "Write two seconds of a blow on a bar of the material to this file: .wav (32-bit float) or .flac (24 bit).")
      ->type_name("FILE")
      ->needs(name);
  verb->add_flag("--markdown", arguments->markdown, "All figures as a Markdown table, for docs/use/materials.md.")
      ->excludes(name);
  verb->callback([arguments, &outcome] {
    keep_stdout_for(arguments->sound);
    outcome = materials(*arguments);
  });
}

}  // namespace ringdown::cli
