// What is drawn over the panes: notes on the scene, the help of F1, and the bars that resize panes. [UI]
#pragma once

#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/link/known_scene.h"
#include "clients/viewer/panels/skin.h"

#include <optional>

namespace ringdown::viewer {

// Notes over the scene pane, which lies at `origin`: the scene's name and time, and, without a daemon, what to do about
// that. `shown_at_s` is the scene time on display; nothing: the time that the daemon reports.
void draw_notes(const Skin& skin, ImVec2 origin, ImVec2 size, const KnownScene& scene, const ConnectionState& state,
                std::optional<double> shown_at_s);

// All keys, by pane, over everything else. Returns false when the user closes the help.
bool draw_help(const Skin& skin);

// A bar at `x` between two panes, which the mouse drags. Changes `share`, a share of the window's width; `direction` is
// +1 if that share belongs to the pane at the left of the bar, -1 if to the pane at the right.
void draw_splitter(const char* name, float x, double direction, double& share);

}  // namespace ringdown::viewer
