#include "server/base/file_watch.h"

#include <sys/stat.h>

#include <chrono>
#include <utility>

namespace latvox {
namespace {

constexpr auto kPeriod = std::chrono::seconds(1);

int64_t Nanoseconds(const timespec& time) { return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; }

}  // namespace

std::vector<FileWatch::Look> FileWatch::LookAt(const std::vector<std::string>& paths) {
  std::vector<Look> looks;
  for (const std::string& path : paths) {
    struct stat facts {};
    Look& look = looks.emplace_back();
    if (stat(path.c_str(), &facts) != 0) continue;
    look = {facts.st_dev, facts.st_ino, facts.st_size, Nanoseconds(facts.st_mtim), Nanoseconds(facts.st_ctim)};
  }
  return looks;
}

void FileWatch::Add(const std::vector<std::string>& paths, std::function<void()> changed) {
  Group group{.paths = paths, .looks = {}, .changed = std::move(changed)};
  std::erase(group.paths, "");
  if (group.paths.empty()) return;
  group.looks = LookAt(group.paths);
  groups_.push_back(std::move(group));
}

void FileWatch::Start() {
  if (!groups_.empty()) thread_ = std::thread([this] { Run(); });
}

// Looks before the files are read, so that the next look sees a change during the reading.
void FileWatch::Run() {
  std::unique_lock lock(mu_);
  while (!stop_.wait_for(lock, kPeriod, [this] { return stopping_; })) {
    for (Group& group : groups_) {
      std::vector<Look> looks = LookAt(group.paths);
      if (looks == group.looks) continue;
      group.looks = std::move(looks);
      lock.unlock();
      group.changed();
      lock.lock();
    }
  }
}

FileWatch::~FileWatch() {
  {
    const std::lock_guard lock(mu_);
    stopping_ = true;
  }
  stop_.notify_all();
  if (thread_.joinable()) thread_.join();
}

}  // namespace latvox
