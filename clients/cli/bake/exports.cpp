#include "clients/cli/bake/exports.h"

#include "engine/bake/laboratory/matrix_files.h"
#include "engine/bake/laboratory/mode_files.h"
#include "engine/bake/laboratory/residual_of.h"
#include "engine/base/file_format.h"
#include "engine/base/quote.h"
#include "packaging/manual/command_line.h"

namespace ringdown::cli {

void Exports::add_to(manual::App& app) {
  app.add_option(
         "--export-modes", modes,
         "also write the mesh and the modes at all its nodes: .vtu for ParaView, .unv or .uff for modal analysis, "
         ".npz for numpy; may be given more than once")
      ->type_name("FILE")
      ->allow_extra_args(false);
  app.add_option("--export-matrices", matrices,
                 "also write stiffness and mass as Matrix Market: PREFIX-K.mtx, PREFIX-M.mtx, springs of supports as "
                 "PREFIX-H.mtx, and the nodes as PREFIX-nodes.csv")
      ->type_name("PREFIX");
  app.add_option("--export-residual", residual,
                 "also write how the modes that are not in the bank answer slow forces (.npy), for `ringdown frf` and "
                 "Python's Bank.frf; takes two solutions for each sample point and axis")
      ->type_name("FILE");
}

Result<void> Exports::check() const {
  if (!residual.empty() && ending_of(residual) != ".npy")
    return fail(ErrorKind::usage, "--export-residual must end in .npy, not " + quote(ending_of(residual)));
  for (const std::filesystem::path& file : modes) {
    if (auto good = bake::check_mode_file(file); !good) return good;
  }
  return {};
}

void Exports::ask_for(bake::BakeOptions& options) const {
  if (none()) return;
  options.interior = true;
  options.equations = !matrices.empty() || !residual.empty();
}

Result<void> Exports::write(const bake::Baked& baked, const Progress& progress) const {
  if (!matrices.empty() && !baked.bank.provenance.liquids.empty())
    return fail(ErrorKind::refused,
                "--export-matrices: the modes of a body with a liquid are not those of its own matrices; leave [fill] "
                "and [bath] out");
  for (const std::filesystem::path& file : modes) {
    if (auto written = bake::write_modes(baked, file); !written) return written;
  }
  if (!matrices.empty()) {
    if (auto written = bake::write_matrices(*baked.body, matrices); !written) return written;
  }
  if (residual.empty()) return {};
  const Result<modal::Residual> found = bake::residual_of(baked, progress);
  if (!found) return fail(found);
  return modal::write_residual(*found, residual);
}

}  // namespace ringdown::cli
