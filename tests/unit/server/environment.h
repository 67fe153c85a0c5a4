// The environment of calls, for tests without a whole server.
#ifndef LATVOX_TESTS_UNIT_SERVER_ENVIRONMENT_H_
#define LATVOX_TESTS_UNIT_SERVER_ENVIRONMENT_H_

#include "deploy/manual/build_facts.h"
#include "server/access/authenticator.h"
#include "server/base/limits.h"
#include "server/calls/call_registry.h"
#include "server/calls/metrics.h"
#include "server/decode/mesh_decoder.h"
#include "server/decode/mesh_store.h"
#include "server/work/call_environment.h"
#include "server/work/memory_budget.h"
#include "server/work/unfinished_uploads.h"
#include "server/work/work_lanes.h"
#include "server/work/work_queue.h"

namespace latvox {

struct TestEnvironment {
  explicit TestEnvironment(MeshDecoder& mesh_decoder, const Limits& all_limits = {})
      : limits(all_limits), decoder(mesh_decoder) {}

  CallEnvironment shared() { return {limits, decoder, meshes, uploads, memory, quick, bulk, registry, metrics, build}; }

  const Limits limits;
  const BuildFacts build;
  MeshDecoder& decoder;
  MeshStore meshes{limits.mesh_store_bytes};
  MemoryBudget memory{limits.memory_budget_bytes};
  UnfinishedUploads uploads{memory, limits.mesh_store_bytes};
  WorkQueue quick{1, 0};
  WorkLanes bulk{1, 10};
  Authenticator everybody{""};
  Metrics metrics;
  CallRegistry registry{{limits.max_jobs, limits.max_queued_jobs, limits.max_jobs_per_client}};
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_ENVIRONMENT_H_
