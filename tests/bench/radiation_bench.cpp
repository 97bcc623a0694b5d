// Radiation of banks: time, sizes and stated errors. CSV on the standard output.
//
//   ringdown_radiation_bench [--modes] [--panels-per-wave N] [--threads N] BANK...
//   ringdown_radiation_bench --compare N BANK    error against time, beside a dense factorization for each mode
//   ringdown_radiation_bench --surface N BANK    power through the surface beside that in the far field, on one skin
//   ringdown_radiation_bench --levels BANK...    levels at other wavenumbers beside those of skins four times as fine
//   ringdown_radiation_bench --growth BANK       time and memory of one mode against the nodes of its skin
#include "engine/modal/bank_file.h"
#include "engine/radiate/far_field.h"
#include "engine/radiate/radiate.h"
#include "engine/radiate/skin.h"
#include "tests/radiate/surface_power.h"
#include "engine/radiate/wave_solver.h"

#include <CLI/CLI.hpp>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <string>
#include <vector>

namespace ringdown {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

radiate::Body body_of(const modal::Bank& bank) {
  radiate::Body body;
  body.surface.nodes.resize(static_cast<Eigen::Index>(bank.point_count()), 3);
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (int c = 0; c < 3; ++c) body.surface.nodes(static_cast<Eigen::Index>(p), c) = bank.positions[p][c];
  }
  body.surface.triangles.resize(static_cast<Eigen::Index>(bank.triangles.size()), 3);
  for (std::size_t t = 0; t < bank.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      body.surface.triangles(static_cast<Eigen::Index>(t), c) = static_cast<std::int32_t>(bank.triangles[t][c]);
    }
  }
  std::vector<Eigen::MatrixX3d> shapes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    Eigen::MatrixX3d shape(bank.point_count(), 3);
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      for (int c = 0; c < 3; ++c) shape(static_cast<Eigen::Index>(p), c) = bank.shape(m, p)[c];
    }
    shapes.push_back(shape);
  }
  body.flow = radiate::flow_of(body.surface, shapes, 0.003);
  body.frequency_hz = bank.frequency_hz;
  return body;
}

void print(const std::string& name, const modal::Bank& bank, const radiate::Radiation& radiation, double processor_s,
           double wall_s) {
  std::vector<double> errors;
  int missed = 0;
  for (const auto& mode : radiation.modes) {
    errors.push_back(mode.error_db);
    missed += mode.reason.empty() ? 0 : 1;
  }
  std::sort(errors.begin(), errors.end());
  const auto packed = modal::pack(radiation.maps);
  std::printf("%s,%zu,%.0f,%d,%d,%d,%.1f,%.1f,%zu,%.4f,%.3f,%.3f,%d\n", name.c_str(), bank.mode_count(),
              *std::max_element(bank.frequency_hz.begin(), bank.frequency_hz.end()), radiation.mirrors,
              radiation.largest_unknowns, radiation.eliminations, processor_s, wall_s, packed.bytes.size(),
              packed.largest_error, errors[errors.size() / 2], errors.back(), missed);
  std::fflush(stdout);
}

void print_modes(const modal::Bank& bank, const radiate::Radiation& radiation) {
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const auto& mode = radiation.modes[m];
    std::printf("#,%.1f,%.2f,%.5f,%.4f,%.3f,%.3f,%zu,%s\n", bank.frequency_hz[m], mode.relative_db, mode.decay_per_s,
                bank.decay_per_s[m], mode.source_db, mode.coarser_db, radiation.maps.modes[m].terms.size(),
                mode.reason.c_str());
  }
}

radiate::Body with_modes(const radiate::Body& body, const std::vector<int>& modes) {
  radiate::Body part{.surface = body.surface, .flow = body.flow, .frequency_hz = {}};
  part.flow.flow.resize(body.flow.flow.rows(), static_cast<Eigen::Index>(modes.size()));
  for (std::size_t i = 0; i < modes.size(); ++i) {
    part.flow.flow.col(static_cast<Eigen::Index>(i)) = body.flow.flow.col(modes[i]);
    part.frequency_hz.push_back(body.frequency_hz[modes[i]]);
  }
  return part;
}

