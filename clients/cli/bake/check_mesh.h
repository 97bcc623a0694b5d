// `ringdown check mesh FILE`: its report. [worker]
#pragma once

#include "protocol/exit_codes.h"

#include <filesystem>
#include <optional>
#include <string>

namespace ringdown::cli {

struct CheckRequest {
  std::filesystem::path file, output, materials;  // no output: nothing is written
  std::string material = "steel";
  std::optional<double> unit_m;
};

struct CheckOutcome {
  protocol::ExitCode exit_code = protocol::ExitCode::ok;
  std::string error;  // one sentence, for stderr; or empty
};

// Prints findings, repairs, how the body would be meshed and why so fine, on stdout. Nothing is solved.
CheckOutcome check_mesh(const CheckRequest& request);

}  // namespace ringdown::cli
