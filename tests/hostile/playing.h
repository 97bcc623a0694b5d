// The music under an attack: a gong whose modes exchange energy is struck hard, a plate is bowed, and
// balls fall in a scene. Shared by the attacks on a session and on a daemon.
#pragma once

#include "engine/base/folders.h"
#include "protocol/wire/message.h"
#include "tests/hostile/messages.h"

#include <filesystem>
#include <vector>

namespace ringdown::hostile {

// A folder that is the current one from now on, with the banks and the scene of what goes on and some files that are
// none. Messages name these files without a folder, so that the same seed makes the same messages. One in a process.
class Stage {
 public:
  Stage();
  [[nodiscard]] std::filesystem::path folder() const { return folder_.path(); }

 private:
  PrivateFolder folder_{"ringdown-hostile"};
};

// The objects and files there are.
Names names();

// Loads whatever an attacker may have taken away, and sets it going again.
std::vector<wire::Message> keep_playing();
// The next moment's messages: blows, bows and balls.
std::vector<wire::Message> play_on(Random& random);

}  // namespace ringdown::hostile