void print_errors(const char* way, double setting, int unknowns, double seconds, std::vector<double> errors_db) {
  std::sort(errors_db.begin(), errors_db.end());
  std::printf("%s,%.1f,%d,%.1f,%.3f,%.3f\n", way, setting, unknowns, seconds, errors_db[errors_db.size() / 2],
              errors_db.back());
  std::fflush(stdout);
}

struct Solved {
  double rms = 0;
  Eigen::MatrixXcd layer;
  std::vector<double> coupling;
};

// One mode by elimination on a skin.
Solved solve_one(const radiate::Body& body, const radiate::Skin& skin, int mode, double k) {
  const Eigen::Vector3d origin = body.surface.nodes.colwise().mean().transpose();
  const double radius = (body.surface.nodes.rowwise() - origin.transpose()).rowwise().norm().maxCoeff();
  radiate::ComplexMatrix matrix;
  Solved solved{.coupling = radiate::coupling_of(skin, k)};
  radiate::wave_matrix(skin.panels, 0, skin.near[0], k, solved.coupling, matrix);
  solved.layer =
      radiate::LuFactors(matrix).solve(skin.flow[0].col(mode).cast<std::complex<float>>()).cast<std::complex<double>>();
  const auto directions = radiate::directions_for(radiate::degree_for(k, radius));
  const Eigen::MatrixXcd field = radiate::far_fields(skin.panels, origin, k, solved.coupling, directions, solved.layer);
  solved.rms = std::sqrt(directions.weights.dot(field.col(0).cwiseAbs2()) / (4 * std::numbers::pi));
  return solved;
}

double wavenumber_of(double frequency_hz) { return 2 * std::numbers::pi * frequency_hz / modal::Air{}.sound_speed_m_s; }

// One surface for all modes, fine enough for the highest; for each mode the matrix at its wavenumber, eliminated.
// Solved for the sample of modes alone; the time of all modes is that of one times their number.
void print_obvious(const radiate::Body& body, const std::vector<int>& sample, const std::vector<double>& exact_rms,
                   double panels_per_wave) {
  const double highest = wavenumber_of(*std::max_element(body.frequency_hz.begin(), body.frequency_hz.end()));
  const double start = processor_seconds();
  const auto original = radiate::Original::of(body);
  const auto skin = radiate::skin_of(*original, 2 * std::numbers::pi / (highest * panels_per_wave));
  const double shared = processor_seconds() - start;
  std::vector<double> errors_db;
  const double begin = processor_seconds();
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double rms = solve_one(body, *skin, sample[i], wavenumber_of(body.frequency_hz[sample[i]])).rms;
    errors_db.push_back(std::abs(20 * std::log10(rms / exact_rms[i])));
  }
  const double each = (processor_seconds() - begin) / static_cast<double>(sample.size());
  print_errors("obvious", panels_per_wave, skin->panels.node_count(),
               shared + each * static_cast<double>(body.frequency_hz.size()), errors_db);
}

// Each mode of the sample on a skin of 600 to 2,000 nodes by its wavelength.
void print_surface_powers(const radiate::Body& body, const std::vector<int>& sample) {
  const modal::Air air;
  const auto original = radiate::Original::of(body);
  std::printf("hz,unknowns,far_w,surface_db,share\n");
  for (const int mode : sample) {
    const double k = wavenumber_of(body.frequency_hz[mode]), area = original->panels->area();
    const auto side = [&](double nodes) { return std::sqrt(area / nodes * 2 / std::sqrt(3.0)); };
    const auto skin = radiate::skin_of(*original, std::clamp(2 * std::numbers::pi / (4 * k), side(2000), side(600)));
    const Solved solved = solve_one(body, *skin, mode, k);
    const Eigen::MatrixXd flow = radiate::triangle_flow(skin->panels, original->body->flow).col(mode);
    const auto surface = radiate::surface_power(skin->panels, k, solved.coupling, solved.layer, flow, air)[0];
    const double far_w = modal::radiated_power(solved.rms, k * air.sound_speed_m_s, air);
    std::printf("%.1f,%d,%.3g,%.3f,%.4f\n", body.frequency_hz[mode], skin->panels.node_count(), far_w,
                10 * std::log10(surface.power_w / far_w), surface.share);
    std::fflush(stdout);
  }
}

