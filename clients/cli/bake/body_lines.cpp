#include "clients/cli/bake/body_lines.h"

#include <cstdio>

namespace ringdown::cli {

void print_body(const bake::BakedObject& object) {
  std::printf("  %s\n", mesh::text_of(object.making).c_str());
  for (const std::string& note : object.notes) std::printf("    %s\n", note.c_str());
  const mesh::CheckedMesh& checked = object.mesh;
  if (checked.pieces > 1) std::printf("  %d pieces that share no node\n", checked.pieces);
  if (checked.flipped + checked.duplicates + checked.unused_nodes > 0) {
    std::printf("  repaired: %d elements were inside out, %d were there twice; %d nodes belonged to none\n",
                checked.flipped, checked.duplicates, checked.unused_nodes);
  }
  if (checked.straightened > 0) {
    std::printf("  %d curved elements folded and were straightened; a smaller mesh size avoids that\n",
                checked.straightened);
  }
  if (!object.question.empty())
    std::fprintf(stderr, "ringdown-bake: is this size meant? %s\n", object.question.c_str());
}

}  // namespace ringdown::cli
