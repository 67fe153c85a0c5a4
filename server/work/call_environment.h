// The parts of the server that all calls share.
#ifndef LATVOX_SERVER_WORK_CALL_ENVIRONMENT_H_
#define LATVOX_SERVER_WORK_CALL_ENVIRONMENT_H_

#include <string>

#include "server/base/limits.h"

namespace latvox {

struct BuildFacts;
class CallRegistry;
class WorkLanes;
class WorkQueue;
class MemoryBudget;
class MeshDecoder;
class MeshStore;
class Metrics;
class UnfinishedUploads;

// The limits and the client are the caller's. The referenced objects must outlive the calls.
struct CallEnvironment {
  Limits limits;
  MeshDecoder& decoder;
  MeshStore& meshes;
  UnfinishedUploads& uploads;
  MemoryBudget& memory;
  WorkQueue& quick;  // for work of some milliseconds
  WorkLanes& bulk;   // for longer work
  CallRegistry& registry;
  Metrics& metrics;
  const BuildFacts& build;
  std::string client = {};  // that the call counts for
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_CALL_ENVIRONMENT_H_