// How far the default's levels at other wavenumbers are from those of skins with twice as many triangles in a wave.
void print_levels(const std::string& name, const radiate::Body& body) {
  const auto usual = radiate::solve(body, {}, {.threads = 1});
  const auto finer = radiate::solve(body, {}, {.threads = 1, .panels_per_wave = 6, .panels_per_shape = 12});
  if (!usual || !finer) return;
  std::vector<double> errors_db;
  for (std::size_t m = 0; m < body.frequency_hz.size(); ++m) {
    const auto &levels = usual->maps.modes[m].levels, &others = finer->maps.modes[m].levels;
    for (std::size_t l = 0; l < std::min(levels.size(), others.size()); ++l) {
      const bool own = levels[l].wavenumber_rad_m == static_cast<float>(usual->maps.modes[m].wavenumber_rad_m);
      if (!own) errors_db.push_back(std::abs(20 * std::log10(levels[l].rms / others[l].rms)));
    }
  }
  std::sort(errors_db.begin(), errors_db.end());
  const auto at = [&](double share) { return errors_db[static_cast<std::size_t>(share * (errors_db.size() - 1))]; };
  std::printf("%s,%zu,%.3f,%.3f,%.3f\n", name.c_str(), errors_db.size(), at(0.5), at(0.95), at(1));
  std::fflush(stdout);
}

// Errors of a sample of the modes, beside the finest solution, against the processor time that all modes take.
int compare(const radiate::Body& body, const std::vector<int>& sample) {
  const auto finest = radiate::solve(with_modes(body, sample), {},
                                     {.threads = 1, .panels_per_wave = 6, .max_unknowns = 8000, .range_octaves = 0});
  if (!finest) {
    std::fprintf(stderr, "%s\n", finest.error().message.c_str());
    return 1;
  }
  std::vector<double> exact_rms;
  for (const auto& field : finest->maps.modes) exact_rms.push_back(modal::rms(field));
  std::printf("way,setting,unknowns,processor_s,median_db,worst_db\n");
  for (const int max : {1000, 2000, 4000, 8000}) {
    const double start = processor_seconds();
    const auto ours = radiate::solve(body, {}, {.threads = 1, .max_unknowns = max, .range_octaves = 0});
    const double seconds = processor_seconds() - start;
    if (!ours) continue;
    std::vector<double> errors_db;
    for (std::size_t i = 0; i < sample.size(); ++i) {
      errors_db.push_back(std::abs(20 * std::log10(modal::rms(ours->maps.modes[sample[i]]) / exact_rms[i])));
    }
    print_errors("ours", max, ours->largest_unknowns, seconds, errors_db);
  }
  for (const double panels_per_wave : {2.5, 3.5, 5.0, 6.0}) print_obvious(body, sample, exact_rms, panels_per_wave);
  return 0;
}

double peak_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

// The first mode as if it rang so high that a skin of so many nodes is needed. Sizes ascend, because the peak of memory
// is that of the process so far.
int print_growth(const radiate::Body& body, int max_nodes) {
  const auto original = radiate::Original::of(body);
  std::printf("nodes,processor_s,peak_mib\n");
  for (int nodes = 500; nodes <= max_nodes; nodes *= 2) {
    radiate::Options options{.threads = 1, .max_unknowns = nodes, .symmetry = false, .range_octaves = 0};
    const double side_m = std::sqrt(original->panels->area() / nodes * 2 / std::sqrt(3.0));
    radiate::Body high = with_modes(body, {0});
    high.frequency_hz[0] = modal::Air{}.sound_speed_m_s / (options.panels_per_wave * side_m);
    const double start = processor_seconds();
    const auto radiation = radiate::solve(high, {}, options);
    if (!radiation) {
      std::fprintf(stderr, "%d nodes: %s\n", nodes, radiation.error().message.c_str());
      return 1;
    }
    std::printf("%d,%.2f,%.0f\n", radiation->largest_unknowns, processor_seconds() - start, peak_mib());
    std::fflush(stdout);
  }
  return 0;
}

