#include "engine/bake/laboratory/matrix_files.h"

#include "engine/base/output_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace ringdown::bake {
namespace {

template <class Number>
void put(std::string& text, Number number, char after) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
  text += after;
}

// The lower triangle of a matrix that stores at least that. Each entry stands for a block of `axes` x `axes` with the
// number on its diagonal.
std::string matrix_market(const fem::SparseMatrix& matrix, int axes) {
  std::string entries;
  std::size_t count = 0;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (fem::SparseMatrix::InnerIterator it(matrix, column); it; ++it) {
      if (it.row() < column || it.value() == 0) continue;
      for (int i = 0; i < axes; ++i) {
        put(entries, axes * it.row() + i + 1, ' ');
        put(entries, axes * column + i + 1, ' ');
        put(entries, it.value(), '\n');
        ++count;
      }
    }
  }
  std::string text = "%%MatrixMarket matrix coordinate real symmetric\n";
  put(text, axes * matrix.rows(), ' ');
  put(text, axes * matrix.cols(), ' ');
  put(text, count, '\n');
  return text + entries;
}

std::string node_table(const SolvedBody& body) {
  const auto& clamped = body.equations->clamped;
  std::string text = "node,x_m,y_m,z_m,moves\n";
  for (std::int32_t n = 0; n < body.mesh.nodes.rows(); ++n) {
    put(text, n, ',');
    for (int i = 0; i < 3; ++i) put(text, body.mesh.nodes(n, i), ',');
    text += std::binary_search(clamped.begin(), clamped.end(), n) ? "0\n" : "1\n";
  }
  return text;
}

}  // namespace

Result<void> write_matrices(const SolvedBody& body, const std::string& prefix) {
  const auto& [system, springs, clamped, rigid] = *body.equations;
  const auto write = [&prefix](const char* ending, const std::string& text) {
    return write_output(prefix + ending, std::string_view(text));
  };
  if (auto written = write("-K.mtx", matrix_market(system.stiffness, 1)); !written) return written;
  if (auto written = write("-M.mtx", matrix_market(system.node_mass, 3)); !written) return written;
  if (springs.rows() > 0) {
    if (auto written = write("-H.mtx", matrix_market(springs, 1)); !written) return written;
  }
  return write("-nodes.csv", node_table(body));
}

}  // namespace ringdown::bake
