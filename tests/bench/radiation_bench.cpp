// Radiation of banks: time, sizes and stated errors. CSV on the standard output.
//
//   ringdown_radiation_bench [--modes] [--panels-per-wave N] [--threads N] BANK...
#include "engine/modal/bank_file.h"
#include "engine/radiate/radiate.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
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
  std::printf("%s,%zu,%.0f,%d,%d,%.1f,%.1f,%zu,%.4f,%.3f,%.3f,%d\n", name.c_str(), bank.mode_count(),
              *std::max_element(bank.frequency_hz.begin(), bank.frequency_hz.end()), radiation.largest_unknowns,
              radiation.eliminations, processor_s, wall_s, packed.bytes.size(), packed.largest_error,
              errors[errors.size() / 2], errors.back(), missed);
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
  app.add_option("--threads", options.threads, "threads");
  app.add_option("--range", options.range_octaves, "octaves around a mode for which levels are found");
  CLI11_PARSE(app, count, arguments);
  std::printf(
      "bank,modes,highest_hz,unknowns,eliminations,processor_s,wall_s,packed_bytes,packing_error,median_error_db,"
      "worst_error_db,missed\n");
  for (const std::string& path : paths) {
    const auto bank = modal::read_bank(path);
    if (!bank) {
      std::fprintf(stderr, "%s\n", bank.error().message.c_str());
      return 1;
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
