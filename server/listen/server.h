// The server as a whole: threads, listening addresses, services, and an orderly end.
#ifndef LATVOX_SERVER_LISTEN_SERVER_H_
#define LATVOX_SERVER_LISTEN_SERVER_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/access/access.h"
#include "server/base/limits.h"
#include "server/base/unix_socket.h"
#include "server/decode/decoder_process.h"

namespace latvox {

struct ServerOptions {
  std::vector<std::string> listen = {"127.0.0.1:50151"};  // HOST:PORT, port 0 for any that is free; or unix:PATH
  int threads = 0;                                        // for compute; 0: one for each core that control groups allow
  Limits limits;
  AccessOptions access;
  std::string metrics_listen;  // HOST:PORT for Prometheus; empty: none
  std::string health_listen;   // of grpc.health.v1 alone, in plain text; empty: none
  DecoderOptions decoder;      // its `program` has to be set: the server has none of its own

  // What the threads for large jobs add to the process's niceness. With 10 they get a tenth of a core that is wanted
  // for something else, by small jobs or gRPC or the client; with 0 as much as that does.
  int bulk_niceness = 10;

  bool decode_always = false;  // a mesh for each request, rather than keep what it was decoded to

  // Of the whole process but for its decoders; limits.memory_budget_bytes is set to what this leaves for jobs. 0: three
  // quarters of what the machine, or the control group, has.
  uint64_t memory_bytes = 0;

  // Whether the defaults leave half of what they would take, decoders' memory included, to the process that started
  // this one.
  bool shares_memory = false;

  // A client that has neither sent what it has to nor taken what it can for so long is given up; it may come back and
  // resume.
  absl::Duration stall_timeout = absl::Seconds(60);

  // A peer that does not answer a ping within `keepalive_timeout` is dead, and its calls are cancelled; it gets one
  // after `keepalive_time` without a byte from it. A client that polls only while it is called answers within 5 s.
  absl::Duration keepalive_time = absl::Seconds(5);
  absl::Duration keepalive_timeout = absl::Seconds(10);

  // A connection of this age, give or take a tenth, takes no new calls, and closes once those it has have ended,
  // however long that takes: clients that connect again may find another server. 0: never.
  absl::Duration max_connection_age = absl::ZeroDuration();
};

class VoxelServer {
 public:
  // Serves when it returns. Errors: INVALID_ARGUMENT (no address, no program for decoder processes, or what Check
  // finds), UNAVAILABLE naming the address that cannot be listened on, or why decoder processes cannot be started or
  // confined.
  static absl::StatusOr<std::unique_ptr<VoxelServer>> Start(const ServerOptions& options);

  // What Start would find wrong with the options before it listens: INVALID_ARGUMENT naming the option.
  static absl::Status Check(const ServerOptions& options);

  // Precondition: Stop returned true, or was not called.
  virtual ~VoxelServer() = default;

  // As given, but with the ports that were chosen.
  virtual const std::vector<std::string>& addresses() const = 0;

  // Those of all addresses; for whoever ends the process without destructors.
  virtual const SocketFiles& socket_files() const = 0;

  // Empty if there is none.
  virtual std::string metrics_address() const = 0;
  virtual std::string health_address() const = 0;

  // Calls in progress.
  virtual size_t calls() const = 0;

  // Bytes of the budget that jobs have reserved.
  virtual uint64_t reserved_memory() const = 0;

  // Reads the files again that the options name. What is wrong with them is logged, and stays as it was. They are read
  // as well whenever they change. Thread-safe.
  virtual void Reload() = 0;

  // Ends: reports NOT_SERVING and refuses new calls at once, lets those in progress go on for `grace`, then stops them.
  // Returns whether all have ended. If not, for a thread of theirs is stuck, the process has to exit without
  // destructors. Idempotent; any thread but gRPC's.
  virtual bool Stop(absl::Duration grace) = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_LISTEN_SERVER_H_
