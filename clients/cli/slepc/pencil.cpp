#include "clients/cli/slepc/pencil.h"

#include "clients/cli/slepc/failure.h"

#include <functional>
#include <utility>

namespace ringdown::cli {
namespace {

using solve::ProblemFile;
using solve::ProblemHeader;
using solve::SparseRows;

struct Share {
  std::int64_t first, count;  // nodes
};

Share share_of(int rank, int processes, std::int64_t nodes) {
  const std::int64_t first = nodes * rank / processes, next = nodes * (rank + 1) / processes;
  return {first, next - first};
}

template <class T>
void send(const std::vector<T>& values, int to) {
  MPI_Send(values.data(), static_cast<int>(values.size() * sizeof(T) / 4), MPI_INT32_T, to, 0, PETSC_COMM_WORLD);
}

template <class T>
void receive(std::vector<T>& values) {
  MPI_Status status;
  int words = 0;
  MPI_Probe(0, 0, PETSC_COMM_WORLD, &status);
  MPI_Get_count(&status, MPI_INT32_T, &words);
  values.resize(static_cast<std::size_t>(words) * 4 / sizeof(T));
  MPI_Recv(values.data(), words, MPI_INT32_T, 0, 0, PETSC_COMM_WORLD, MPI_STATUS_IGNORE);
}

// The rows of this process. `read` gives those of a share, in the first process only.
SparseRows scatter(std::int64_t nodes, const std::function<Result<SparseRows>(Share)>& read) {
  int rank = 0, processes = 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &processes);
  SparseRows own;
  if (rank > 0) {
    receive(own.starts), receive(own.columns), receive(own.values);
    return own;
  }
  for (int to = processes - 1; to >= 0; --to) {
    Result<SparseRows> rows = read(share_of(to, processes, nodes));
    if (!rows) give_up(rows.error().message);
    constexpr std::size_t kMaxEntries = std::size_t{1} << 30;  // of one message
    if (rows->values.size() >= kMaxEntries) give_up("the mesh is too large for so few processes; use more");
    if (to == 0) return std::move(*rows);
    send(rows->starts, to), send(rows->columns, to), send(rows->values, to);
  }
  return own;
}

Mat matrix_of(const SparseRows& rows) {
  const std::vector<PetscInt> starts(rows.starts.begin(), rows.starts.end());
  const auto count = static_cast<PetscInt>(starts.size()) - 1;
  Mat matrix = nullptr;
  check(MatCreate(PETSC_COMM_WORLD, &matrix));
  check(MatSetSizes(matrix, count, count, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix, MATAIJ));  // one of the two below, the other call does nothing
  check(MatSeqAIJSetPreallocationCSR(matrix, starts.data(), rows.columns.data(), rows.values.data()));
  check(MatMPIAIJSetPreallocationCSR(matrix, starts.data(), rows.columns.data(), rows.values.data()));
  check(MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatSetOption(matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  return matrix;
}

// kron(rows, I3)
SparseRows three_times(const SparseRows& rows) {
  SparseRows all;
  all.starts.push_back(0);
  all.columns.reserve(3 * rows.columns.size());
  all.values.reserve(3 * rows.values.size());
  for (std::size_t r = 0; r + 1 < rows.starts.size(); ++r) {
    for (int i = 0; i < 3; ++i) {
      for (std::int64_t e = rows.starts[r]; e < rows.starts[r + 1]; ++e) {
        all.columns.push_back(3 * rows.columns[static_cast<std::size_t>(e)] + i);
        all.values.push_back(rows.values[static_cast<std::size_t>(e)]);
      }
      all.starts.push_back(static_cast<std::int64_t>(all.values.size()));
    }
  }
  return all;
}

}  // namespace

Pencil read_pencil(const char* path) {
  static_assert(sizeof(PetscInt) == 4, "PETSc with 32-bit indices is expected");
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  Result<ProblemFile> file = rank == 0 ? ProblemFile::open(path) : fail(ErrorKind::refused, "not the first process");
  if (rank == 0 && !file) give_up(file.error().message);

  Pencil pencil;
  ProblemHeader& header = pencil.header;
  if (file) header = file->header();
  MPI_Bcast(&header, sizeof header, MPI_BYTE, 0, PETSC_COMM_WORLD);
  SparseRows stiffness =
      scatter(header.nodes, [&](Share share) { return file->stiffness_rows(3 * share.first, 3 * share.count); });
  for (double& value : stiffness.values) value /= header.highest_lambda;
  pencil.stiffness = matrix_of(stiffness);
  stiffness = {};
  pencil.mass = matrix_of(
      three_times(scatter(header.nodes, [&](Share share) { return file->mass_rows(share.first, share.count); })));
  return pencil;
}

}  // namespace ringdown::cli
