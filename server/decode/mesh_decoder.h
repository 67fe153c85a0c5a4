// Decodes foreign bytes to a triangle mesh: the interface between the server and a codec.
#ifndef LATVOX_SERVER_DECODE_MESH_DECODER_H_
#define LATVOX_SERVER_DECODE_MESH_DECODER_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/cord.h"
#include "core/mesh/mesh.h"
#include "core/request/fields.h"
#include "core/voxelizer/estimate.h"
#include "server/base/limits.h"

namespace latvox {

struct DecodedMesh {
  TriangleMesh mesh;               // CheckMesh(mesh) is OK; it has the requested attributes
  uint32_t quantization_bits = 0;  // of POSITION; 0: not quantized
  MeshExtent extent = {};          // ExtentOf(mesh), after a job has asked for it: shared by all jobs with a kept mesh
};

struct EncodedMesh {
  absl::Cord bytes;
  FieldList wanted;        // the attributes that the mesh must have
  std::string request_id;  // for the log
  std::string client;      // clients have turns
};

// A decode can be interrupted only by ending its process. The header alone does not bound its memory: a hostile file
// within all limits can still make a codec allocate gigabytes. So an implementation decodes in a process of its own. A
// decode is started here and ends in a callback, so nobody waits for it.
//
// Threads: all members, any thread, at the same time.
class MeshDecoder {
 public:
  // Receives the result of a decode. It runs on the decoder's thread, which serves all decodes, so it must return soon.
  // Errors: INVALID_ARGUMENT for bytes that are not one valid mesh, or a mesh without a requested attribute;
  // RESOURCE_EXHAUSTED for a mesh over the limits, or over the memory or time of a decode; CANCELLED after Cancel.
  using Done = std::function<void(absl::StatusOr<DecodedMesh>)>;

  // Called before the decoded mesh takes memory; an error ends the decode with that error. It runs like Done, and may
  // be called again if a decode is repeated.
  using Reserve = std::function<absl::Status(uint64_t triangles, uint64_t vertices)>;

  // A started decode. Destroying it does not cancel the decode.
  class Decoding {
   public:
    virtual ~Decoding() = default;
    // Ends the decode within a few milliseconds, unless it is over. Returns at once.
    virtual void Cancel() = 0;
  };

  virtual ~MeshDecoder() = default;

  // Returns at once, whatever the size: it shares bytes, without a copy. Calls `done` exactly once. It does not call it
  // within Start or Cancel, so both may be called under a lock that `done` takes. It may call it before Start has
  // returned.
  virtual std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve reserve, Done done) = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_MESH_DECODER_H_
