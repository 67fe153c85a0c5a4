// The server as a whole: threads, listening addresses, services, and an orderly end.
#ifndef LATVOX_SERVER_LISTEN_SERVER_H_
#define LATVOX_SERVER_LISTEN_SERVER_H_

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "deploy/manual/build_facts.h"
#include "server/access/access.h"
#include "server/base/activated_sockets.h"
#include "server/base/limits.h"
#include "server/base/unix_socket.h"
#include "server/decode/decoder_process.h"

namespace latvox {

struct ServerOptions {
  std::vector<std::string> listen = {"127.0.0.1:50151"};  // HOST:PORT, port 0 for any free port; or unix:PATH
  std::vector<ActivatedSocket> sockets;                   // in place of `listen`
  int threads = 0;                                        // for compute; 0: one for each core that control groups allow
  Limits limits;
  AccessOptions access;
  BuildFacts build;            // for GetLimits
  std::string metrics_listen;  // HOST:PORT for Prometheus; empty: none
  std::string health_listen;   // for grpc.health.v1 alone, in plain text; empty: none
  DecoderOptions decoder;      // its `program` must be set: the server has no default

  // Added to the process's niceness for the threads of large jobs. With 10 they get a tenth of a core that small jobs,
  // gRPC or the client want as well; with 0 an equal share.
  int bulk_niceness = 10;

  bool decode_always = false;  // decode the mesh of each request, instead of keeping decoded meshes

  // Bytes for the whole process except its decoders. limits.memory_budget_bytes becomes the part that is left for jobs.
  // 0: three quarters of the memory of the machine or the control group.
  uint64_t memory_bytes = 0;

  // Halves the default memory, the decoders' included, in favor of the process that started this one.
  bool shares_memory = false;

  // A client that has for so long neither sent its input nor taken its messages is given up. It may come back and
  // resume.
  absl::Duration stall_timeout = absl::Seconds(60);

  // A peer gets a ping after `keepalive_time` without a byte from it. A peer that does not answer within
  // `keepalive_timeout` is dead, and its calls are cancelled. A client that polls only during its calls answers within
  // 5 s.
  absl::Duration keepalive_time = absl::Seconds(5);
  absl::Duration keepalive_timeout = absl::Seconds(10);

  // A connection of this age, plus or minus a tenth, takes no new calls. It closes once its calls have ended, however
  // long that takes. So clients that reconnect may find another server. 0: never.
  absl::Duration max_connection_age = absl::ZeroDuration();

  // If set, called each second, or more often, by the thread that oversees the calls, until Stop has ended them. So it
  // is not called while that thread is stuck.
  std::function<void()> alive;
};

class VoxelServer {
 public:
  // Serves when it returns. Errors: INVALID_ARGUMENT (no address, no program for decoder processes, or an error of
  // Check); UNAVAILABLE naming an address that it cannot listen on, or the reason why sockets cannot be
  // served, or decoder processes cannot be started or confined.
  static absl::StatusOr<std::unique_ptr<VoxelServer>> Start(const ServerOptions& options);

  // Returns the error of Start that does not depend on listening: INVALID_ARGUMENT naming the option.
  static absl::Status Check(const ServerOptions& options);

  // Precondition: Stop returned true, or was not called.
  virtual ~VoxelServer() = default;

  // The given addresses, with the ports that were chosen; or those of the sockets.
  virtual const std::vector<std::string>& addresses() const = 0;

  // The files of all addresses, for a process that ends without destructors.
  virtual const SocketFiles& socket_files() const = 0;

  // Empty if there is no such server.
  virtual std::string metrics_address() const = 0;
  virtual std::string health_address() const = 0;

  // Calls in progress.
  virtual size_t calls() const = 0;

  // Bytes of the budget that jobs have reserved.
  virtual uint64_t reserved_memory() const = 0;

  // Reads the files that the options name again. Logs errors, and keeps the old content of a file that is wrong. Files
  // that change are also read without this call. Thread-safe.
  virtual void Reload() = 0;

  // Ends the server: reports NOT_SERVING, refuses new calls at once, gives calls in progress the time `grace`, then
  // stops them. Returns whether all have ended. If one of their threads is stuck, the process has to exit without
  // destructors. Idempotent; any thread except gRPC's.
  virtual bool Stop(absl::Duration grace) = 0;

  // Does the same, except that gRPC's threads and connections stay: enough for a process that then exits without
  // destructors.
  virtual bool StopCalls(absl::Duration grace) = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_LISTEN_SERVER_H_
