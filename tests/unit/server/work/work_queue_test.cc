// Work queues: what runs where, at which priority, and until when.
#include "server/work/work_queue.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <thread>

namespace latvox {
namespace {

using namespace std::chrono_literals;

constexpr int kThreads = 3;
constexpr int kNiceness = 4;

int Niceness() { return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())); }

struct Seen {
  std::set<pid_t> threads;
  std::set<int> niceness;
};

// The threads of a parallel algorithm within a task. Each part waits until as many have come as the queue has.
Seen SeeParallelTask(WorkQueue& queue) {
  std::promise<Seen> promise;
  queue.Enqueue([&] {
    std::mutex mu;
    Seen seen;
    std::atomic<int> there = 0;
    const auto patience = std::chrono::steady_clock::now() + 10s;
    const auto look = [&](int) {
      {
        const std::lock_guard lock(mu);
        seen.threads.insert(gettid());
        seen.niceness.insert(Niceness());
      }
      ++there;
      while (there < queue.threads() && std::chrono::steady_clock::now() < patience) std::this_thread::yield();
    };
    oneapi::tbb::parallel_for(0, queue.threads(), look, oneapi::tbb::simple_partitioner());
    promise.set_value(seen);
  });
  return promise.get_future().get();
}

TEST(WorkQueue, AllThreadsOfANiceOneHaveItsPriorityAndOthersKeepTheirs) {
  const oneapi::tbb::global_control enough_workers(oneapi::tbb::global_control::max_allowed_parallelism, kThreads + 1);
  WorkQueue quick(kThreads, 0), bulk(kThreads, kNiceness);
  EXPECT_FALSE(quick.nice());
  EXPECT_TRUE(bulk.nice());
  const int own = Niceness();
  std::set<pid_t> quick_threads, bulk_threads;
  for (int round = 0; round < 20; ++round) {
    const Seen in_bulk = SeeParallelTask(bulk), in_quick = SeeParallelTask(quick);
    EXPECT_EQ(in_bulk.niceness, std::set{own + kNiceness});
    EXPECT_EQ(in_quick.niceness, std::set{own});
    EXPECT_EQ(in_bulk.threads.size(), kThreads);
    EXPECT_EQ(in_quick.threads.size(), kThreads);
    bulk_threads.insert(in_bulk.threads.begin(), in_bulk.threads.end());
    quick_threads.insert(in_quick.threads.begin(), in_quick.threads.end());
  }
  EXPECT_EQ(bulk_threads.size(), kThreads);
  for (const pid_t thread : quick_threads) EXPECT_FALSE(bulk_threads.contains(thread));
}

TEST(WorkQueue, OneThreadIsAllThatANiceLaneOfOneHas) {
  std::promise<void> go_on;
  std::set<pid_t> threads;
  std::atomic<int> ran = 0;
  {
    WorkQueue bulk(1, kNiceness);
    bulk.Enqueue([&] {
      go_on.get_future().wait();
      threads.insert(gettid());
      ++ran;
    });
    for (int n = 0; n < 20; ++n) {
      bulk.Enqueue([&] {
        threads.insert(gettid());
        ++ran;
      });
    }
    std::this_thread::sleep_for(20ms);
    go_on.set_value();
  }
  EXPECT_EQ(ran, 21);
  EXPECT_EQ(threads.size(), 1);
}

size_t ThreadsForLargeJobs() {
  size_t count = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    count += name == "latvoxd-bulk";
  }
  return count;
}

TEST(WorkQueue, ThreadsOfANiceOneStartWithItsFirstTask) {
  constexpr int kMany = 40;
  const auto all = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"), std::filesystem::directory_iterator());
  };
  const auto before = all();
  WorkQueue bulk(kMany, kNiceness);
  EXPECT_LE(all(), before + 1);
  std::promise<void> done;
  bulk.Enqueue([&] { done.set_value(); });
  done.get_future().wait();
  while (ThreadsForLargeJobs() < kMany) std::this_thread::yield();  // some have no name yet
}

