// The constants that docs/reference/settings.md lists under "Limits in the source" against their values.
#include "clients/viewer/edits.h"
#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/link/model.h"
#include "engine/base/object_name.h"
#include "engine/base/toml_table.h"
#include "engine/gltf/glb.h"
#include "engine/microtuning/played_tuning.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/contact/lasting_events.h"
#include "engine/scene/ode/contact_joints.h"
#include "engine/scene/world.h"
#include "protocol/bulk.h"
#include "protocol/wire/packet.h"
#include "protocol/wire/score.h"
#include "server/browse.h"
#include "server/latency.h"
#include "server/notifier.h"
#include "server/osc_stream.h"
#include "server/query_server.h"
#include "server/refusal_log.h"
#include "server/schedule.h"
#include "server/session/offline.h"
#include "server/session/recorder.h"
#include "server/session/session.h"
#include "server/session/sound_capture.h"
#include "server/worker.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>

namespace ringdown::server {
namespace {

#define ROW(constant) \
  { #constant, static_cast < double>(constant) }
const std::map<std::string, double> kConstants = {
    ROW(synth::kMaxObjects),
    ROW(synth::kMaxVoices),
    ROW(synth::kMaxBuses),
    ROW(synth::kMaxPickups),
    ROW(synth::kMaxProbedColumns),
    ROW(synth::kMaxInputs),
    ROW(synth::kMaxDrivenColumns),
    ROW(synth::kQueueCapacity),
    ROW(synth::kMaxPendingEvents),
    ROW(synth::kMaxEventsPerChunk),
    ROW(modal::kMaxDampers),
    ROW(synth::kMaxClicks),
    ROW(synth::kMaxDrives),
    ROW(synth::kMaxForces),
    ROW(modal::kMaxModes),
    ROW(modal::kMaxPoints),
    ROW(modal::kMaxBankFileBytes),
    ROW(modal::kMaxJsonBytes),
    ROW(modal::kMaxJsonValues),
    ROW(scene::kMaxBodies),
    ROW(scene::kMaxStatics),
    ROW(scene::kMaxSceneObjects),
    ROW(scene::kMaxJoints),
    ROW(scene::kMaxEmitters),
    ROW(scene::kMaxContactsPerStep),
    ROW(scene::kMaxEventsPerStep),
    ROW(kMaxTomlFileBytes),
    ROW(wire::kMaxPacketBytes),
    ROW(wire::kMaxAddress),
    ROW(wire::kMaxArguments),
    ROW(wire::kMaxBundle),
    ROW(protocol::kMaxBulkStrikes),
    ROW(protocol::kMaxDelay_s),
    ROW(kMaxName),
    ROW(server::kMaxScheduled),
    ROW(session::kMaxAhead_s),
    ROW(server::kMaxLatency_s),
    ROW(Worker::kMaxTasks),
    ROW(session::StrikeMerger::kMaxUnmerged),
    ROW(session::StrikeMerger::kMaxHeld),
    ROW(server::kMaxSubscribers),
    ROW(server::kMaxContactsPerNotice),
    ROW(server::kSilence_s),
    ROW(synth::kMaxWatched),
    ROW(synth::kMaxTapped),
    ROW(synth::kMaxSpare),
    ROW(protocol::kMaxSoundFrames),
    ROW(protocol::kMaxModeAmplitudes),
    ROW(server::kMaxBrowsed),
    ROW(server::kMaxLookedAt),
    ROW(server::kMaxBrowseDepth),
    ROW(protocol::kMaxBankBytes),
    ROW(server::kMaxConnections),
    ROW(server::kMaxUnreadBytes),
    ROW(server::kMaxRequestBytes),
    ROW(server::kMaxQueryConnections),
    ROW(server::kMaxQuerySilence_s),
    ROW(server::kMaxQueryTime_s),
    ROW(microtuning::PlayedTuning::kMaxPrograms),
    ROW(session::kMaxRecorded),
    ROW(session::kMaxCapturedFrames),
    ROW(RefusalLog::kMaxPerSecond),
    ROW(session::kMaxRender_s),
    ROW(wire::kMaxScoreBytes),
    ROW(wire::kMaxScore),
    ROW(viewer::kMaxUndone),
    ROW(viewer::BankTransfer::kMaxBytes),
    ROW(viewer::BankFetcher::kMaxBytesTotal),
    ROW(viewer::KnownObjects::kMaxKnownObjects),
    ROW(viewer::ObjectWatches::kMaxWatched),
    ROW(viewer::KnownObjects::kMaxModes),
    ROW(viewer::Model::kMaxContacts),
    ROW(viewer::Model::kMaxMessages),
    ROW(viewer::FileBrowser::kMaxFiles),
    ROW(viewer::KnownScene::kMaxBodies),
    ROW(viewer::KnownScene::kMaxStatics),
    ROW(viewer::PoseHistory::kMaxPoses),
    ROW(viewer::DaemonClient::kMaxReplies),
    ROW(viewer::DaemonClient::kMaxRequests),
};
#undef ROW

TEST(Limits, TheSettingsPageListsEveryConstantWithItsValue) {
  std::ifstream page(RINGDOWN_SOURCE_DIR "/docs/reference/settings.md");
  const std::regex row(R"(\| `([^`]+)` \| ([0-9]+) .*)");
  std::map<std::string, double> listed;
  for (std::string line; std::getline(page, line);) {
    std::smatch found;
    if (std::regex_match(line, found, row)) listed[found[1]] = std::stod(found[2]);
  }
  EXPECT_EQ(listed, kConstants);
}

}  // namespace
}  // namespace ringdown::server