std::vector<int> sample_of(const radiate::Body& body, int size) {
  std::vector<int> sample;
  const auto modes = static_cast<int>(body.frequency_hz.size());
  size = std::min(size, modes);
  for (int i = 0; i < size; ++i) sample.push_back((2 * i + 1) * modes / (2 * size));
  return sample;
}

int run(int count, char** arguments) {
  CLI::App app("Radiation of banks: processor time, sizes and stated errors, as CSV on the standard output");
  std::vector<std::string> paths;
  bool modes = false;
  radiate::Options options{.threads = 1};
  app.add_option("bank", paths, "banks, .glb")->required();
  app.add_flag(
      "--modes", modes,
      "a line for each mode, too: #, Hz, dB beside a pulsating sphere, decay by radiation and the bank's [1/s], the "
      "error of a source inside and the change from a coarser surface [dB], terms of the map");
  app.add_option("--panels-per-wave", options.panels_per_wave, "sides of triangles in a wavelength");
  app.add_option("--max-unknowns", options.max_unknowns, "nodes of the finest surface without mirror planes");
  bool whole = false;
  app.add_flag("--no-symmetry", whole, "mirror planes are not used");
  app.add_option("--threads", options.threads, "threads");
  app.add_option("--range", options.range_octaves, "octaves around a mode for which levels are found");
  int sample_size = 0;
  app.add_option("--compare", sample_size,
                 "instead: error against time for the first bank, beside a dense factorization for each mode, by so "
                 "many of its modes");
  int surface_size = 0;
  bool levels = false, growth = false;
  app.add_option(
      "--surface", surface_size,
      "instead: for so many modes of the first bank the power through the surface beside that far away [dB], "
      "and which share it is of what flows back and forth");
  app.add_flag("--levels", levels,
               "instead: levels of six modes at other wavenumbers beside those of finer skins: how many, and the "
               "median, 95 % and "
               "largest difference [dB]");
  app.add_flag("--growth", growth,
               "instead: processor time and memory of one mode on skins of 500 nodes up to --max-unknowns");
  CLI11_PARSE(app, count, arguments);
  options.symmetry = !whole;
  if (sample_size > 0 || surface_size > 0 || growth) {
    const auto bank = modal::read_bank(paths.front());
    if (!bank) {
      std::fprintf(stderr, "%s\n", bank.error().message.c_str());
      return 1;
    }
    const radiate::Body body = body_of(*bank);
    if (growth) return print_growth(body, options.max_unknowns);
    if (sample_size > 0) return compare(body, sample_of(body, sample_size));
    print_surface_powers(body, sample_of(body, surface_size));
    return 0;
  }
  if (levels) std::printf("bank,levels,median_db,max_db,worst_db\n");
  if (!levels)
    std::printf(
        "bank,modes,highest_hz,mirrors,unknowns,eliminations,processor_s,wall_s,packed_bytes,packing_error,median_"
        "error_db,"
        "worst_error_db,missed\n");
  for (const std::string& path : paths) {
    const auto bank = modal::read_bank(path);
    if (!bank) {
      std::fprintf(stderr, "%s\n", bank.error().message.c_str());
      return 1;
    }
    if (levels) {
      const radiate::Body body = body_of(*bank);
      print_levels(path.substr(path.rfind('/') + 1), with_modes(body, sample_of(body, 6)));
      continue;
    }
    const double before = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    const radiate::Body body = body_of(*bank);
    const auto radiation = radiate::solve(body, {}, options);
    if (!radiation) {
      std::fprintf(stderr, "%s: %s\n", path.c_str(), radiation.error().message.c_str());
      continue;
    }
    const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print(path.substr(path.rfind('/') + 1), *bank, *radiation, processor_seconds() - before, wall_s);
    if (modes) print_modes(*bank, *radiation);
  }
  return 0;
}

}  // namespace
}  // namespace ringdown

int main(int count, char** arguments) { return ringdown::run(count, arguments); }
