#include "engine/bake/laboratory/mode_files.h"

#include "engine/bake/laboratory/numpy_archive.h"
#include "engine/base/base64.h"
#include "engine/base/file_format.h"
#include "engine/base/output_file.h"
#include "engine/base/quote.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace ringdown::bake {
namespace {

static_assert(std::endian::native == std::endian::little, "files of numbers are written as they lie in memory");

double undamped_hz(const modal::Bank& bank, std::size_t m) {
  return modal::rad_per_s_to_hz(std::sqrt(modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]})));
}

template <class... Numbers>
void print(std::string& text, const char* pattern, Numbers... numbers) {
  std::array<char, 256> line{};
  const int length = std::snprintf(line.data(), line.size(), pattern, numbers...);
  text.append(line.data(), static_cast<std::size_t>(std::clamp(length, 0, 255)));
}

std::string mode_name(const modal::Bank& bank, std::size_t m) {
  std::string name;
  print(name, "mode %04zu, %.3f Hz", m, bank.frequency_hz[m]);
  return name;
}

// One array of a .vtu: its size in bytes and its bytes, in base64.
template <class Number>
void add_vtk_array(std::string& text, const char* type, const std::string& name, int components, const Number* numbers,
                   std::size_t count) {
  const std::uint64_t size = count * sizeof(Number);
  std::string bytes(reinterpret_cast<const char*>(&size), sizeof size);
  bytes.append(reinterpret_cast<const char*>(numbers), size);
  print(text, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"binary\">", type, name.c_str(),
        components);
  text += to_base64(bytes) + "</DataArray>\n";
}

std::string vtk_file(const modal::Bank& bank, const SolvedBody& body) {
  const mesh::Indices parts = linear_parts(body.mesh);
  const auto nodes = static_cast<std::size_t>(body.mesh.nodes.rows()), cells = static_cast<std::size_t>(parts.rows());
  std::vector<std::int64_t> offsets(cells);
  for (std::size_t c = 0; c < cells; ++c) offsets[c] = static_cast<std::int64_t>(4 * c + 4);
  const std::vector<std::uint8_t> types(cells, 10);  // VTK_TETRA
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  print(text, "<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n<Points>\n", nodes, cells);
  add_vtk_array(text, "Float64", "points", 3, body.mesh.nodes.data(), 3 * nodes);
  text += "</Points>\n<Cells>\n";
  add_vtk_array(text, "Int32", "connectivity", 1, parts.data(), 4 * cells);
  add_vtk_array(text, "Int64", "offsets", 1, offsets.data(), cells);
  add_vtk_array(text, "UInt8", "types", 1, types.data(), cells);
  text += "</Cells>\n<PointData>\n";
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const Eigen::VectorXf shape = body.shapes.col(static_cast<Eigen::Index>(m)).cast<float>();
    add_vtk_array(text, "Float32", mode_name(bank, m), 3, shape.data(), 3 * nodes);
  }
  return text + "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

constexpr const char* kMark = "    -1\n";

std::string universal_file(const modal::Bank& bank, const SolvedBody& body) {
  constexpr int kSi = 1, kLinearTet = 111, kNormalMode = 2, kTranslations = 2, kDisplacement = 8, kReal = 2;
  std::string text = kMark;
  print(text, "%6d\n%10d%-20s%10d\n", 164, kSi, "SI: Meter (newton)", 2);
  print(text, "%25.17E%25.17E%25.17E\n%25.17E\n", 1.0, 1.0, 1.0, 273.15);
  print(text, "%s%s%6d\n", kMark, kMark, 2411);
  for (Eigen::Index n = 0; n < body.mesh.nodes.rows(); ++n) {
    print(text, "%10d%10d%10d%10d\n", static_cast<int>(n + 1), 1, 1, 11);
    const auto at = body.mesh.nodes.row(n);
    print(text, "%25.16E%25.16E%25.16E\n", at[0], at[1], at[2]);
  }
  print(text, "%s%s%6d\n", kMark, kMark, 2412);
  const mesh::Indices parts = linear_parts(body.mesh);
  for (Eigen::Index e = 0; e < parts.rows(); ++e) {
    print(text, "%10d%10d%10d%10d%10d%10d\n", static_cast<int>(e + 1), kLinearTet, 1, 1, 7, 4);
    print(text, "%10d%10d%10d%10d\n", parts(e, 0) + 1, parts(e, 1) + 1, parts(e, 2) + 1, parts(e, 3) + 1);
  }
  text += kMark;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    print(text, "%s%6d\n%.70s\nshape of a mode, normalised by mass [kg^-1/2]\nNONE\n%s\nNONE\n", kMark, 55,
          bank.name.c_str(), mode_name(bank, m).c_str());
    print(text, "%10d%10d%10d%10d%10d%10d\n", 1, kNormalMode, kTranslations, kDisplacement, kReal, 3);
    print(text, "%10d%10d%10d%10d\n", 2, 4, 1, static_cast<int>(m + 1));
    const double hz = undamped_hz(bank, m);
    print(text, "%13.5E%13.5E%13.5E%13.5E\n", hz, 1.0, bank.decay_per_s[m] / modal::hz_to_rad_per_s(hz), 0.0);
    const auto shape = body.shapes.col(static_cast<Eigen::Index>(m));
    for (Eigen::Index n = 0; n < body.mesh.nodes.rows(); ++n) {
      print(text, "%10d\n%13.5E%13.5E%13.5E\n", static_cast<int>(n + 1), shape[3 * n], shape[3 * n + 1],
            shape[3 * n + 2]);
    }
    text += kMark;
  }
  return text;
}

