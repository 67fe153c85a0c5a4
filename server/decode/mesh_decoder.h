// Encoded bytes -> triangle mesh: the seam behind which foreign bytes meet a codec.
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
  TriangleMesh mesh;               // CheckMesh(mesh) is OK; with the attributes that were wanted
  uint32_t quantization_bits = 0;  // of POSITION; 0: not quantized
  MeshExtent extent = {};          // ExtentOf(mesh), once a job has asked for it: for all jobs that get a kept mesh
};

struct EncodedMesh {
  absl::Cord bytes;
  FieldList wanted;        // that the mesh must have
  std::string request_id;  // for the log
};

// A decode can be interrupted only by ending whoever does it, and can not be bounded in memory from the header alone: a
// hostile file within all limits can still make a codec allocate gigabytes. So an implementation decodes elsewhere, in
// a process of its own, and a decode is started here and ends in a callback: nobody waits for it.
//
// Threads: all members, any thread, at the same time.
class MeshDecoder {
 public:
  // Takes the end of a decode. Runs on the decoder's thread, which serves all decodes: it must return soon.
  // Errors: INVALID_ARGUMENT for bytes that are not one good mesh, or one without an attribute; RESOURCE_EXHAUSTED for
  // a mesh over the limits, or over the memory or the time that a decode may take; CANCELLED after Cancel.
  using Done = std::function<void(absl::StatusOr<DecodedMesh>)>;

  // Asked before the decoded mesh takes memory; what is not OK ends the decode with it. Runs as Done does; may be asked
  // again, if a decode has to be done again.
  using Reserve = std::function<absl::Status(uint64_t triangles, uint64_t vertices)>;

  // A decode that was started. Letting go of it does not cancel it.
  class Decoding {
   public:
    virtual ~Decoding() = default;
    // Ends the decode within a few milliseconds, unless it is over. Returns at once.
    virtual void Cancel() = 0;
  };

  virtual ~MeshDecoder() = default;

  // Returns at once, whatever the size: bytes are shared, not copied. `done` is called exactly once: not within Start
  // or Cancel, so that both may be called under a lock that `done` takes, but maybe before Start has returned.
  virtual std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve reserve, Done done) = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_MESH_DECODER_H_
