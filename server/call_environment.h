// What all calls share.
#ifndef LATVOX_SERVER_CALL_ENVIRONMENT_H_
#define LATVOX_SERVER_CALL_ENVIRONMENT_H_

namespace latvox {

class CallRegistry;
class Lane;
struct Limits;
class MemoryBudget;
class MeshDecoder;
class MeshStore;

// All must outlive the calls.
struct CallEnvironment {
  const Limits& limits;
  MeshDecoder& decoder;
  MeshStore& meshes;
  MemoryBudget& memory;
  Lane& quick;  // for what takes some milliseconds
  Lane& bulk;   // for what takes longer
  CallRegistry& registry;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALL_ENVIRONMENT_H_
