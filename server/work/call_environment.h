// The parts of the server that all calls share.
#ifndef LATVOX_SERVER_WORK_CALL_ENVIRONMENT_H_
#define LATVOX_SERVER_WORK_CALL_ENVIRONMENT_H_

#include "server/base/limits.h"

namespace latvox {

class CallRegistry;
class WorkQueue;
class MemoryBudget;
class MeshDecoder;
class MeshStore;
class Metrics;

// The limits are the caller's. The referenced objects must outlive the calls.
struct CallEnvironment {
  Limits limits;
  MeshDecoder& decoder;
  MeshStore& meshes;
  MemoryBudget& memory;
  WorkQueue& quick;  // for work of some milliseconds
  WorkQueue& bulk;   // for longer work
  CallRegistry& registry;
  Metrics& metrics;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_CALL_ENVIRONMENT_H_
