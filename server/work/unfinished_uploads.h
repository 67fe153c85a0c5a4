// Meshes that arrive in pieces over many calls, until they are complete: UploadMesh.
#ifndef LATVOX_SERVER_WORK_UNFINISHED_UPLOADS_H_
#define LATVOX_SERVER_WORK_UNFINISHED_UPLOADS_H_

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/cord.h"
#include "server/decode/raw_mesh.h"
#include "server/wire/convert.h"
#include "server/work/memory_budget.h"

namespace latvox {

// Thread-safe. Locks are held for a few instructions: bytes are compared and checked in between.
class UnfinishedUploads {
 public:
  using Clock = std::chrono::steady_clock;

  // An upload is dropped so long after its last progress; or sooner, if others need its room.
  static constexpr auto kPatience = std::chrono::minutes(10);
  static constexpr auto kShortPatience = std::chrono::seconds(10);

  static constexpr size_t kMostOfClient = 64, kMost = 1024;

  // A dropped upload lives, and its memory counts, as long as a call uses it.
  struct Upload {
    const std::string client;
    const MeshSpec mesh;
    absl::Cord bytes;  // no longer changes once it is complete
    std::optional<RawMeshCheck> raw_mesh;
    MemoryReservation memory;
    Clock::time_point progress_at;
    uint64_t progress_bytes = 0;  // that had come then
  };

  struct Progress {
    uint64_t next_offset = 0;
    std::shared_ptr<const Upload> complete;  // null: bytes are missing
  };

  //   memory            must outlive this and all uploads
  //   bytes_of_client   of all unfinished uploads of one client; all clients together may have twice that
  UnfinishedUploads(MemoryBudget& memory, uint64_t bytes_of_client)
      : memory_(memory), bytes_of_client_(bytes_of_client) {}

  // Adds a piece, as UploadMeshRequest describes it. Cheap enough for a gRPC callback. Errors: INVALID_ARGUMENT for a
  // gap, and for bytes that contradict each other or the mesh's specification; RESOURCE_EXHAUSTED, with a retry delay,
  // if there is no room; as MemoryReservation::Grow.
  absl::StatusOr<Progress> Add(const std::string& client, const MeshSpec& mesh, uint64_t offset, std::string&& piece,
                               Clock::time_point now = Clock::now());

  // Drops the upload, if it is still there.
  void Drop(const std::shared_ptr<const Upload>& upload);
  void Drop(const std::string& client, const MeshSpec& mesh) { Drop(Look(client, mesh).upload); }

  // Drops uploads without progress for `patience`.
  void DropIdle(std::chrono::nanoseconds patience, Clock::time_point now = Clock::now());

  uint64_t bytes() const;
  size_t size() const;

 private:
  using Uploads = std::list<std::shared_ptr<Upload>>;

  // An upload as it was at some time. Without an upload, it has no bytes.
  struct Snapshot {
    std::shared_ptr<Upload> upload;
    absl::Cord bytes;
    std::optional<RawMeshCheck> raw_mesh;
  };

  Uploads::iterator Find(const std::string& client, const MeshSpec& mesh);
  Snapshot Look(const std::string& client, const MeshSpec& mesh);
  absl::StatusOr<std::optional<Progress>> Append(const Snapshot& known, const std::string& client, const MeshSpec& mesh,
                                                 std::string& piece, Clock::time_point now);
  absl::Status MakeRoom(const std::string* client, const Upload* growing, uint64_t more, Clock::time_point now,
                        Uploads& dropped);
  static Progress ProgressOf(std::shared_ptr<Upload> upload, uint64_t size);

  MemoryBudget& memory_;
  const uint64_t bytes_of_client_;
  mutable std::mutex mu_;
  Uploads uploads_;  // guarded by mu_; those with the latest progress first
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_UNFINISHED_UPLOADS_H_
