#include "clients/cli/fit/baker.h"

#include "engine/base/folders.h"
#include "engine/base/formatted.h"
#include "engine/base/process/child_process.h"
#include "engine/modal/bank_file.h"

#include <unistd.h>
#include <utility>

namespace ringdown::cli {

Work::Work(double all)
    : all_(all),
      line_("ringdown-compare", isatty(STDERR_FILENO) == 1 ? ProgressLine::Style::bar : ProgressLine::Style::none) {}

void Work::begin(const std::string& stage, double share) {
  line_.show(stage, done_ / all_);
  done_ += share;
}

std::vector<std::string> Figure::as_option() const {
  if (name == "wall_scale") return {"--wall-scale", formatted("{:.9g}", value)};
  const bool of_material = is_modulus() || name.starts_with("poisson_ratio");
  return {of_material ? "--set-material" : "--set", formatted("{}={:.9g}", name, value)};
}

Baker::Baker(BakeRequest request, std::filesystem::path folder, std::stop_token stop, Work& work)
    : request_(std::move(request)), folder_(std::move(folder)), stop_(std::move(stop)), work_(work) {}

Result<modal::Bank> Baker::bake_quickly(const std::vector<Figure>& figures) {
  std::string stage = "baking";
  for (const Figure& figure : figures) stage += formatted(" {} {:.4g}", figure.name, figure.value);
  work_.begin(stage, 1);
  Result<modal::Bank> bank = bake(figures, {"--element", "tet10", "--set-material", "expansion_per_k=0"});
  if (!bank) return bank;
  for (std::size_t m = 0; m < bank->frequency_error.size(); ++m) bank->frequency_hz[m] *= 1 - bank->frequency_error[m];
  return bank;
}

Result<modal::Bank> Baker::bake_finely(const std::vector<Figure>& figures) {
  work_.begin("baking exactly", kFineShare);
  return bake(figures, {"--set-material", "expansion_per_k=0"});
}

Result<modal::Bank> Baker::bake_well(const std::vector<Figure>& figures) {
  work_.begin("baking at last", kWellShare);
  return bake(figures, {});
}

Result<modal::Bank> Baker::bake(const std::vector<Figure>& figures, const std::vector<std::string>& options) {
  const Result<std::filesystem::path> program = find_beside("ringdown-bake");
  if (!program) return fail(program);
  const std::filesystem::path to = folder_ / "baked.glb";
  ChildRequest child{.command = {program->string(), request_.shape.string(), "-o", to.string(), "--quiet", "--band",
                                 "20", formatted("{:f}", request_.top_hz)},
                     .keep_going = [this] { return !stop_.stop_requested(); }};
  child.command.insert(child.command.end(), options.begin(), options.end());
  const auto add = [&child](const std::string& option, const std::string& value) {
    child.command.insert(child.command.end(), {option, value});
  };
  if (!request_.material.empty()) add("--material", request_.material);
  if (!request_.materials.empty()) add("--materials", request_.materials.string());
  for (const Figure& figure : figures) {
    const std::vector<std::string> option = figure.as_option();
    child.command.insert(child.command.end(), option.begin(), option.end());
  }
  if (!request_.shapes) add("--points", "1048576");  // all: thinning them takes as long as the modes
  const Result<ChildOutcome> done = run_child(child);
  if (!done) return fail(done);
  if (done->stopped) return fail(ErrorKind::cancelled, "cancelled; nothing was written");
  if (done->exit_code != 0) return fail(ErrorKind::bad_input, last_line(done->errors));
  return modal::read_bank(to);
}

}  // namespace ringdown::cli
