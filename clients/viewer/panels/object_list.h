// The list of objects, each with its solo and mute. [UI]
#pragma once

#include "clients/viewer/commands.h"
#include "clients/viewer/link/model.h"
#include "clients/viewer/panels/skin.h"

namespace ringdown::viewer {

// Fills the rest of the line, up to eight rows. A click on a name chooses the object; S solos it, M mutes it.
void draw_object_list(const Skin& skin, const Model& model, Commands& commands);

}  // namespace ringdown::viewer
