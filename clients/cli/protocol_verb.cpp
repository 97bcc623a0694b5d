#include "clients/cli/verb.h"
#include "protocol/help.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

namespace ringdown::cli {

void add_protocol_verb(CLI::App& app, ExitCode& outcome) {
  auto as_markdown = std::make_shared<bool>(false);
  CLI::App* verb = app.add_subcommand("protocol", "Lists every OSC address with its arguments.");
  verb->add_flag("--markdown", *as_markdown, "The whole manual, as in docs/protocol.md.");
  verb->callback([as_markdown, &outcome] {
    const std::string text = *as_markdown ? protocol::markdown() : protocol::overview();
    const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    if (!written) outcome = complain("cannot write to the standard output", ExitCode::failure);
  });
}

}  // namespace ringdown::cli
