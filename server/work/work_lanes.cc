#include "server/work/work_lanes.h"

#include <algorithm>

namespace latvox {

WorkLanes::WorkLanes(int threads, int niceness) {
  for (auto& lane : lanes_) lane = std::make_unique<WorkQueue>(threads, niceness);
}

std::shared_ptr<WorkQueue> WorkLanes::LaneOf(const std::string& client) {
  const std::lock_guard lock(mu_);
  const auto [found, is_new] = clients_.try_emplace(client);
  if (is_new) {
    const auto emptiest = std::min_element(clients_of_lanes_.begin(), clients_of_lanes_.end());
    ++*emptiest;
    found->second.lane = static_cast<size_t>(emptiest - clients_of_lanes_.begin());
  }
  ++found->second.holders;
  return {lanes_[found->second.lane].get(), [this, client](WorkQueue*) { Release(client); }};
}

void WorkLanes::Release(const std::string& client) {
  const std::lock_guard lock(mu_);
  const auto found = clients_.find(client);
  if (--found->second.holders > 0) return;
  --clients_of_lanes_[found->second.lane];
  clients_.erase(found);
}

void WorkLanes::Wait() {
  for (const auto& lane : lanes_) lane->Wait();
}

}  // namespace latvox
