// docs/limits.md against the constants it lists.
#include "clients/viewer/history.h"
#include "clients/viewer/link/daemon_client.h"
#include "clients/viewer/link/model.h"
#include "engine/base/toml_table.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/simulation.h"
#include "engine/scene/world.h"
#include "protocol/bulk.h"
#include "protocol/names.h"
#include "server/browse.h"
#include "server/latency.h"
#include "server/notifier.h"
#include "server/offline.h"
#include "server/osc_packet.h"
#include "server/osc_stream.h"
#include "server/recorder.h"
#include "server/schedule.h"
#include "server/session.h"
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
    ROW(synth::kMostObjects),
    ROW(synth::kMostVoices),
    ROW(synth::kMostBuses),
    ROW(synth::kMostInputs),
    ROW(synth::kMostDrivenColumns),
    ROW(synth::kQueueCapacity),
    ROW(synth::kMostPendingEvents),
    ROW(synth::kMostEventsPerChunk),
    ROW(protocol::kMostTouches),
    ROW(synth::kMostClicks),
    ROW(synth::kMostDrives),
    ROW(synth::kMostForces),
    ROW(modal::kMostModes),
    ROW(modal::kMostPoints),
    ROW(modal::kLargestBankFile),
    ROW(scene::kMostBodies),
    ROW(scene::kMostStatics),
    ROW(scene::kMostObjects),
    ROW(scene::kMostJoints),
    ROW(scene::kMostEmitters),
    ROW(scene::kMostContactsPerStep),
    ROW(scene::kMostEventsPerStep),
    ROW(kLargestTomlFile),
    ROW(server::kLargestPacket),
    ROW(server::kLongestAddress),
    ROW(server::kMostArguments),
    ROW(server::kDeepestBundle),
    ROW(protocol::kMostBulkStrikes),
    ROW(protocol::kLongestDelay_s),
    ROW(protocol::kLongestName),
    ROW(server::kMostScheduled),
    ROW(server::kFarthestAhead_s),
    ROW(server::kLongestLatency_s),
    ROW(Worker::kMostTasks),
    ROW(StrikeMerger::kMostUnmerged),
    ROW(StrikeMerger::kMostHeld),
    ROW(server::kMostSubscribers),
    ROW(server::kMostContactsPerNotice),
    ROW(server::kSilence_s),
    ROW(synth::kMostWatched),
    ROW(synth::kMostTapped),
    ROW(synth::kLongestSpare),
    ROW(protocol::kMostSoundFrames),
    ROW(protocol::kMostModeAmplitudes),
    ROW(server::kMostBrowsed),
    ROW(server::kMostLookedAt),
    ROW(server::kDeepestBrowsed),
    ROW(protocol::kMostBankBytes),
    ROW(server::kMostConnections),
    ROW(server::kMostUnread),
    ROW(server::kMostRecorded),
    ROW(Captured::kMost),
    ROW(server::kLongestRender_s),
    ROW(server::kLargestScore),
    ROW(server::kLongestScore),
    ROW(viewer::kMostUndone),
    ROW(viewer::BankTransfer::kMostBytes),
    ROW(viewer::Model::kMostBankBytesTotal),
    ROW(viewer::Model::kMostObjects),
    ROW(viewer::Model::kMostWatched),
    ROW(viewer::Model::kMostModes),
    ROW(viewer::Model::kMostContacts),
    ROW(viewer::Model::kMostMessages),
    ROW(viewer::Model::kMostFiles),
    ROW(viewer::KnownScene::kMostBodies),
    ROW(viewer::KnownScene::kMostStatics),
    ROW(viewer::PoseTrack::kMostPoses),
    ROW(viewer::DaemonClient::kMostReplies),
    ROW(viewer::DaemonClient::kMostRequests),
};
#undef ROW

TEST(Limits, ThePageListsEveryConstantWithItsValue) {
  std::ifstream page(RINGDOWN_SOURCE_DIR "/docs/limits.md");
  const std::regex row(R"(\| `([^`]+)` \| ([0-9]+) \|.*)");
  std::map<std::string, double> listed;
  for (std::string line; std::getline(page, line);) {
    std::smatch found;
    if (std::regex_match(line, found, row)) listed[found[1]] = std::stod(found[2]);
  }
  EXPECT_EQ(listed, kConstants);
}

}  // namespace
}  // namespace ringdown::server