Result<std::string> numpy_file(const modal::Bank& bank, const SolvedBody& body) {
  const auto nodes = static_cast<std::size_t>(body.mesh.nodes.rows());
  const auto elements = static_cast<std::size_t>(body.mesh.elements.rows());
  std::vector<double> undamped;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) undamped.push_back(undamped_hz(bank, m));
  NumpyArchive archive;
  archive.add("nodes_m", {nodes, 3}, body.mesh.nodes.data());
  archive.add("elements", {elements, static_cast<std::size_t>(body.mesh.elements.cols())}, body.mesh.elements.data());
  archive.add("frequencies_hz", {bank.mode_count()}, bank.frequency_hz.data());
  archive.add("undamped_hz", {bank.mode_count()}, undamped.data());
  archive.add("decays_per_s", {bank.mode_count()}, bank.decay_per_s.data());
  archive.add("shapes", {bank.mode_count(), nodes, 3}, body.shapes.data());
  return std::move(archive).finish();
}

// The tetrahedra of Kuhn's division of a simplex into p^3: those of the cubes' divisions that lie in it. A lattice
// point of the simplex, whose multiples of 1/p are n1, n2, n3, becomes (n1 + n2 + n3, n2 + n3, n3), and the simplex
// becomes p >= x >= y >= z >= 0.
std::vector<std::array<int, 4>> parts_of_element(int order) {
  const auto inside = [order](const std::array<int, 3>& x) {
    return order >= x[0] && x[0] >= x[1] && x[1] >= x[2] && x[2] >= 0;
  };
  const auto node_at = [order](const std::array<int, 3>& x) {
    mesh::Barycentric place(1, 4);
    place << order - x[0], x[0] - x[1], x[1] - x[2], x[2];
    return mesh::nodes_at(order, place / order)[0];
  };
  std::vector<std::array<int, 4>> parts;
  std::array<int, 3> base{};
  for (base[0] = 0; base[0] < order; ++base[0]) {
    for (base[1] = 0; base[1] < order; ++base[1]) {
      for (base[2] = 0; base[2] < order; ++base[2]) {
        std::array<int, 3> axes{0, 1, 2};
        do {
          std::array<int, 3> at = base;
          std::array<int, 4> part{};
          bool whole = inside(at);
          part[0] = whole ? node_at(at) : 0;
          for (std::size_t k = 0; k < 3; ++k) {
            ++at[axes[k]];
            whole = whole && inside(at);
            if (whole) part[k + 1] = node_at(at);
          }
          const int turns = (axes[0] > axes[1]) + (axes[0] > axes[2]) + (axes[1] > axes[2]);
          if (turns % 2 == 1) std::swap(part[2], part[3]);
          if (whole) parts.push_back(part);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  return parts;
}

}  // namespace

mesh::Indices linear_parts(const mesh::TetMesh& mesh) {
  const std::vector<std::array<int, 4>> parts = parts_of_element(mesh.order());
  mesh::Indices linear(mesh.elements.rows() * static_cast<Eigen::Index>(parts.size()), 4);
  Eigen::Index row = 0;
  for (const auto& element : mesh.elements.rowwise()) {
    for (const auto& [a, b, c, d] : parts) linear.row(row++) << element[a], element[b], element[c], element[d];
  }
  return linear;
}

Result<void> check_mode_file(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (ending == ".vtu" || ending == ".unv" || ending == ".uff" || ending == ".npz") return {};
  return fail(ErrorKind::usage, "--export-modes must end in .vtu, .unv, .uff or .npz, not " + quote(ending));
}

Result<void> write_modes(const Baked& baked, const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  const SolvedBody& body = *baked.body;
  Result<std::string> file = ending == ".vtu"   ? Result<std::string>(vtk_file(baked.bank, body))
                             : ending == ".npz" ? numpy_file(baked.bank, body)
                                                : Result<std::string>(universal_file(baked.bank, body));
  if (!file) return fail(file.error().kind, path.string() + ": " + file.error().message);
  return write_output(path, std::string_view(*file));
}

}  // namespace ringdown::bake