// No thread gets such a stack.
class NoMoreThreads {
 public:
  NoMoreThreads() { SetStack(size_t{1} << 48); }
  ~NoMoreThreads() { SetStack(stack_); }

 private:
  void SetStack(size_t bytes) {
    pthread_attr_t attributes;
    pthread_getattr_default_np(&attributes);
    pthread_attr_getstacksize(&attributes, &stack_);
    pthread_attr_setstacksize(&attributes, bytes);
    pthread_setattr_default_np(&attributes);
    pthread_attr_destroy(&attributes);
  }
  size_t stack_ = 0;
};

TEST(WorkQueue, OneThreadDoesEverythingWhereNoOtherCanStart) {
  WorkQueue bulk(kThreads, kNiceness);
  std::set<pid_t> threads;
  const auto run = [&] {
    std::promise<void> done;
    bulk.Enqueue([&] {
      threads.insert(gettid());
      done.set_value();
    });
    done.get_future().wait();
  };
  {
    const NoMoreThreads refused;
    EXPECT_THROW(std::thread([] {}).join(), std::system_error);
    run();
  }
  for (int n = 0; n < 20; ++n) run();
  EXPECT_EQ(threads.size(), 1);
}

// Threads that a thread of lower priority starts would keep it.
TEST(WorkQueue, WhatIsDoneOrdinarilyHasTheProcesssPriority) {
  const int own = Niceness();
  WorkQueue quick(1, 0), bulk(1, kNiceness);
  for (WorkQueue* queue : {&quick, &bulk}) {
    std::promise<int> niceness;
    queue->Enqueue([&] { DoOrdinarily(*queue, quick, [&] { niceness.set_value(Niceness()); }); });
    EXPECT_EQ(niceness.get_future().get(), own);
  }
}

// Each end of a task is a chance to fall asleep over the next one.
TEST(WorkQueue, NoTaskIsForgotten) {
  for (const int niceness : {0, kNiceness}) {
    for (const int threads : {1, kThreads}) {
      WorkQueue queue(threads, niceness);
      for (int round = 0; round < 2000; ++round) {
        std::promise<void> done;
        queue.Enqueue([&] { done.set_value(); });
        ASSERT_EQ(done.get_future().wait_for(30s), std::future_status::ready) << round;
      }
    }
  }
}

TEST(WorkQueue, EndsOnceItsTasksHaveRun) {
  for (const int niceness : {0, kNiceness}) {
    std::atomic<int> ran = 0;
    const auto held = std::make_shared<int>(0);
    {
      WorkQueue queue(2, niceness);
      for (int n = 0; n < 100; ++n) {
        queue.Enqueue([&ran, &queue, held] {
          std::this_thread::sleep_for(100us);
          queue.Enqueue([&ran, held] { ++ran; });
        });
      }
    }
    EXPECT_EQ(ran, 100);
    EXPECT_EQ(held.use_count(), 1);
  }
}

// Threads of gRPC come and go.
TEST(WorkQueue, ItsTasksOutliveTheThreadsThatMadeThemAndTheQueue) {
  for (const int niceness : {0, kNiceness}) {
    std::atomic<int> ran = 0;
    std::promise<void> go_on;
    std::unique_ptr<WorkQueue> queue;
    std::thread([&] { queue = std::make_unique<WorkQueue>(1, niceness); }).join();
    queue->Enqueue([&] { go_on.get_future().wait(); });
    for (int n = 0; n < 100; ++n) {
      std::thread([&] { queue->Enqueue([&] { ++ran; }); }).join();
    }
    go_on.set_value();
    queue.reset();
    EXPECT_EQ(ran, 100);
  }
}

TEST(WorkQueue, SaysWhetherTasksWait) {
  std::promise<void> began, go_on;
  WorkQueue queue(1, kNiceness);
  queue.Enqueue([&] {
    began.set_value();
    go_on.get_future().wait();
  });
  began.get_future().wait();
  EXPECT_FALSE(queue.contended());
  queue.Enqueue([] {});
  EXPECT_TRUE(queue.contended());
  go_on.set_value();
}

}  // namespace
}  // namespace latvox
