// Queues for large work, in which no client waits for a task of another one.
//
// A task can make way only at the end of a tile, and a hostile mesh has tiles that take seconds. So each client has a
// queue with threads of its own, and the operating system divides the cores between them, in the middle of tiles.
#ifndef LATVOX_SERVER_WORK_WORK_LANES_H_
#define LATVOX_SERVER_WORK_WORK_LANES_H_

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "server/work/work_queue.h"

namespace latvox {

// Threads: any.
class WorkLanes {
 public:
  // More clients with large work at the same time share lanes. The threads of a lane that was used once stay.
  static constexpr int kLanes = 4;

  // Arguments: as those of WorkQueue, for each lane.
  WorkLanes(int threads, int niceness);

  int threads() const { return lanes_.front()->threads(); }

  // Returns the client's lane: all that hold it at the same time hold the same. It has the fewest clients when the
  // first takes it. Must not outlive this object.
  std::shared_ptr<WorkQueue> LaneOf(const std::string& client);

  // Waits for all tasks in all lanes.
  void Wait();

 private:
  struct Client {
    size_t lane = 0;
    int holders = 0;
  };

  void Release(const std::string& client);

  std::array<std::unique_ptr<WorkQueue>, kLanes> lanes_;
  std::mutex mu_;
  std::unordered_map<std::string, Client> clients_;  // guarded by mu_, as is the next
  std::array<int, kLanes> clients_of_lanes_{};
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_WORK_LANES_H_
