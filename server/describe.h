// Answers to what asks how things are and changes nothing: /object/.../describe and bank, /scene/describe, /browse.
// [worker]
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "protocol/request.h"
#include "server/recorder.h"
#include "server/session.h"

#include <vector>

namespace ringdown::server {

[[nodiscard]] bool is_question(const protocol::Request& request);

// The messages of the answer, in their order. `recorder` knows gains and pans. An error names the argument.
Result<std::vector<protocol::Reply>> answer_to(const protocol::Request& question, const Session& session,
                                               const Recorder& recorder);

}  // namespace ringdown::server
