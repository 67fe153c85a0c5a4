// Connections and calls.
#ifndef LATVOX_CLIENT_PYTHON_CALL_H_
#define LATVOX_CLIENT_PYTHON_CALL_H_

#include <pybind11/pybind11.h>

#include <deque>
#include <memory>
#include <string>

#include "client/python/voxels.h"
#include "client/python/work.h"
#include "client/tool/cli/session.h"
#include "client/tool/cli/voxelize_command.h"

namespace latvox::client::python {

// A server that calls use. Threads: any.
class Connection {
 public:
  // Connects, or starts a private server if the keywords name none.
  //   keywords   the tool's options of a connection
  //   token      empty: none, or that of token_file
  //   program    of a private server; empty: as PrivateServerOptions has it
  // Throws as ParseKeywords and Session::Open.
  Connection(const pybind11::dict& keywords, const std::string& token, const std::string& program);

  // Returns the session. Calls share it, so Close does not disturb them. Errors: FAILED_PRECONDITION: closed, or of
  // another process.
  absl::StatusOr<std::shared_ptr<const Session>> session() const;

  // Ends the connection, and the private server, as soon as no call uses them.
  void Close() { session_.reset(); }

 private:
  std::shared_ptr<const Session> session_;
};

// A running voxelization, on a thread of its own. The destructor cancels it.
class Call {
 public:
  // Begins it.
  //   mesh       a list of paths, or a tuple of parts with the members of PartArrays
  //   keywords   of the request and of the connection
  //   streams    whether Next passes the voxels on; otherwise Wait returns all
  // Throws as ParseKeywords and MeshOfArrays.
  Call(const Connection& connection, const pybind11::object& mesh, const pybind11::dict& keywords, bool streams);

  // Waits for the end and returns the answer, with the bricks unless it streams. Throws the call's error, and
  // FAILED_PRECONDITION if Next has not returned all batches.
  //   progress   called with a number from 0 to 1, up to twenty times a second; or None
  SharedVoxels Wait(const pybind11::object& progress);

  // Waits for the next batch and returns it; null: there are no more. Throws the call's error.
  SharedVoxels Next();

  void Cancel() { work_->Cancel(); }

 private:
  class Receiver;
  absl::Status Voxelize(Work& work);

  std::shared_ptr<const Session> session_;
  VoxelizeOptions options_;
  MeshReader read_mesh_;
  const bool streams_;
  const SharedVoxels answer_ = std::make_shared<Voxels>();
  std::deque<SharedVoxels> batches_;  // as the rest, guarded by the work's lock
  double progress_ = 0;
  OfProcess<Work> work_;  // uses the others
};

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_CALL_H_
