#include "tests/bench/modal/calculix.h"

#include "engine/base/folders.h"
#include "engine/base/process/child_process.h"
#include "engine/mesh/tet_element.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

namespace ringdown::bench {
namespace {

namespace fs = std::filesystem;

// Fields of a deck are read from at most 20 characters. Node order of C3D10 is ours.
bool write_deck(const fs::path& path, const mesh::TetMesh& mesh, const fem::Elastic& elastic, int modes) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"), std::fclose);
  if (!file) return false;
  std::fputs("*NODE\n", file.get());
  for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n) {
    std::fprintf(file.get(), "%td,%.12e,%.12e,%.12e\n", n + 1, mesh.nodes(n, 0), mesh.nodes(n, 1), mesh.nodes(n, 2));
  }
  std::fputs("*ELEMENT,TYPE=C3D10,ELSET=BODY\n", file.get());
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    std::fprintf(file.get(), "%td", e + 1);
    for (int a = 0; a < 10; ++a) std::fprintf(file.get(), ",%d", mesh.elements(e, a) + 1);
    std::fputs("\n", file.get());
  }
  std::fprintf(file.get(),
               "*MATERIAL,NAME=STUFF\n*ELASTIC\n%.12e,%.12e\n*DENSITY\n%.12e\n"
               "*SOLID SECTION,ELSET=BODY,MATERIAL=STUFF\n*STEP\n*FREQUENCY\n%d\n*END STEP\n",
               elastic.youngs_modulus_pa, elastic.poisson_ratio, elastic.density_kg_m3, modes);
  return std::ferror(file.get()) == 0;
}

// Lines "mode lambda omega hertz imaginary" until the next table begins.
std::vector<double> read_table(const fs::path& path) {
  std::vector<double> hz;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::array<double, 4> values{};
    long mode = 0;
    const bool row = static_cast<bool>(words >> mode >> values[0] >> values[1] >> values[2] >> values[3]);
    if (row && mode == static_cast<long>(hz.size()) + 1) hz.push_back(values[2]);
    if (row && mode < static_cast<long>(hz.size())) break;
    if (!hz.empty() && line.find("P A R T I C I P A T I O N") != std::string::npos) break;
  }
  return hz;
}

}  // namespace

fem::SparseMatrix calculix_mass(const mesh::TetMesh& mesh, double density_kg_m3) {
  Eigen::Matrix<double, 10, 10> of_unit_volume = Eigen::Matrix<double, 10, 10>::Zero();
  for (const mesh::QuadraturePoint& point : mesh::tet_quadrature(2)) {
    const Eigen::VectorXd shape = mesh::interpolation(2, point.barycentric);
    of_unit_volume += point.weight * shape * shape.transpose();
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const double volume = mesh::jacobian(mesh::corners_of(mesh, e)).determinant() / 6;
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b < 10; ++b) {
        entries.emplace_back(mesh.elements(e, a), mesh.elements(e, b), density_kg_m3 * volume * of_unit_volume(a, b));
      }
    }
  }
  fem::SparseMatrix mass(mesh.nodes.rows(), mesh.nodes.rows());
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

Result<CalculixRun> run_calculix(const mesh::TetMesh& mesh, const fem::Elastic& elastic, int modes, double limit_s) {
  const PrivateFolder folder("ringdown-ccx");
  if (folder.path().empty() || !write_deck(folder.path() / "body.inp", mesh, elastic, modes)) {
    return fail(ErrorKind::input_output, "cannot write CalculiX's input below " + fs::temp_directory_path().string());
  }
  std::string said;
  const auto run = run_child({.command = {"ccx", "body"},
                              .environment = {{"OMP_NUM_THREADS", "1"}, {"OPENBLAS_NUM_THREADS", "1"}},
                              .folder = folder.path(),
                              .limit_s = limit_s,
                              .on_line = [&](std::string_view line) { said.append(line).append("\n"); }});
  if (!run) return fail(run.error());
  if (run->out_of_time) return fail(ErrorKind::refused, "CalculiX took longer than its limit");
  CalculixRun done{read_table(folder.path() / "body.dat"), run->seconds, run->processor_s, run->peak_mib};
  std::sort(done.frequencies_hz.begin(), done.frequencies_hz.end());
  if (run->exit_code != 0 || done.frequencies_hz.size() < static_cast<std::size_t>(modes)) {
    return fail(ErrorKind::refused, "CalculiX found " + std::to_string(done.frequencies_hz.size()) +
                                        " modes and ended with exit code " + std::to_string(run->exit_code) + ": " +
                                        last_line(said));
  }
  return done;
}

}  // namespace ringdown::bench
