// ringdown-mesher: reads and meshes one file for another program, which trusts neither the file nor this process.
//
//   ringdown-mesher FILE
//
// mesh::BodyReader runs it and asks it questions over its standard input and output
// (engine/base/process/helper_process.h, engine/mesh/body.h). Its exit codes are ok, usage and kHelperOutOfMemory.
#include "engine/base/process/helper_process.h"
#include "engine/base/process/sandbox.h"
#include "engine/mesh/body_maker.h"
#include "engine/mesh/body_reader.h"

#include <cstdio>
#include <new>
#include <unistd.h>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

// The file's folder, and the file itself, which may be a link that leads out of it.
std::vector<fs::path> readable_for(const fs::path& file) {
  std::error_code error;
  return {fs::absolute(file).parent_path(), fs::canonical(file, error)};
}

template <class Answer>
std::string bytes_of(const Result<Answer>& answer) {
  return answer ? mesh::kGood + mesh::packed(*answer) : mesh::kBad + mesh::packed(answer.error());
}

std::string answer_to(mesh::BodyMaker& maker, const std::string& request, const HelperPipe& pipe) {
  mesh::Question question{};
  mesh::GmshOptions options;
  if (!unpack_question(request, question, options)) return "";
  if (question == mesh::Question::kSketch) return bytes_of(maker.sketch(options));
  if (question == mesh::Question::kBody) {
    return bytes_of(maker.make(options, [&pipe](std::string_view stage, double fraction) {
      pipe.report(stage, fraction);
      return true;
    }));
  }
  const Result<const mesh::PreparedSurface*> surface = maker.surface(options);
  return surface ? mesh::kGood + mesh::packed(**surface) : mesh::kBad + mesh::packed(surface.error());
}

void serve(const fs::path& file) {
  const HelperPipe pipe;
  std::string request;
  const SandboxState can = sandbox_of_kernel(), is = close_sandbox(readable_for(file));
  if (is.files != can.files || is.calls != can.calls) {  // nothing is read outside of a sandbox that could be closed
    const Error error{ErrorKind::refused, "cannot read " + file.string() + ": its reader could not close its sandbox"};
    if (pipe.next(request)) pipe.answer(mesh::kBad + mesh::packed(error));
    return;
  }
  mesh::BodyMaker maker(file);
  while (pipe.next(request)) pipe.answer(answer_to(maker, request, pipe));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || ::isatty(STDIN_FILENO)) {
    std::fputs("ringdown-mesher reads a mesh file for ringdown-bake, ringdown-check and ringdown-tune, which run it\n",
               stderr);
    return 2;
  }
  std::set_new_handler([] { ::_exit(kHelperOutOfMemory); });
  serve(argv[1]);
  ::_exit(0);  // without what libraries do at the end
}
